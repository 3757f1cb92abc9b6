"""motionseek: the search engine for human motion."""

from encoders.errors import (
    BundleError,
    BundleMismatch,
    LibraryError,
    MotionSeekError,
    QueryError,
    UnknownRig,
    UnreadableMotion,
)
from encoders.motion import Motion

__all__ = [
    "BundleError",
    "BundleMismatch",
    "LibraryError",
    "Motion",
    "MotionSeekError",
    "QueryError",
    "UnknownRig",
    "UnreadableMotion",
]
