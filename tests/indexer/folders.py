"""Small folders of motion and a small model, for tests of the library."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence
from hashlib import blake2b
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from sqlite_utils import Database

from encoders.motion import Motion
from encoders.skeleton import BONE_LENGTHS, INDEX, PARENTS, RAW_OFFSETS


def standing() -> NDArray[np.float64]:
    """The 22 joints (22, 3) of a figure that stands, arms hanging."""
    offsets = RAW_OFFSETS * BONE_LENGTHS[:, None]
    joints = np.zeros_like(offsets)
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            joints[joint] = joints[parent] + offsets[joint]
    return joints - [0, joints[:, 1].min(), 0]


def moving(seed: int, seconds: float = 4.0, fps: float = 20.0) -> NDArray[np.float64]:
    """Joints (T, 22, 3): a figure that walks off and swings its arms in a way of its own."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds * fps)) / fps
    joints = np.repeat(standing()[None], len(time), axis=0)
    joints[..., 2] += rng.uniform(0, 2) * time[:, None]
    for side in ("left", "right"):
        swing = rng.uniform(0.2, 1.5) * np.sin(rng.uniform(1, 5) * time + rng.uniform(0, 6))
        shoulder = joints[:, INDEX[f"{side}_shoulder"]]
        for joint in ("elbow", "wrist"):
            reach = shoulder[:, 1] - joints[:, INDEX[f"{side}_{joint}"], 1]
            joints[:, INDEX[f"{side}_{joint}"], 1] = shoulder[:, 1] - reach * np.cos(swing)
            joints[:, INDEX[f"{side}_{joint}"], 2] = shoulder[:, 2] + reach * np.sin(swing)
    return joints


def write(path: Path, seed: int, seconds: float = 4.0) -> Path:
    """A motion file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    np.save(path, moving(seed, seconds).astype(np.float32))
    return path


class SmallBundle:
    """Stands in for `encoders.bundle.bundle.Bundle`: a fixed projection of the mean pose and its spread."""

    def __init__(self, name: str = "small", latent_size: int = 16) -> None:
        self.name = name
        self.fingerprint = blake2b(name.encode(), digest_size=16).hexdigest()
        self.fps, self.max_frames, self.latent_size = 10.0, 100, latent_size
        self._weights = np.random.default_rng(sum(name.encode())).standard_normal((132, latent_size))
        self.sentences: list[str] = []

    def features(self, motion: Motion) -> NDArray[np.float32]:
        joints = motion.resample(self.fps).joints
        return (joints - joints[:, :1]).reshape(len(joints), -1)

    def encode_features(self, features: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
        described = [np.concatenate([rows.mean(axis=0), rows.std(axis=0)]) for rows in features]
        latents = np.array(described).reshape(-1, 132) @ self._weights
        return (latents / np.linalg.norm(latents, axis=1, keepdims=True)).astype(np.float32)

    def encode_motions(self, motions: Sequence[Motion]) -> NDArray[np.float32]:
        return self.encode_features([self.features(motion) for motion in motions])

    def encode_texts(self, sentences: Sequence[str]) -> NDArray[np.float32]:
        self.sentences += sentences
        rows = [np.random.default_rng(list(s.encode())).standard_normal(self.latent_size) for s in sentences]
        latents = np.array(rows).reshape(-1, self.latent_size)
        return (latents / np.linalg.norm(latents, axis=1, keepdims=True)).astype(np.float32)


def without_marks(connection: sqlite3.Connection) -> None:
    """Take from a library what versions 7 and 8 brought: marks, and the words of paths."""
    connection.execute("DROP TABLE marks")
    clips = Database(connection).table("clips")
    clips.disable_fts()
    connection.execute("ALTER TABLE clips DROP COLUMN words")
    clips.enable_fts(["name"], create_triggers=True)
