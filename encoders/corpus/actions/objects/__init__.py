"""Programs that handle things: carrying, gripping, everyday life, tools, instruments; importing registers them."""

from encoders.corpus.actions.objects import chores, everyday, gripping, handling, music

__all__ = ["chores", "everyday", "gripping", "handling", "music"]
