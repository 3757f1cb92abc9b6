"""Scenes and captioned real motion become training pairs and long takes with known truth."""
