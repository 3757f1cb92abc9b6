"""Judging generated motion: the figures of the papers on motion synthesis, of a folder of motions."""
