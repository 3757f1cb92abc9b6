"""Programs of dancing and of playing animals and things; importing registers them."""

from encoders.corpus.actions.dance import free, imitation, set_dances

__all__ = ["free", "imitation", "set_dances"]
