"""All hits of a search as files: their names, the table, and the credits of their sources."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from encoders.bundle.bundle import Bundle
from encoders.errors import ArgumentError, MotionSeekWarning
from indexer.ingest.file_parts import read_take
from indexer.ingest.indexing import index
from indexer.ingest.load import load_motion
from search.export.credits import credit_files
from search.export.hit_files import export_hits, file_names
from search.hits import Hit
from search.library import Library
from tests.indexer.performances import bvh, performance


@pytest.fixture
def library(tmp_path: Path, tiny_bundle: Path):
    folder = tmp_path / "takes"
    (folder / "fights" / "old").mkdir(parents=True)
    for name, seed in (("a walk.bvh", 1), ("fights/kick: high?.bvh", 2), ("fights/old/kick.bvh", 3)):
        (folder / name).write_text(bvh(performance("mixamo", frames=60, seed=seed)))
    (folder / "LICENSE.md").write_text("free for all\n")
    (folder / "fights" / "Sources.tsv").write_text("kick\tA. Performer\n")
    bundle = Bundle.load(tiny_bundle)
    index(folder, bundle=bundle, jobs=1)
    with Library.open(folder, bundle=bundle) as opened:
        yield opened


def _rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "hits.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_hits_become_files_with_a_table_and_credits(library: Library, tmp_path: Path) -> None:
    hits = library.moments("a person kicks", k=10)
    files = library.export_hits(hits, tmp_path / "out")
    rows = _rows(tmp_path / "out")
    assert [row["file"] for row in rows] == [file.name for file in files]
    assert [(row["source"], row["start"], row["strength"]) for row in rows] == [
        (hit.path, f"{hit.start:.3f}", hit.strength) for hit in hits
    ]
    for hit, file in zip(hits, files, strict=True):
        assert "mixamorig:Hips" in read_take(file).names
        assert load_motion(file).duration == pytest.approx(hit.end - hit.start, abs=0.11)
    credits = (tmp_path / "out" / "credits.txt").read_text()
    assert "== takes/LICENSE.md" in credits
    assert "free for all" in credits
    assert "== takes/fights/Sources.tsv" in credits
    assert "A. Performer" in credits
    assert not list((tmp_path / "out").glob(".*"))


@pytest.mark.parametrize("format", ["glb", "npz", "npy"])
def test_hits_in_other_formats(library: Library, tmp_path: Path, format: str) -> None:
    files = library.export_hits(library.search("a person kicks", k=2), tmp_path / "out", format)
    assert [file.suffix for file in files] == [f".{format}"] * 2
    assert all(len(load_motion(file)) for file in files)


def test_an_earlier_export_is_not_overwritten_unasked(library: Library, tmp_path: Path) -> None:
    hits = library.search("a person kicks", k=2)
    library.export_hits(hits, tmp_path / "out")
    with pytest.raises(ArgumentError, match="exists"):
        library.export_hits(hits, tmp_path / "out")
    assert library.export_hits(hits, tmp_path / "out", overwrite=True)


def test_a_hit_that_cannot_be_written_is_noted_and_the_others_are(library: Library, tmp_path: Path) -> None:
    hits = library.search("a person kicks", k=3)
    lost = Hit(4, "lost.bvh", 0.1, "", 0.0, 1.0, 2.0, file=tmp_path / "lost.bvh")
    with pytest.warns(MotionSeekWarning, match="lost"):
        files = library.export_hits([*hits, lost], tmp_path / "out")
    assert len(files) == 3
    assert _rows(tmp_path / "out")[3]["file"] == ""
    assert "no such" in _rows(tmp_path / "out")[3]["note"].lower()


def test_no_hits_are_a_table_without_rows(tmp_path: Path) -> None:
    assert export_hits([], tmp_path / "a" / "b") == []
    assert _rows(tmp_path / "a" / "b") == []


def test_names_are_safe_and_differ() -> None:
    paths = ["../../etc/passwd", "a/b:c*?.bvh", "a/b:c*?.bvh", "x" * 300 + ".bvh", "...", "größe.bvh"]
    names = file_names([Hit(i + 1, path, 0, "", 0, 1, 1) for i, path in enumerate(paths)], "bvh")
    assert names[:3] == ["1_passwd.bvh", "2_b_c.bvh", "3_b_c.bvh"]
    assert len(set(names)) == len(names)
    assert max(map(len, names)) < 100
    assert names[4:] == ["5_motion.bvh", "6_größe.bvh"]


def test_credits_come_from_the_nearest_folder_and_never_from_outside(tmp_path: Path) -> None:
    root = tmp_path / "root"
    (root / "in").mkdir(parents=True)
    (tmp_path / "LICENSE").write_text("of others")
    (root / "in" / "licensed_walk.bvh").write_text("")
    assert credit_files(root / "in" / "x.bvh", root) == []
    (root / "TERMS.txt").write_text("ask first")
    assert credit_files(root / "in" / "x.bvh", root) == [root / "TERMS.txt"]
    (root / "in" / "LICENCE").symlink_to(tmp_path / "LICENSE")
    assert credit_files(root / "in" / "x.bvh", root) == [root / "TERMS.txt"]
    (root / "in" / "credits.txt").write_text("thanks")
    assert credit_files(root / "in" / "x.bvh", root) == [root / "in" / "credits.txt"]
