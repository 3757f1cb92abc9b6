"""A body to look at: capsules on its joints, and the player that notebooks show."""
