"""motionseek: the search engine for human motion.

import motionseek
motionseek.index("my_mocap")
library = motionseek.open("my_mocap")
for hit in library.search("a person limps to the left", k=5):
    print(hit.score, hit.strength, hit.path, hit.start, hit.end)

A library can also be made from arrays, without files:

library = motionseek.open("my_library", create=True)
library.add("walk", joints, captions=["a person walks"], fps=30)
"""

import importlib.metadata

import motionseek_main

if motionseek_main.hidden_package():
    raise ImportError(motionseek_main.hidden_package())

from encoders.bundle.bundle import Bundle
from encoders.bundle.encoder_adapter import EncoderAdapter
from encoders.bundle.known_models import load_model
from encoders.errors import (
    ArgumentError,
    BundleError,
    BundleMismatch,
    LibraryDamaged,
    LibraryError,
    LibraryLocked,
    LibraryNotFound,
    MissingProgram,
    MotionSeekError,
    MotionSeekWarning,
    QueryError,
    UnknownClip,
    UnknownRig,
    UnreadableMotion,
)
from encoders.features.registry import FeatureKind
from encoders.motion import Motion
from encoders.protocol import Encoder, TokenEncoder
from indexer.ingest.arrays import NewClip
from indexer.ingest.indexing import index
from indexer.ingest.load import load_motion as load
from indexer.ingest.storing import Summary
from indexer.store.clips import Caption, Clip
from indexer.store.marks.marks_table import Marks
from search.compose.composition import Composition
from search.compose.timeline import Interval, Timeline
from search.hits import Hit, Hits, Step
from search.library import Library
from search.moments.segments import Segment
from search.places import open_library as open
from search.stacks.stacking import Copy
from search.standalone import describe, moments, segment

__version__ = importlib.metadata.version("motionseek")
del importlib, motionseek_main

__all__ = [
    "ArgumentError",
    "Bundle",
    "BundleError",
    "BundleMismatch",
    "Caption",
    "Clip",
    "Composition",
    "Copy",
    "Encoder",
    "EncoderAdapter",
    "FeatureKind",
    "Hit",
    "Hits",
    "Interval",
    "Library",
    "LibraryDamaged",
    "LibraryError",
    "LibraryLocked",
    "LibraryNotFound",
    "Marks",
    "MissingProgram",
    "Motion",
    "MotionSeekError",
    "MotionSeekWarning",
    "NewClip",
    "QueryError",
    "Segment",
    "Step",
    "Summary",
    "Timeline",
    "TokenEncoder",
    "UnknownClip",
    "UnknownRig",
    "UnreadableMotion",
    "describe",
    "index",
    "load",
    "load_model",
    "moments",
    "open",
    "segment",
]
