"""Which clips answer, in which order, and how sure that is."""
