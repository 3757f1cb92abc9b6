"""The manifest of a bundle: read, checked against the files, refused where it makes no sense."""

from __future__ import annotations

import json

import pytest

from encoders.bundle.manifest import REQUIRED, digest, read_manifest
from encoders.errors import BundleError
from tests.encoders.bundle.conftest import change


def test_the_fingerprint_follows_what_changes_an_embedding_and_nothing_else(copy):
    before = read_manifest(copy).fingerprint
    change(copy, licence="another", name="renamed", training={"steps": 3})
    assert read_manifest(copy).fingerprint == before
    change(copy, max_frames=50)
    assert read_manifest(copy).fingerprint != before
    change(copy, max_frames=100)
    (copy / "motion.onnx").write_bytes((copy / "motion.onnx").read_bytes() + b"\0")
    change(copy, files={name: digest(copy / name) for name in REQUIRED})
    assert read_manifest(copy).fingerprint != before


@pytest.mark.parametrize("name", REQUIRED)
def test_a_damaged_or_missing_file_is_named(copy, name):
    content = bytearray((copy / name).read_bytes())
    content[len(content) // 2] ^= 1
    (copy / name).write_bytes(content)
    with pytest.raises(BundleError, match=f"{name}: damaged"):
        read_manifest(copy)
    (copy / name).unlink()
    with pytest.raises(BundleError, match=f"{name}: missing"):
        read_manifest(copy)


@pytest.mark.parametrize(
    "name", ["../outside.bin", "/etc/hostname", "sub/file", "..", ".", "", "a\\b", "a\0b", "manifest.json"]
)
def test_a_manifest_that_points_elsewhere_is_refused(copy, name):
    (copy.parent / "outside.bin").write_bytes(b"outside")
    files = json.loads((copy / "manifest.json").read_text())["files"]
    change(copy, files=files | {name: "0" * 64})
    with pytest.raises(BundleError, match="no plain file name"):
        read_manifest(copy)


def test_a_link_out_of_the_folder_is_refused(copy):
    outside = copy.parent / "outside.json"
    (copy / "tokenizer.json").rename(outside)
    (copy / "tokenizer.json").symlink_to(outside)
    with pytest.raises(BundleError, match="no plain file"):
        read_manifest(copy)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"format": 99}, "format 99, this version reads 1"),
        ({"format": None}, "format None"),
        ({"feature_kind": "astrology"}, "feature kind 'astrology' is unknown; known: .*body"),
        ({"max_frames": "many"}, "'max_frames' is missing or no int"),
        ({"max_frames": True}, "'max_frames' is missing or no int"),
        ({"latent_size": 0}, "must be positive"),
        ({"name": None}, "'name' is missing"),
        ({"files": {}}, "does not list motion.onnx"),
        ({"files": []}, "'files' is missing or no dict"),
    ],
)
def test_a_manifest_that_makes_no_sense_is_refused(copy, values, message):
    change(copy, **values)
    with pytest.raises(BundleError, match=message):
        read_manifest(copy)


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 100_000, " " * 2_000_000])
def test_what_is_no_manifest_is_refused(copy, text):
    (copy / "manifest.json").write_text(text)
    with pytest.raises(BundleError, match=r"manifest\.json"):
        read_manifest(copy)


def test_a_folder_without_manifest_is_no_bundle(tmp_path):
    with pytest.raises(BundleError, match="no model bundle here"):
        read_manifest(tmp_path)
