"""A folder becomes a library: scan, read in processes, encode, keep captions in step."""
