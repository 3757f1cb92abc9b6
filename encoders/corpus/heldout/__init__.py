"""Actions, manners and words kept out of training, so that figures can say what the model makes of the unknown.

Nothing here is drawn by `random_scene`, read by `parse` or found among `programs.programs()`, and no phrase of the
lexicon names these actions; only takes to measure on are made of them.
"""
