"""Files written: motions and spans of them, and annotations."""
