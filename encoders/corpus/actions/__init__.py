"""What the corpus can act out: one module a family of actions, and the registry of their programs."""
