"""Files with several clips: animations and figures, through indexing, references and captions."""

from __future__ import annotations

import sqlite3
from dataclasses import replace

import numpy as np
import pytest

from encoders.errors import UnknownClip, UnreadableMotion
from indexer.formats.bvh import bvh_reader as reader
from indexer.ingest import file_parts, indexing, storing
from indexer.ingest.load import load_motion, read_motions
from indexer.ingest.pool import Read
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.stored_library import StoredLibrary
from indexer.store.tables import digests, migrations
from search.library import Library
from search.references import find_source
from tests.indexer.folders import SmallBundle, without_marks
from tests.indexer.performances import bvh, performance, together

WALK, RUN = bvh(performance(seed=1)), bvh(performance(seed=2, frames=50))
PAIR = together(WALK, bvh(replace(performance(seed=3), root=np.add(performance().root, [1.5, 0, 0]))))
#: No joints but a chain.
CHAIN = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n}\nMOTION\n" + (
    "Frames: 2\nFrame Time: 0.05\n0 0 0\n0 0 0\n"
)


@pytest.fixture(autouse=True)
def reading(monkeypatch):
    """Reads in this process; a file whose first line is names has a BVH text for each, after lines of `===`."""

    def read_takes(path, *, fps=None):
        names, _, texts = path.read_text().partition("\n===\n")
        if not texts:
            return reader.read(path, names.encode(), fps=fps)
        pairs = zip(names.split(","), texts.split("===\n"), strict=True)
        return [replace(take, name=name) for name, text in pairs for take in reader.read(path, text.encode(), fps=fps)]

    def read_all(requests, jobs):
        for request in requests:
            try:
                yield request.key, Read(tuple(read_motions(request.path, request.fps)))
            except UnreadableMotion as error:
                yield request.key, Read(reason=error.reason)

    monkeypatch.setattr(file_parts, "read_takes", read_takes)
    monkeypatch.setattr(storing, "read_all", read_all)


def scene(path, **texts):
    path.write_text(",".join(texts) + "\n===\n" + "===\n".join(texts.values()))


def index(root):
    return indexing.index(root, bundle=SmallBundle())


@pytest.fixture
def root(tmp_path):
    folder = tmp_path / "takes"
    folder.mkdir()
    scene(folder / "hero.bvh", Walk=WALK, Run=RUN)
    scene(folder / "single.bvh", Take=RUN)
    (folder / "pair.bvh").write_text(PAIR)
    return folder


def paths(root):
    with StoredLibrary.open(root) as library:
        return {clip.path: clip.id for clip in library.clips()}


def test_each_animation_and_each_figure_is_a_clip(root):
    summary = index(root)
    assert summary.indexed == 3
    assert sorted(paths(root)) == ["hero.bvh#Run", "hero.bvh#Walk", "pair.bvh", "pair.bvh#2", "single.bvh"]
    with StoredLibrary.open(root) as library:
        run = library.find("hero.bvh#Run")
        assert (run.name, run.file, run.frames) == ("hero#Run", root / "hero.bvh", 50)
        np.testing.assert_allclose(library.motion(run.id).joints, load_motion(root / "single.bvh").joints, atol=2e-4)


@pytest.mark.parametrize(
    ("ref", "path"),
    [
        ("hero.bvh#Walk", "hero.bvh#Walk"),
        ("hero#Walk", "hero.bvh#Walk"),
        ("single.bvh#Take", "single.bvh"),
        ("pair.bvh#1", "pair.bvh"),
        ("pair.bvh#2", "pair.bvh#2"),
    ],
)
def test_a_clip_is_found_by_its_part_also_by_an_absolute_path(root, ref, path):
    index(root)
    with Library.open(root, bundle=SmallBundle()) as library:
        assert library.find(ref).path == path
        if ".bvh" in ref:
            assert find_source(str(root / ref), library).path == path


def test_a_file_of_several_animations_needs_a_name(root):
    index(root)
    with StoredLibrary.open(root) as library:
        with pytest.raises(UnknownClip, match=r"2 clips are called so.*hero.bvh#Walk.*hero.bvh#Run"):
            library.find("hero.bvh")
        with pytest.raises(UnknownClip, match="no clip of that path"):
            library.find("hero.bvh#Fly")
    with pytest.raises(UnreadableMotion, match=r"several takes; name one of them: hero.bvh#Walk, hero.bvh#Run"):
        load_motion(root / "hero.bvh")
    with pytest.raises(UnreadableMotion, match="no take 'Fly'"):
        load_motion(root / "hero.bvh#Fly")


def test_a_file_without_a_library_is_read_by_part(root):
    assert len(load_motion(root / "hero.bvh#Run")) == 50
    assert len(load_motion(root / "single.bvh#Take")) == 50
    first, second = (load_motion(root / name).joints for name in ("pair.bvh", "pair.bvh#2"))
    np.testing.assert_array_equal(first, load_motion(root / "pair.bvh#1").joints)
    assert np.abs(first - second).max() > 0.3
    assert find_source(str(root / "pair.bvh#2"), None).file == root / "pair.bvh"


@pytest.mark.parametrize(("part", "other"), [("pair.bvh", "pair.bvh#2"), ("pair.bvh#2", "pair.bvh")])
def test_the_figure_that_is_meant_is_exported_alone(root, tmp_path, part, other):
    index(root)
    with Library.open(root, bundle=SmallBundle()) as library:
        out = load_motion(library.export(part, tmp_path / "cut.bvh")).joints
        indexed = library.motion(library.find(part).id).joints
    np.testing.assert_allclose(out, indexed, atol=1e-3)
    np.testing.assert_allclose(out, load_motion(root / part).joints, atol=1e-3)
    assert np.abs(out - load_motion(root / other).joints).max() > 0.3


def test_a_take_without_a_body_is_named_and_the_others_are_read(root):
    scene(root / "hero.bvh", Walk=WALK, Camera=CHAIN)
    summary = index(root)
    ((path, warning),) = summary.reading_warnings
    assert path == f"{root / 'hero.bvh'}#Walk"
    assert warning.startswith("Camera is left out: no joint found for")
    with StoredLibrary.open(root) as library:
        assert library.find("hero.bvh").warnings == (warning,)
        assert library.stats()["with_warnings"] == 1


def test_a_file_without_any_body_fails_with_the_first_reason(root):
    scene(root / "hero.bvh", Camera=CHAIN, Light=CHAIN)
    ((path, reason),) = index(root).failed
    assert path == str(root / "hero.bvh")
    assert reason.startswith("no joint found for")


def test_a_changed_file_keeps_the_clips_whose_parts_it_still_has(root):
    index(root)
    before = paths(root)
    scene(root / "hero.bvh", Run=WALK, Jump=RUN)
    index(root)
    after = paths(root)
    assert after["hero.bvh#Run"] == before["hero.bvh#Run"]
    assert "hero.bvh#Walk" not in after
    assert after["hero.bvh#Jump"] not in before.values()
    with StoredLibrary.open(root, bundle=SmallBundle()) as library:
        queries = SmallBundle().encode_motions([load_motion(root / "hero.bvh#Jump")])
        assert set(library.nearest_clips(queries, 9)[1][0]) - {-1} == set(after.values())


def test_a_file_that_moves_takes_all_its_clips_along(root):
    index(root)
    before = paths(root)
    (root / "hero.bvh").rename(root / "heroine.bvh")
    assert index(root).moved == 1
    after = paths(root)
    assert [after[f"heroine.bvh#{part}"] for part in ("Walk", "Run")] == [
        before[f"hero.bvh#{part}"] for part in ("Walk", "Run")
    ]


def test_captions_name_a_part_or_else_the_first_clip_of_the_file(root):
    (root / "captions.csv").write_text("path,text\nhero.bvh#Run,runs\npair.bvh#2,follows\npair.bvh,leads\nhero.bvh,x\n")
    (root / "hero.txt").write_text("a hero\n")
    warnings = index(root).warnings
    told = "'hero.bvh' has several clips; its captions went to 'hero.bvh#Walk'"
    assert warnings == [f"{root / name}: {told}" for name in ("captions.csv", "hero.txt")]

    def captions():
        with StoredLibrary.open(root) as library:
            return {clip.path: [c.text for c in library.captions(clip.id)] for clip in library.clips()}

    found = captions()
    assert found["hero.bvh#Run"] == ["runs"]
    assert sorted(found["hero.bvh#Walk"]) == ["a hero", "x"]
    assert (found["pair.bvh"], found["pair.bvh#2"]) == (["leads"], ["follows"])
    scene(root / "hero.bvh", Run=RUN, Jump=WALK)  # the first clip has gone
    index(root)
    assert sorted(captions()["hero.bvh#Run"]) == ["a hero", "runs", "x"]


def test_a_library_from_before_is_searched_and_then_read_again(root, monkeypatch):
    (root / "hero.bvh").unlink()
    (root / "captions.csv").write_text("path,text\npair.bvh,leads\n")
    index(root)
    file = root / FOLDER / FILE
    _downgrade(file)
    with StoredLibrary.open(root, bundle=SmallBundle()) as library:
        old = {clip.path: clip for clip in library.clips()}
        assert old["pair.bvh"].warnings == ()
        assert old["pair.bvh"].document()["up"] is None
        assert library.find(root / "single.bvh").id == old["single.bvh"].id
        assert [c.text for c in library.captions(old["pair.bvh"].id)] == ["leads"]
        summary = index(root)
        assert (summary.indexed, summary.unchanged) == (2, 0)
        assert library.find("pair.bvh#2").source_frames == 30  # the connection of before sees the new tables
    new = paths(root)
    assert new["pair.bvh"] == old["pair.bvh"].id
    with StoredLibrary.open(root) as library:
        assert library.find("single.bvh").up == "y"
        assert [c.text for c in library.captions(new["pair.bvh"])] == ["leads"]


def _downgrade(file):
    """Make a library what version 1 would have written for the first clip of each file."""
    db = sqlite3.connect(file)
    for table in ("captions", "poses", "embeddings", "windows"):
        db.execute(f"DELETE FROM {table} WHERE clip_id IN (SELECT id FROM clips WHERE part != '')")
    db.execute("DELETE FROM clips WHERE part != ''")
    for index_name in ("idx_clips_file_id_part", "idx_clips_clip_path"):
        db.execute(f"DROP INDEX {index_name}")
    for column in [*(name for name, _, _ in migrations.READING), "clip_path"]:
        db.execute(f"ALTER TABLE clips DROP COLUMN {column}")
    db.execute("CREATE UNIQUE INDEX idx_clips_file_id ON clips(file_id)")
    db.execute("UPDATE files SET recipe = '[1, null, false, []]'")
    db.execute("DROP TABLE generations")
    db.execute("DROP INDEX captions_split")
    for column in ("split", "up"):
        db.execute(f"ALTER TABLE captions DROP COLUMN {column}")
    for table in digests.COVERED:
        db.execute(f"ALTER TABLE {table} DROP COLUMN digest")
    without_marks(db)
    db.execute("PRAGMA user_version = 1")
    db.commit()
    db.close()
