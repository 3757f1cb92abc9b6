"""Programs of ball games and fighting; importing registers them."""

from encoders.corpus.sports import balls, combat

__all__ = ["balls", "combat"]
