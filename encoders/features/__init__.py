"""How a motion becomes numbers a frame: one module a feature kind, and the registry of kinds."""
