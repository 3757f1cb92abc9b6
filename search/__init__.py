"""A library becomes answers."""
