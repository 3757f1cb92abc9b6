"""Times are the file's own: a pose that is cut off before the movement shifts nothing that a person sees or gives."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import motionseek
from encoders.skeleton import INDEX
from indexer.ingest.file_parts import read_take
from search.export.annotations import as_babel, as_eaf
from search.hits import Hit
from tests.indexer.folders import standing
from tests.indexer.performances import Performance, bvh, performance

RATE = 60.0
LEADS = (0.1, 0.35, 0.8)
SENTENCE, STEPS = "a person waves", ("walks", "turns around")


def led(acted: Performance, seconds: float) -> Performance:
    """With the rest pose held before it."""
    count = round(seconds * RATE)
    rest = np.broadcast_to(np.eye(3), (count, *acted.rotations.shape[1:]))
    return replace(
        acted,
        rotations=np.concatenate([rest, acted.rotations]),
        root=np.concatenate([np.repeat(acted.root[:1], count, axis=0), acted.root]),
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("leads") / "takes"
    root.mkdir()
    acted = performance(frames=480, fps=RATE, seed=4)
    (root / "plain.bvh").write_text(bvh(acted))
    rows = ["path,text,start,end", "plain.bvh,early,0.5,2", "plain.bvh,late,4,6"]
    for lead in LEADS:
        (root / f"{lead}.bvh").write_text(bvh(led(acted, lead)))
        rows += [f"{lead}.bvh,early,{0.5 + lead},{2 + lead}", f"{lead}.bvh,late,{4 + lead},{6 + lead}"]
    (root / "captions.csv").write_text("\n".join(rows) + "\n")
    motionseek.index(root, jobs=1)
    return root


@pytest.fixture(scope="module")
def library(folder: Path):
    with motionseek.open(folder) as opened:
        yield opened


@pytest.fixture(params=LEADS)
def lead(request: pytest.FixtureRequest) -> float:
    return round(request.param * RATE) / RATE


def name(lead: float) -> str:
    return "plain.bvh" if not lead else f"{min(LEADS, key=lambda other: abs(other - lead))}.bvh"


def spans(hits: list[Hit]) -> np.ndarray:
    return np.array([(hit.start, hit.end) for hit in hits])


def test_the_clip_says_where_the_movement_begins(library, lead):
    clip = library.find(name(lead))
    assert clip.start == pytest.approx(lead)
    assert (clip.source_fps, clip.source_frames) == (pytest.approx(RATE), 480 + round(lead * RATE))
    assert clip.duration == library.find("plain.bvh").duration


def test_moments_are_later_by_the_lead_indexed_or_not(library, folder, lead):
    plain = spans(library.moments(SENTENCE, "plain.bvh"))
    np.testing.assert_allclose(spans(library.moments(SENTENCE, name(lead))), plain + lead, atol=1e-6)
    np.testing.assert_allclose(spans(motionseek.moments(SENTENCE, folder / name(lead))), plain + lead, atol=0.11)
    across = [hit for hit in library.moments(SENTENCE, k=40) if hit.path in ("plain.bvh", name(lead))]
    here, there = (spans([hit for hit in across if hit.path == path]) for path in ("plain.bvh", name(lead)))
    np.testing.assert_allclose(np.sort(there, axis=0), np.sort(here, axis=0) + lead, atol=1e-6)


def test_so_are_steps_curves_and_whole_clips(library, lead):
    (plain,), (moved,) = (library.moments(None, path, 1, then=STEPS) for path in ("plain.bvh", name(lead)))
    for step, later in zip(plain.steps, moved.steps, strict=True):
        assert (later.start, later.end) == (pytest.approx(step.start + lead), pytest.approx(step.end + lead))
    found = {hit.path: hit for hit in library.similar("plain.bvh", 5)}
    whole = found[name(lead)]
    assert (whole.start, whole.end) == (pytest.approx(lead), pytest.approx(lead + whole.duration))
    assert library.search(SENTENCE)[0].read() is not None


def test_segments_cover_the_movement_in_the_files_time(library, folder, lead):
    segments = library.segment(name(lead), ["walking", "waving"])
    assert segments[0].start == pytest.approx(lead)
    assert segments[-1].end == pytest.approx(lead + library.find("plain.bvh").duration)
    assert all(a.end == b.start for a, b in pairwise(segments))
    assert motionseek.segment(folder / name(lead), ["walking", "waving"])[0].start == pytest.approx(lead)
    labelled = [replace(segments[0], label="walking")]
    assert f'"start_t": {segments[0].start:.3f}'.rstrip("0") in as_babel(labelled, "x")
    assert f'TIME_VALUE="{round(lead * 1000)}"' in as_eaf(labelled, "x")


def test_a_hit_gets_the_caption_of_its_span(library, lead):
    source = library.source(name(lead))
    assert source.caption(0.6 + lead, 1.5 + lead) == "early"
    assert source.caption(4.1 + lead, 5 + lead) == "late"
    for hit in library.moments(SENTENCE, name(lead)):
        same = next(h for h in library.moments(SENTENCE, "plain.bvh") if h.rank == hit.rank)
        assert hit.caption == same.caption


def test_a_span_that_is_given_means_the_same_movement(library, folder, lead):
    start, end = 2.0, 4.5
    plain = library.source("plain.bvh").cut(start, end).joints
    for source in (library.source(name(lead)), library.source(folder / name(lead), fps=RATE)):
        np.testing.assert_allclose(source.cut(start + lead, end + lead).joints, plain, atol=2e-3)
    clip = library.find(name(lead))
    np.testing.assert_allclose(library.motion(clip.id, start + lead, end + lead).joints, plain, atol=2e-3)
    assert library.describe(name(lead), 3, start + lead, end + lead)[0] == pytest.approx(
        library.describe("plain.bvh", 3, start, end)[0], abs=0.02
    )


def test_a_span_from_before_the_movement_begins_with_it(library, lead):
    source = library.source(name(lead))
    np.testing.assert_array_equal(source.cut(0.0, lead + 1).joints, source.cut(lead, lead + 1).joints)
    with pytest.raises(motionseek.QueryError, match=rf"lies outside its {lead:g} to "):
        source.cut(0.0, lead)
    with pytest.raises(motionseek.QueryError, match=rf"lies outside its {lead:g} to "):
        library.motion(source.clip_id, 20, 30)


def test_an_export_cuts_exactly_the_frames_that_a_hit_names(library, folder, lead, tmp_path):
    whole = read_take(folder / name(lead)).positions
    hits = (*library.moments(SENTENCE, name(lead))[:2], library.similar("plain.bvh", 5)[0])
    for number, hit in enumerate(hits):
        out = read_take(library.export(hit, tmp_path / f"{number}.bvh")).positions
        source = read_take(folder / hit.path).positions
        assert hit.source_fps == pytest.approx(RATE)
        np.testing.assert_allclose(out, source[hit.first_frame : hit.last_frame + 1], atol=1e-4)
    out = read_take(library.export(name(lead), tmp_path / "cut.bvh", 2.0 + lead, 4.5 + lead)).positions
    np.testing.assert_allclose(out, whole[round((2 + lead) * RATE) : round((4.5 + lead) * RATE)], atol=1e-4)


def test_a_whole_export_leaves_out_the_lead_alone(library, folder, lead, tmp_path):
    out = read_take(library.export(name(lead), tmp_path / "whole.bvh")).positions
    np.testing.assert_allclose(out, read_take(folder / "plain.bvh").positions, atol=1e-4)


def test_the_server_answers_in_the_files_time_of_clips_and_of_uploads(folder, lead):
    pytest.importorskip("fastapi")
    from starlette.testclient import TestClient

    from search.export import joints_binary
    from search.server.app import create_app
    from search.server.snapshot_library import SnapshotLibrary

    with TestClient(create_app(SnapshotLibrary.open(folder)), base_url="http://127.0.0.1:8420") as client:
        clip = {m["path"]: m["clip"] for m in client.get("/api/motions").json()["motions"]}[name(lead)]
        upload = client.post("/api/describe", params={"name": "x.bvh"}, content=(folder / name(lead)).read_bytes())
        for key in (clip, upload.json()["clip"]):
            info = client.get(f"/api/motions/{key}").json()
            assert (info["start"], info["source_fps"]) == (pytest.approx(lead, abs=1e-3), pytest.approx(RATE, abs=0.01))
            whole, begin = joints_binary.unpack(client.get(f"/api/motions/{key}/joints").content)
            assert begin == pytest.approx(lead)
            span = {"start": 2 + lead, "end": 3 + lead}
            part, begin = joints_binary.unpack(client.get(f"/api/motions/{key}/joints", params=span).content)
            assert begin == pytest.approx(2 + lead)
            np.testing.assert_allclose(part.joints, whole.joints[40:60], atol=1e-3)
            answer = client.get("/api/moments", params={"clip": key, "q": SENTENCE}).json()
            assert answer["curve"]["times"][0] == pytest.approx(lead + 0.05, abs=2e-3)
            first = answer["hits"][0]
            assert lead - 1e-3 <= first["start"] < first["end"] <= lead + info["duration"] + 1e-3
            assert first["first_frame"] == round(first["start"] * RATE)


def test_arrays_keep_their_own_times_too(library, lead, tmp_path):
    t_pose = standing()
    for side, sign in (("left", 1), ("right", -1)):
        for joint, reach in (("elbow", 0.26), ("wrist", 0.51)):
            away = np.array([sign * reach, 0, 0])
            t_pose[INDEX[f"{side}_{joint}"]] = t_pose[INDEX[f"{side}_shoulder"]] + away
    count = round(lead * 20)
    joints = np.concatenate([np.repeat(t_pose[None], count, axis=0), library.source("plain.bvh").motion.joints])
    source = library.source(joints, fps=20)
    assert (source.start, source.reading.source_frames) == (pytest.approx(count / 20), len(joints))
    with motionseek.open(tmp_path / "arrays", create=True) as made:
        made.add("led", joints, fps=20)
        assert made.find("led").start == source.start
