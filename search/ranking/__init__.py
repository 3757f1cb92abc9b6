"""Ranking: clip scores, hubness, alignment, and the strength of hits."""
