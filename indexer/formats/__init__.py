"""A motion file becomes a Take: one module a format, and the table of formats."""
