"""Features of a motion, frame by frame: one module a kind, and the registry of kinds."""
