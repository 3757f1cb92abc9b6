"""Composing over HTTP: motions, pinned clips, files, and what is refused."""

from __future__ import annotations

import base64
import io
import json
import zipfile

import pytest

from search.export import joints_binary

SENTENCES = [
    {"text": "walks", "start": 0, "end": 2},
    {"text": "waves", "start": 0.5, "end": 1.5, "parts": ["left arm"]},
]


def test_a_time_line_becomes_a_motion(client):
    answer = client.post("/api/compose", json={"sentences": SENTENCES}).json()
    motion, start = joints_binary.unpack(base64.b64decode(answer["joints"]))
    assert (motion.duration, start) == (answer["duration"], 0.0)
    assert [one["text"] for one in answer["intervals"]] == ["walks", "waves"]
    for one in answer["intervals"]:
        assert (one["clip"], one["source_start"]) in [(o["clip"], o["source_start"]) for o in one["options"]]


def test_a_sentence_is_shown_by_the_clip_it_is_pinned_to(client):
    first, _ = client.post("/api/compose", json={"sentences": SENTENCES}).json()["intervals"]
    for option in first["options"]:
        at = (option["source_start"] + option["source_end"]) / 2
        pinned = [{**SENTENCES[0], "clip": option["clip"], "at": at}, SENTENCES[1]]
        shown = client.post("/api/compose", json={"sentences": pinned}).json()["intervals"][0]
        assert (shown["clip"], shown["source_start"]) == (option["clip"], option["source_start"])
    gone = client.post("/api/compose", json={"sentences": [{**SENTENCES[0], "clip": 10**9}]})
    assert gone.status_code == 422
    assert "clip #1000000000" in gone.json()["error"]


def test_filters_choose_the_clips(client):
    asked = client.post("/api/compose?format=bvh", json={"sentences": SENTENCES[:1]}).json()
    assert {option["path"].rpartition(".")[2] for option in asked["intervals"][0]["options"]} == {"bvh"}


def test_the_file_comes_with_its_report(client):
    response = client.post("/api/compose/file?to=npy", json={"sentences": SENTENCES})
    packed = zipfile.ZipFile(io.BytesIO(response.content))
    assert packed.namelist() == ["composition.json", "composition.npy"]
    assert json.loads(packed.read("composition.json"))["intervals"][0]["text"] == "walks"


@pytest.mark.parametrize(
    ("sentences", "reason"),
    [
        ([], "sentences"),
        ([{"text": "", "start": 0, "end": 2}], "text: must not be empty"),
        ([{"text": "walks", "start": 0, "end": 0.1}], "last 0.5 s at least"),
        ([{"text": "walks", "start": 0, "end": 999}], "end"),
        ([{"text": "walks", "start": 0, "end": 2, "parts": ["tail"]}], "legs"),
        ([{"text": "walks", "start": 0, "end": 2}, {"text": "sits", "start": 3, "end": 4}], "nothing happens"),
        ([{"text": "walks", "start": 0, "end": 2}, {"text": "runs", "start": 1, "end": 3}], "both need"),
    ],
)
def test_what_is_no_time_line_is_refused(client, sentences, reason):
    response = client.post("/api/compose", json={"sentences": sentences})
    assert response.status_code == 422
    assert reason in response.json()["error"]
