"""The vector index: exact and clustered search over unit vectors, its files, and keeping it in step with a library."""
