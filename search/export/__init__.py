"""Answers as files: cuts of motion and annotations."""
