"""The manifest of a bundle: read, validated, and checked against the bundle's files."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from encoders.errors import BundleError
from encoders.features.registry import feature_kind

FORMAT = 1
MANIFEST, MOTION, TEXT, TOKENIZER, CALIBRATION = (
    "manifest.json", "motion.onnx", "text.onnx", "tokenizer.json", "calibration.npz",
)  # fmt: skip

#: Files without which there is no bundle; they, and nothing else in the folder, decide an embedding.
REQUIRED = (MOTION, TEXT, TOKENIZER)

#: Bounds of what a manifest may state: numbers of a vector and feature frames of a motion, files, bytes of each.
MAX_LATENT, MAX_FRAMES, MAX_FILES, LARGEST_FILE = 1 << 13, 1 << 16, 64, 2 << 30
_LARGEST_MANIFEST = 1 << 20


@dataclass(frozen=True)
class Manifest:
    """A checked manifest.

    Attributes
    ----------
    max_frames : int
        Longest motion, in feature frames, that passes the encoder as a whole.
    files : mapping of name to sha256
        Every file of the bundle but the manifest; plain names inside the folder.
    values : mapping
        The whole document, with what is for people only (licence, training).
    """

    name: str
    feature_kind: str
    max_frames: int
    latent_size: int
    files: Mapping[str, str]
    values: Mapping[str, Any]

    @property
    def fingerprint(self) -> str:
        """sha256 over all that changes an embedding: the graphs, the tokenizer, the features and the window."""
        parts = {
            "feature_kind": self.feature_kind,
            "max_frames": self.max_frames,
            "files": {name: self.files[name] for name in REQUIRED},
        }
        return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def digest(path: Path) -> str:
    """sha256 of a file, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest() if hasattr(hashlib, "file_digest") else _digest(file)


def _digest(file: Any) -> str:
    total = hashlib.sha256()
    while block := file.read(1 << 20):
        total.update(block)
    return total.hexdigest()


def read_manifest(folder: Path) -> Manifest:
    """Read and check a bundle's manifest and the digest of each file it names.

    Raises
    ------
    BundleError
        If the folder is no bundle, is of a format or feature kind this version does not know, names a file outside
        itself, or a file is missing or differs from its sha256.
    """
    manifest = stated_manifest(folder)
    for name, expected in manifest.files.items():
        _verify(folder / name, expected)
    return manifest


def stated_manifest(folder: Path) -> Manifest:
    """Read and check a bundle's manifest alone, as `read_manifest` does; its files may be damaged."""
    path = folder / MANIFEST
    try:
        if path.stat().st_size > _LARGEST_MANIFEST:
            raise BundleError(f"{path}: too large for a manifest")
        values = json.loads(path.read_text("utf-8"))
    except FileNotFoundError as error:
        raise BundleError(f"{folder}: no model bundle here ({MANIFEST} is missing)") from error
    except (OSError, ValueError, RecursionError) as error:
        raise BundleError(f"{path}: cannot be read ({error})") from error
    return _checked(path, values)


def _checked(path: Path, values: Any) -> Manifest:
    if not isinstance(values, dict):
        raise BundleError(f"{path}: not a manifest")
    if values.get("format") != FORMAT:
        raise BundleError(
            f"{path}: format {values.get('format')!r}, this version reads {FORMAT}; update motionseek or the bundle"
        )
    types = {"name": str, "feature_kind": str, "max_frames": int, "latent_size": int, "files": dict}
    for key, kind in types.items():
        if not isinstance(values.get(key), kind) or isinstance(values[key], bool):
            raise BundleError(f"{path}: {key!r} is missing or no {kind.__name__}")
    try:
        feature_kind(values["feature_kind"])
    except BundleError as error:
        raise BundleError(f"{path}: {error}") from error
    if values["max_frames"] < 1 or values["latent_size"] < 1:
        raise BundleError(f"{path}: 'max_frames' and 'latent_size' must be positive")
    for key, most in (("max_frames", MAX_FRAMES), ("latent_size", MAX_LATENT)):
        if values[key] > most:
            raise BundleError(f"{path}: {key!r} is more than {most}")
    files = values["files"]
    if len(files) > MAX_FILES:
        raise BundleError(f"{path}: lists {len(files)} files, more than {MAX_FILES}")
    for name in files:
        if name != Path(name).name or name in ("", ".", "..", MANIFEST) or "\\" in name or "\0" in name:
            raise BundleError(f"{path}: {name!r} is no plain file name")
    missing = [name for name in REQUIRED if name not in files]
    if missing:
        raise BundleError(f"{path}: does not list {', '.join(missing)}")
    return Manifest(
        name=values["name"],
        feature_kind=values["feature_kind"],
        max_frames=values["max_frames"],
        latent_size=values["latent_size"],
        files=files,
        values=values,
    )


def _verify(path: Path, expected: Any) -> None:
    if path.is_symlink() or not path.is_file():
        raise BundleError(f"{path}: missing or no plain file; install the bundle again")
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise BundleError(f"{path}: larger than {LARGEST_FILE >> 30} GB")
        actual = digest(path)
    except OSError as error:
        raise BundleError(f"{path}: cannot be read ({error})") from error
    if actual != expected:
        raise BundleError(f"{path}: damaged (sha256 differs from the manifest's); install the bundle again")
