"""Language of the corpus: scenes into captions, sentences into scenes."""

from encoders.corpus.language.draw import random_scene
from encoders.corpus.language.grammar import captions

__all__ = ["captions", "random_scene"]
