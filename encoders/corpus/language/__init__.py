"""Language of the corpus: scenes into captions, sentences into scenes."""

from encoders.corpus.language.draw import random_gait, random_scene
from encoders.corpus.language.grammar import Said, captions, describe
from encoders.corpus.language.heldout import HeldOut
from encoders.corpus.language.reading import parse, read
from encoders.corpus.language.swap import swap, swaps

__all__ = ["HeldOut", "Said", "captions", "describe", "parse", "random_gait", "random_scene", "read", "swap", "swaps"]
