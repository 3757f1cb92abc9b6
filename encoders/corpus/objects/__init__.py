"""Programs that handle things: carrying, gripping, everyday life, tools, instruments; importing registers them."""

from encoders.corpus.objects import chores, everyday, gripping, handling, music

__all__ = ["chores", "everyday", "gripping", "handling", "music"]
