"""Programs of the arms, hands and head: by oneself, to others, and of feelings; importing registers them."""

from encoders.corpus.actions.gestures import alone, directing, feelings, greeting, waving

__all__ = ["alone", "directing", "feelings", "greeting", "waving"]
