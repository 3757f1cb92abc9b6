"""Programs that handle things: carrying, everyday life, tools, instruments; importing registers them."""

from encoders.corpus.objects import chores, everyday, handling, music

__all__ = ["chores", "everyday", "handling", "music"]
