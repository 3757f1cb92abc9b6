"""Every route: its response, and that it equals the command line's."""

from __future__ import annotations

import io
import json
import re
import shutil
import threading

import numpy as np
import pytest

from encoders.skeleton import JOINTS
from indexer.ingest.file_parts import read_take
from indexer.store.stored_library import StoredLibrary
from search.export import joints_binary
from search.server.routes import library as library_routes

BVH, LONG, CAPTIONED = "deep er/bücken.bvh", "take 3.npy", "take 1.npy"


def _without_clip(document):
    document.pop("clip", None)
    return document


def _similarity(document):
    """The curves, taken out of an answer."""
    curves = document["curve"].pop("similarity")
    return {f"{sentence} {i}": value for sentence, values in curves.items() for i, value in enumerate(values)}


def test_search_answers_what_the_command_line_does(ask, run, indexed, number):
    found = ask("/api/search", q="a person walks", k=3)
    assert [hit["clip"] for hit in found["hits"]] == [number(hit["path"]) for hit in found["hits"]]
    said = run("search", "a person walks", "-k", "3", "--library", indexed, "--json").document
    assert _without_clip(found) == said


def test_pages_of_a_search_make_up_one_ranking(ask):
    whole = ask("/api/search", q="waves", k=5)["hits"]
    parts = [ask("/api/search", q="waves", k=2, offset=offset)["hits"] for offset in (0, 2, 4)]
    assert [hit for part in parts for hit in part] == whole
    assert [hit["rank"] for hit in whole] == [1, 2, 3, 4, 5]


def test_what_a_question_takes_away_is_said_and_its_pages_make_up_one_ranking(ask, run, indexed):
    whole = ask("/api/search", q="walks -waves", k=5)
    assert whole["without"] == ["waves"]
    assert "without" not in ask("/api/search", q="walks", k=5)
    assert ask("/api/moments", q="walks without waving, then sits", k=1)["without"] == ["waving"]
    parts = [ask("/api/search", q="walks -waves", k=2, offset=offset)["hits"] for offset in (0, 2, 4)]
    assert [hit for part in parts for hit in part] == whole["hits"]
    assert whole["hits"] == run("search", "walks -waves", "-k", "5", "--library", indexed, "--json").document["hits"]


@pytest.mark.parametrize(
    ("route", "given"),
    [
        ("similar", {}),
        ("similar", {"moments": True}),
        ("similar", {"start": 1, "end": 3, "moments": True}),
        ("moments", {"q": "waves"}),
        ("moments", {"q": "waves", "clip": LONG}),
        ("moments", {"q": "walks", "while": "waves"}),
        ("moments", {"q": "walks, then waves"}),
    ],
)
def test_pages_of_similar_clips_and_moments_make_up_one_ranking(ask, number, route, given):
    of = {"clip": number(LONG)} if route == "similar" or "clip" in given else {}
    whole = ask(f"/api/{route}", k=50, **given | of)["hits"]
    parts = [ask(f"/api/{route}", k=2, offset=offset, **given | of)["hits"] for offset in range(0, len(whole), 2)]
    assert [hit for part in parts for hit in part] == whole
    assert len({(hit["path"], hit["start"], hit["end"]) for hit in whole}) == len(whole) > 0


def test_pages_of_clips_similar_to_a_span_make_up_one_ranking(ask, number):
    of = {"clip": number(LONG), "start": 1, "end": 3}
    parts = [ask("/api/similar", k=1, offset=offset, **of)["hits"] for offset in (0, 1, 2)]
    assert [hit["rank"] for part in parts for hit in part] == [1, 2, 3]
    assert len({hit["path"] for part in parts for hit in part}) == 3


@pytest.mark.parametrize(
    ("given", "paths"),
    [
        ({"min_duration": 10}, {LONG}),
        ({"max_duration": 2.5}, {"take 0.npy"}),
        ({"path": "deep er/*"}, {BVH}),
        ({"format": "bvh"}, {BVH}),
        ({"captioned": "true"}, {CAPTIONED, LONG}),
        ({"captioned": "true", "min_duration": 10}, {LONG}),
        ({"rig": "none such"}, set()),
    ],
)
def test_filters_choose_which_clips_are_asked(ask, given, paths):
    assert {hit["path"] for hit in ask("/api/search", q="walks", **given)["hits"]} == paths
    assert {motion["path"] for motion in ask("/api/motions", **given)["motions"]} == paths


def test_filters_beside_a_clip_are_refused(client, number):
    for given in ({"path": "x*"}, {"min_duration": 0}, {"captioned": "false"}):
        response = client.get("/api/moments", params={"q": "walks", "clip": number(LONG), **given})
        assert response.status_code == 422
        assert response.json()["error"].startswith(next(iter(given)))


@pytest.mark.parametrize(
    ("url", "unknown"),
    [
        ("/api/search?q=walks&limit=3", "limit"),
        ("/api/moments?q=walks&meanwhile=waves", "meanwhile"),
        ("/api/motions?foo=1", "foo"),
        ("/api/stats?foo=1", "foo"),
        ("/api/motions/1?min_duration=1", "min_duration"),
    ],
)
def test_unknown_parameters_are_refused_by_name(client, url, unknown):
    response = client.get(url)
    assert response.status_code == 422
    assert response.json()["error"].startswith(f"no parameter {unknown}; ")
    assert client.get("/api/search?q=walks&token=x").status_code == 200


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("/api/curve?clip=walk&q=walks", "clip: must be a clip's number, such as 12 or #12, or the key of an upload"),
        ("/api/motions/walk", "clip: must be a clip's number"),
        ("/api/search", "q: is missing"),
        ("/api/search?q=", "q: must not be empty"),
        ("/api/search?q=walks&k=many", "k: must be a whole number"),
        ("/api/search?q=walks&k=0", "k: must be 1 or more"),
        ("/api/search?q=walks&k=201", "k: must be 200 or less"),
        ("/api/search?q=walks&min_duration=x", "min_duration: must be a number"),
        ("/api/search?q=walks&captioned=maybe", "captioned: must be true or false"),
        ("/api/export?clip=1&format=fbx", "format: must be 'bvh', 'glb', 'npz' or 'npy'"),
    ],
)
def test_the_error_says_what_a_parameter_must_be(client, url, said):
    response = client.get(url)
    assert response.status_code == 422
    assert response.json()["error"].startswith(said)


@pytest.mark.parametrize("sentence", ["walks", "walks, then sits down"])
def test_moments_in_a_take_answer_what_the_command_line_does(ask, run, indexed, number, sentence):
    found = ask("/api/moments", q=sentence, clip=number(LONG), k=2)
    assert {hit["clip"] for hit in found["hits"]} == {number(LONG)}
    said = run("moments", sentence, LONG, "-k", "2", "--library", indexed, "--json").document
    assert _similarity(found) == pytest.approx(_similarity(said), abs=1e-6)
    assert _without_clip(found) == said


def test_moments_in_the_library_answer_what_the_command_line_does(ask, run, indexed):
    found = ask("/api/moments", q="walks", k=3)
    assert "curve" not in found
    assert _without_clip(found) == run("moments", "walks", "-k", "3", "--library", indexed, "--json").document


def test_moments_take_explicit_steps_and_simultaneous_actions(ask, number):
    steps = ask("/api/moments", then=["walks", "waves"], clip=number(LONG))
    assert (steps["how"], steps["sentences"]) == ("then", ["walks", "waves"])
    assert [step["text"] for step in steps["hits"][0]["steps"]] == ["walks", "waves"]
    at_once = ask("/api/moments", **{"q": "walks", "while": "waves"}, clip=number(LONG))
    assert (at_once["how"], at_once["sentences"]) == ("while", ["walks", "waves"])
    assert ask("/api/moments", **{"while": ["walks", "waves"]}, clip=number(LONG)) == at_once
    whole = ask("/api/moments", q="walks, then waves", split="false", clip=number(LONG))
    assert "how" not in whole


def test_a_curve_for_each_sentence(ask, number):
    curve = ask("/api/curve", clip=number(LONG), q=["walks", "waves"])
    assert (curve["clip"], curve["path"], curve["duration"]) == (number(LONG), LONG, 20.0)
    assert list(curve["similarity"]) == ["walks", "waves"]
    assert {len(values) for values in curve["similarity"].values()} == {len(curve["times"])}
    assert 0 <= curve["times"][0] < 1
    assert 19 < curve["times"][-1] <= 20
    assert curve["times"] == sorted(curve["times"])


def test_describe_answers_what_the_command_line_does(ask, run, indexed, number):
    found = ask("/api/describe", clip=number(LONG), start=2, end=5, k=3)
    assert found.pop("clip") == number(LONG)
    said = run("describe", LONG, "--start", "2", "--end", "5", "-k", "3", "--library", indexed, "--json").document
    assert found == said


@pytest.mark.parametrize("moments", [False, True])
def test_similar_answers_what_the_command_line_does(ask, run, indexed, number, moments):
    found = ask("/api/similar", clip=number(LONG), start=2, end=5, k=3, moments=moments)
    assert number(LONG) not in [hit["clip"] for hit in found["hits"]]
    flags = ["--moments"] if moments else []
    said = run(
        "similar", LONG, "--start", "2", "--end", "5", "-k", "3", "--library", indexed, "--json", *flags
    ).document
    assert _without_clip(found) == said


def test_motions_page_by_page(ask):
    whole = ask("/api/motions")
    said = {motion["path"]: [caption["text"] for caption in motion["captions"]] for motion in whole["motions"]}
    assert said[CAPTIONED] == ["a person walks", "a man strolls"]
    assert said[BVH] == []
    assert whole["total"] == len(whole["motions"]) == 5
    assert ask("/api/motions", offset=2, limit=2) == {"total": 5, "motions": whole["motions"][2:4]}
    assert ask("/api/motions", offset=99)["motions"] == []


def test_a_motion_with_its_captions(ask, number, indexed):
    motion = ask(f"/api/motions/{number(LONG)}")
    assert ask(f"/api/motions/%23{number(LONG)}") == motion, "a number may be written as on the command line: #4"
    assert motion["root"] == indexed.name
    assert (motion["path"], motion["name"], motion["format"]) == (LONG, "take 3", "npy")
    assert (motion["duration"], motion["fps"], motion["frames"]) == (20.0, 20.0, 400)
    assert motion["captions"] == [
        {"text": "bückt sich", "start": 2.0, "end": 5.0},
        {"text": "waves", "start": 6.0, "end": 9.0},
    ]


def test_the_joints_of_a_span(client, number, indexed):
    response = client.get(f"/api/motions/{number(LONG)}/joints", params={"start": 9.5, "end": 12})
    motion, start = joints_binary.unpack(response.content)
    assert (start, motion.fps, len(motion)) == (9.5, 20.0, 50)
    with StoredLibrary.open(indexed) as library:
        want = library.motion(number(LONG), 9.5, 12)
    np.testing.assert_allclose(motion.joints, want.joints, atol=1.1e-4)
    slower, _ = joints_binary.unpack(client.get(f"/api/motions/{number(LONG)}/joints", params={"fps": 5}).content)
    assert (slower.fps, len(slower)) == (5.0, 100)


def test_joints_are_sent_again_only_when_they_changed(client, number):
    url = f"/api/motions/{number(LONG)}/joints?start=1&end=2"
    tag = client.get(url).headers["etag"]
    again = client.get(url, headers={"If-None-Match": tag})
    assert (again.status_code, again.content) == (304, b"")
    other = client.get(url.replace("end=2", "end=3"), headers={"If-None-Match": tag})
    assert other.status_code == 200


@pytest.mark.parametrize(("start", "begin"), [(1.0, 1.0), (1.02, 1.0), (1.03, 1.05), (19.99, 19.95)])
def test_joints_state_the_time_of_their_first_frame(client, number, start, begin):
    cut, said = joints_binary.unpack(client.get(f"/api/motions/{number(LONG)}/joints", params={"start": start}).content)
    assert said == pytest.approx(begin)
    whole, _ = joints_binary.unpack(client.get(f"/api/motions/{number(LONG)}/joints").content)
    np.testing.assert_allclose(cut.joints, whole.joints[round(begin * 20) :], atol=1e-3)


def test_the_skeleton(ask):
    skeleton = ask("/api/skeleton")
    assert skeleton["joints"] == list(JOINTS)
    assert skeleton["parents"][0] == -1


def test_export_cuts_a_bvh_in_its_own_rig(client, number, indexed, tmp_path):
    response = client.get("/api/export", params={"clip": number(BVH), "start": 1, "end": 3})
    assert re.search(r"filename\*=utf-8''b%C3%BCcken_1-3\.bvh", response.headers["content-disposition"])
    (tmp_path / "cut.bvh").write_bytes(response.content)
    cut, whole = read_take(tmp_path / "cut.bvh"), read_take(indexed / BVH)
    np.testing.assert_allclose(cut.positions, whole.positions[20:60], atol=1e-3)


def test_export_as_arrays(client, number):
    response = client.get("/api/export", params={"clip": number(LONG), "start": 1, "end": 3, "format": "npz"})
    with np.load(io.BytesIO(response.content), allow_pickle=False) as cut:
        assert cut["joints"].shape == (40, 22, 3)
        assert cut["fps"] == 20
    response = client.get("/api/export", params={"clip": number(LONG), "format": "npy"})
    assert np.load(io.BytesIO(response.content), allow_pickle=False).shape == (400, 22, 3)


def test_stats_are_those_of_status(ask, run, indexed):
    stats = ask("/api/stats")
    assert stats.pop("version")
    status = run("status", "--library", indexed, "--json").document
    assert status.pop("folder") == str(indexed / ".motionseek")
    assert status.pop("roots") == [str(indexed)]
    assert stats.pop("roots") == [indexed.name], "absolute paths stay on the server"
    assert {**stats, "bytes": 0} == {**status, "bytes": 0}


def test_the_map_holds_every_clip(ask, indexed, number):
    drawn = ask("/api/map")
    assert sorted(drawn["clips"]) == sorted(number(path) for path in (BVH, LONG, CAPTIONED, "take 0.npy", "take 2.npy"))
    assert {len(drawn[name]) for name in ("clips", "x", "y", "label")} == {5}
    assert all(0 <= value <= 1 for value in (*drawn["x"], *drawn["y"]))
    assert set(drawn["label"]) == set(range(len(drawn["labels"])))
    kept = [path.name for path in (indexed / ".motionseek" / "previews").glob("map.*")]
    assert kept == [f"map.{drawn['generation']}.npz"]
    assert ask("/api/map") == drawn


@pytest.mark.parametrize("url", ["/healthz", "/api/search?q=walks", "/api/motions/1/joints", "/api/search?q="])
def test_head_is_get_without_the_body(client, url):
    head, get = client.head(url), client.get(url)
    assert head.content == b""
    assert head.status_code == get.status_code
    assert head.headers["content-length"] == get.headers["content-length"]


def test_health_and_metrics(client):
    assert client.get("/healthz").json() == {"status": "ok"}
    client.get("/api/search", params={"q": "a sentence of its own"})
    client.get("/api/no/such/thing")
    response = client.get("/metrics")
    assert response.headers["content-type"].startswith("text/plain; version=0.0.4")
    lines = response.text.splitlines()
    assert "motionseek_clips 5" in lines
    assert any(
        line.startswith('motionseek_requests_total{route="/api/search",method="GET",code="200"}') for line in lines
    )
    assert not any("no/such" in line for line in lines), "what clients make up would fill the memory"
    name = re.compile(r'[a-z_]+(\{[a-z]+="[^"]*"(,[a-z]+="[^"]*")*\})? [0-9.e+-]+')
    assert all(line.startswith("#") or name.fullmatch(line) for line in lines)


def test_the_page_or_an_error(client):
    response = client.get("/")
    assert response.status_code in (200, 404)
    kind = "text/html; charset=utf-8" if response.status_code == 200 else "application/json"
    assert response.headers["content-type"] == kind


@pytest.mark.parametrize(
    "url",
    [
        "/api/search",
        "/api/search?q=",
        "/api/search?q=%20%2C%20",
        "/api/search?q=" + "x" * 501,
        "/api/search?q=walks&k=0",
        "/api/search?q=walks&k=many",
        "/api/search?q=walks&min_duration=5&max_duration=1",
        "/api/search?q=walks&min_duration=nan",
        "/api/moments",
        "/api/moments?q=walks&then=sits&while=waves",
        "/api/curve?clip=1",
        "/api/describe?clip=1&start=3&end=2",
        "/api/describe?clip=1&start=500",
        "/api/describe?clip=take%201.npy",
        "/api/motions/1/joints?fps=0",
        "/api/export?clip=1&format=exe",
        "/api/export?clip=1&start=500",
        "/api/export?clip=1&format=npy&fps=60",
    ],
)
def test_invalid_arguments_are_422(client, url):
    response = client.get(url)
    assert response.status_code == 422, response.text
    assert list(response.json()) == ["error"]
    assert len(response.json()["error"]) > 10


@pytest.mark.parametrize(
    "url", ["/api/motions/999", "/api/describe?clip=999", "/api/moments?q=walks&clip=u" + "0" * 32, "/api/nothing"]
)
def test_unknown_clips_and_routes_are_404(client, url):
    response = client.get(url)
    assert (response.status_code, list(response.json())) == (404, ["error"])


def test_a_wrong_method_is_405(client):
    response = client.delete("/api/motions/1")
    assert (response.status_code, list(response.json())) == (405, ["error"])
    assert json.loads(response.text)


def test_a_map_that_takes_long_tells_how_far_it_is(served, indexed, monkeypatch):
    shutil.rmtree(indexed / ".motionseek" / "previews", ignore_errors=True)
    laid_out, reported, go_on = library_routes.make_map, threading.Event(), threading.Event()

    def slow(*arguments):
        arguments[-1](0.4)
        reported.set()
        assert go_on.wait(60)
        return laid_out(*arguments)

    monkeypatch.setattr(library_routes, "make_map", slow)
    client = served()
    assert client.get("/api/map").status_code == 202
    assert reported.wait(60)
    waiting = client.get("/api/map")
    assert (waiting.status_code, waiting.json()["progress"], waiting.json()["count"]) == (202, 0.4, 5)
    go_on.set()
    while (answer := client.get("/api/map")).status_code == 202:
        pass
    assert len(answer.json()["clips"]) == 5


def test_a_varied_choice_holds_every_clip_once(ask):
    orders = [[motion["clip"] for motion in ask("/api/motions", seed=seed)["motions"]] for seed in range(6)]
    assert all(sorted(order) == [1, 2, 3, 4, 5] for order in orders)
    assert len({tuple(order) for order in orders}) > 1
    assert len(ask("/api/motions", seed=3, min_duration=7)["motions"]) == 2


def test_clips_are_sorted_page_by_page(ask):
    everything = [motion["duration"] for motion in ask("/api/motions", sort="longest")["motions"]]
    assert everything == sorted(everything, reverse=True)
    assert [
        motion["duration"] for motion in ask("/api/motions", sort="longest", offset=1, limit=2)["motions"]
    ] == everything[1:3]
    assert ask("/api/motions", sort="longest", min_duration=7)["total"] == 2
