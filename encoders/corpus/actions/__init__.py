"""Actions that the corpus can synthesise: one module per family, and the list of all their programs."""
