"""Programs of the arms, hands and head: by oneself, to others, and of feelings; importing registers them."""

from encoders.corpus.gestures import alone, feelings, others

__all__ = ["alone", "feelings", "others"]
