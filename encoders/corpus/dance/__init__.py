"""Programs of dancing and of playing animals and things; importing registers them."""

from encoders.corpus.dance import free, imitation, steps

__all__ = ["free", "imitation", "steps"]
