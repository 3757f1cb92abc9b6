"""Programs of ball games, swings and fighting; importing registers them."""

from encoders.corpus.sports import balls, combat, swings

__all__ = ["balls", "combat", "swings"]
