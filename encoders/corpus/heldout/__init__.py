"""Held-out actions, styles and queries: never trained on, so that evaluation can measure generalisation.

Nothing here is sampled by `random_scene`, parsed by `parse` or among `programs.programs()`, and no phrase of the
lexicon names these actions.
"""
