"""An evaluator whose answers can be known by hand: it looks only at how fast the left hand is raised."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from encoders.motion import Motion
from encoders.skeleton import INDEX
from search.judging.motion_table import JudgedMotion
from tests.search.judging.bodies import standing

_WRIST = INDEX["left_wrist"]
#: Sentence -> the angle of its vector; a motion's is its wrist's height at the end less that at the start, in metres.
ANGLES = {"stands": 0.0, "raises a hand": 0.5, "raises it high": 1.0}


class WristEncoder:
    """An `Encoder` into the plane."""

    name, fingerprint, feature_kind = "wrist", "0123456789abcdef", "wrist"
    fps, max_frames, latent_size, calibration = 10.0, 1000, 2, None

    def features(self, motion: Motion) -> np.ndarray:
        return motion.joints[::2, _WRIST, 1:2]

    def encode_features(self, features: Sequence[np.ndarray]) -> np.ndarray:
        return _directions([float(rows[-1, 0] - rows[0, 0]) for rows in features])

    def encode_windows(self, features: np.ndarray, starts: np.ndarray, length: int) -> np.ndarray:
        return self.encode_features([features[start : start + length] for start in starts])

    def encode_motions(self, motions: Sequence[Motion]) -> np.ndarray:
        return self.encode_features([self.features(motion) for motion in motions])

    def encode_texts(self, sentences: Sequence[str]) -> np.ndarray:
        return _directions([ANGLES[sentence] for sentence in sentences])


def _directions(angles: Sequence[float]) -> np.ndarray:
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1).astype(np.float32)


def raising(name: str, height: float, frames: int = 41, **said: object) -> JudgedMotion:
    """A motion that raises the left hand evenly by `height` metres."""
    joints = standing(frames)
    joints[:, _WRIST, 1] += np.linspace(0, height, frames)
    return JudgedMotion(name, Motion(joints.astype(np.float32), 20.0), **said)  # type: ignore[arg-type]
