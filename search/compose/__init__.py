"""A time line of sentences becomes one motion: spans of real clips are chosen, joined in time and stitched in space."""
