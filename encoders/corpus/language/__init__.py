"""Language of the corpus: scenes into captions, sentences into scenes."""

from encoders.corpus.language.draw import random_gait, random_scene
from encoders.corpus.language.grammar import Said, captions, describe
from encoders.corpus.language.parsing import parse, read
from encoders.corpus.language.reserved import HeldOut
from encoders.corpus.language.swap import swap, swaps

__all__ = ["HeldOut", "Said", "captions", "describe", "parse", "random_gait", "random_scene", "read", "swap", "swaps"]
