"""Captions from scenes and scenes from captions: phrase tables, caption generation, parsing, hard negatives."""
