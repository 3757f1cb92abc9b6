"""`motionseek list`: the clips of a library."""

from __future__ import annotations

import shutil
from pathlib import Path

from encoders.bundle.bundle import Bundle
from search.library import Library
from tests.search.conftest import Run, made_motion


def test_clips_as_json(indexed: Path, run: Run) -> None:
    clips = run("list", "--library", indexed, "--json").document["clips"]
    assert [clip["id"] for clip in clips] == [1, 2, 3, 4, 5]
    long = next(clip for clip in clips if clip["path"] == "take 3.npy")
    assert {"id", "root", "path", "absolute_path", "duration", "fps", "rig", "format", "captions"} <= set(long)
    assert (long["root"], long["absolute_path"]) == (indexed.name, str(indexed / "take 3.npy"))
    assert (long["duration"], long["fps"], long["format"]) == (20.0, 20.0, "npy")
    assert long["captions"] == [
        {"text": "bückt sich", "start": 2.0, "end": 5.0},
        {"text": "waves", "start": 6.0, "end": 9.0},
    ]


def test_piped_clips_are_lines_with_tabs(indexed: Path, run: Run) -> None:
    rows = [line.split("\t") for line in run("list", "--library", indexed).out.splitlines()]
    assert len(rows) == 5
    number, root, path, seconds, fps, kind, _, caption = next(row for row in rows if row[2] == "take 1.npy")
    assert (root, path, seconds, fps, kind, caption) == (indexed.name, path, "4.0", "20", "npy", "a person walks")
    assert run("describe", number, "--library", indexed, "--json").document["path"] == path


def test_filters_choose_clips(indexed: Path, run: Run) -> None:
    clips = run("list", "--captioned", "--min-duration", 10, "--library", indexed, "--json").document["clips"]
    assert [clip["path"] for clip in clips] == ["take 3.npy"]
    none = run("list", "--format", "exe", "--library", indexed)
    assert (none.code, none.out) == (0, "")
    assert "no clip passes format='exe'; there are npy, bvh" in none.err


def test_clips_are_sorted(indexed: Path, run: Run) -> None:
    def listed(*options: object) -> list[dict[str, object]]:
        found: list[dict[str, object]] = run("list", *options, "--library", indexed, "--json").document["clips"]
        return found

    orders = {"longest": ("duration", True), "shortest": ("duration", False), "newest": ("added", True)}
    for sort, (key, reverse) in ({"name": ("name", False)} | orders).items():
        values = [clip[key] for clip in listed("--sort", sort)]
        assert values == sorted(values, key=str.casefold if key == "name" else None, reverse=reverse), sort
    long = [clip["duration"] for clip in listed("--sort", "longest", "--min-duration", 7)]
    assert long == sorted(long, reverse=True)
    assert 0 < len(long) < 5


def test_files_of_one_name_are_told_apart(takes: Path, run: Run, tmp_path: Path) -> None:
    folders = [tmp_path / name / "shots" for name in ("a", "b")]
    for folder in folders:
        folder.mkdir(parents=True)
        shutil.copy(takes / "take 0.npy", folder)
    library = tmp_path / "library"
    assert run("index", *folders, "--library", library, "--jobs", 1).code == 0
    clips = run("list", "--library", library, "--json").document["clips"]
    assert {clip["path"] for clip in clips} == {"take 0.npy"}
    assert [clip["root"] for clip in clips] == ["shots", "shots (2)"]
    assert [clip["absolute_path"] for clip in clips] == [str(folder / "take 0.npy") for folder in folders]
    ambiguous = run("describe", "take 0.npy", "--library", library)
    assert (ambiguous.code, ambiguous.err.count("\n")) == (1, 1)
    for clip in clips:
        assert f"#{clip['id']}" in ambiguous.err
        assert run("describe", f"#{clip['id']}", "--library", library).code == 0


def test_a_clip_without_a_file_has_no_absolute_path(run: Run, tmp_path: Path, tiny_bundle: Path) -> None:
    with Library.open(tmp_path / "arrays", create=True, bundle=Bundle.load(tiny_bundle)) as library:
        library.add("walk", made_motion(2.0, 0))
    (clip,) = run("list", "--library", tmp_path / "arrays", "--json").document["clips"]
    assert (clip["path"], clip["absolute_path"]) == ("walk", None)


def test_clips_whose_files_are_all_gone_are_said_to_be(indexed: Path, run: Run, tmp_path: Path) -> None:
    """As with a drive that is not mounted: the library holds them still."""
    own = Path(shutil.copytree(indexed, tmp_path / "takes"))
    for path in [*own.glob("*.npy"), *own.rglob("*.bvh")]:
        path.unlink()
    run("index", own)
    assert "the files of all 5 clips are gone" in run("list", "--library", own).err
    assert "the files of all 5 clips are gone" in run("search", "walks", "--library", own).err
