"""Errors over HTTP: a status code for each cause, and nothing about the server's file system."""

from __future__ import annotations

import os
import shutil

import pytest

from encoders import errors
from search.server.snapshot_library import SnapshotLibrary

SECRET = "/srv/secret/takes"


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (errors.UnknownClip(f"{SECRET}: no clip #9"), 404),
        (errors.QueryError("the sentence is empty"), 422),
        (errors.ArgumentError("k: must be positive"), 422),
        (errors.UnreadableMotion(f"{SECRET}/a.bvh", "no motion"), 422),
        (errors.LibraryNotFound(f"{SECRET}: no library here"), 503),
        (errors.LibraryLocked(f"{SECRET}: locked"), 503),
        (errors.LibraryDamaged(f"{SECRET}: damaged"), 503),
        (errors.LibraryError(f"{SECRET}: permission denied"), 503),
        (errors.BundleMismatch(f"{SECRET}: another model"), 503),
        (errors.BundleError(f"{SECRET}: no manifest"), 503),
        (OSError(2, "No such file", f"{SECRET}/a.bvh"), 500),
    ],
    ids=lambda value: type(value).__name__,
)
def test_each_cause_has_its_code_and_no_message_names_a_folder(served, monkeypatch, error, code):
    client = served(raise_server_exceptions=False)

    def fail(self):
        raise error

    monkeypatch.setattr(SnapshotLibrary, "stats", fail)
    response = client.get("/api/stats")
    assert (response.status_code, list(response.json())) == (code, ["error"])
    assert len(response.json()["error"]) > 10
    assert SECRET not in response.text


def test_a_removed_library_names_no_folder(served, tmp_path):
    client = served(raise_server_exceptions=False)
    (tmp_path / "takes" / ".motionseek" / "library.sqlite").rename(tmp_path / "gone")
    for url in URLS:
        assert_private(client, url, tmp_path)


@pytest.mark.parametrize("lost", ["source files", "nothing"])
def test_no_response_contains_an_absolute_path(served, tmp_path, lost):
    client = served(raise_server_exceptions=False)
    if lost == "source files":
        shutil.rmtree(tmp_path / "takes" / "deep er")
    for url in URLS:
        assert_private(client, url, tmp_path)
    for body in (b"", b"HIERARCHY\nROOT x", b"\x93NUMPY\x01\x00"):
        for name in ("a.bvh", "a.npy", "a.amc", "a"):
            response = client.post("/api/similar", params={"name": name}, content=body)
            assert response.status_code == 422
            assert os.sep + "tmp" not in response.text


#: Every route, and ways in which it fails. Clips 1 to 5 exist.
URLS = [
    "/api/search?q=walks",
    "/api/search?q=",
    "/api/search?q=walks&min_duration=3&max_duration=1",
    "/api/search?q=walks&path=*",
    "/api/moments?q=walks",
    *(
        url.replace("CLIP", clip)
        for clip in ("1", "2", "3", "4", "5", "%235", "99", "u" + "0" * 32, "take%201")
        for url in (
            "/api/moments?q=walks&clip=CLIP",
            "/api/curve?q=walks&clip=CLIP",
            "/api/describe?clip=CLIP",
            "/api/describe?clip=CLIP&start=500",
            "/api/similar?clip=CLIP",
            "/api/similar?clip=CLIP&start=1&end=1.1",
            "/api/motions/CLIP",
            "/api/motions/CLIP/joints",
            "/api/motions/CLIP/joints?start=500",
            "/api/export?clip=CLIP",
            "/api/export?clip=CLIP&start=500",
        )
    ),
    "/api/motions",
    "/api/skeleton",
    "/api/stats",
    "/api/map",
    "/api/nothing",
    "/healthz",
    "/metrics",
    "/openapi.json",
    "/nothing.html",
]


def assert_private(client, url, folder):
    response = client.get(url)
    text = response.content + "".join(response.headers.values()).encode()
    for place in (str(folder), str(folder).encode("unicode_escape").decode(), "motionseek-"):
        assert place.encode() not in text, (url, response.text)
