"""Training pairs and annotated long takes, composed from synthetic scenes and captioned real motion."""
