"""Handling things: carrying, gripping, everyday life, tools, instruments."""
