"""Dancing, and imitating animals and things."""
