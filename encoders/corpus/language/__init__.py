"""Language of the corpus: scenes into captions, sentences into scenes."""

from encoders.corpus.language.draw import random_scene
from encoders.corpus.language.grammar import Said, captions, describe
from encoders.corpus.language.reading import parse
from encoders.corpus.language.swap import swap, swaps

__all__ = ["Said", "captions", "describe", "parse", "random_scene", "swap", "swaps"]
