"""Programs of ball games, swings, fighting, weights and boards; importing registers them."""

from encoders.corpus.actions.sports import balls, combat, outdoor, swings

__all__ = ["balls", "combat", "outdoor", "swings"]
