"""The tables of the database: the steps that make them, and a digest of each row."""
