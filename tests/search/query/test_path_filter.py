"""The filter by path: what is printed can be typed."""

from unicodedata import normalize

import numpy as np
import pytest

import motionseek
from search.query.filters import Filters
from tests.indexer.folders import SmallBundle, moving, write

NAMES = (
    "[2024] shoot/walk [1].npy",
    "[2024] shoot/walk 1.npy",
    "2 shoot/walk.npy",
    "Fights/Kick.npy",
    "fights/punch.npy",
    "fights",
    "a?b/*.npy",
    normalize("NFD", "Läufer/é.npy"),
    "plain.npy",
)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    folder = tmp_path_factory.mktemp("paths")
    with motionseek.open(folder, create=True, bundle=SmallBundle()) as library:
        for seed, name in enumerate(NAMES):
            library.add(name, moving(seed).astype(np.float32), fps=20)
        yield library


@pytest.mark.parametrize(
    ("pattern", "names"),
    [
        ("[2024] shoot", ["[2024] shoot/walk 1.npy", "[2024] shoot/walk [1].npy"]),
        ("[2024] shoot/", ["[2024] shoot/walk 1.npy", "[2024] shoot/walk [1].npy"]),
        ("[2024] shoot/*", ["[2024] shoot/walk 1.npy", "[2024] shoot/walk [1].npy"]),
        ("[2024] shoot/walk [1].npy", ["[2024] shoot/walk [1].npy"]),
        ("[[]2024] shoot/*", ["[2024] shoot/walk 1.npy", "[2024] shoot/walk [1].npy"]),
        ("[ab2] shoot/*", ["2 shoot/walk.npy"]),
        ("*/walk?1.npy", ["[2024] shoot/walk 1.npy"]),
        ("fights", ["fights", "fights/punch.npy"]),
        ("FIGHTS", ["Fights/Kick.npy", "fights", "fights/punch.npy"]),
        ("*/KICK.*", ["Fights/Kick.npy"]),
        ("a?b/*.npy", ["a?b/*.npy"]),
        ("./plain.npy", ["plain.npy"]),
        (normalize("NFC", "Läufer*"), [normalize("NFD", "Läufer/é.npy")]),
        (normalize("NFC", "läufer/É.npy"), [normalize("NFD", "Läufer/é.npy")]),
        ("*", sorted(NAMES)),
        ("nowhere", []),
        ("' OR 1 --", []),
    ],
)
def test_a_path_is_read_as_it_is_called_and_then_as_a_pattern(library, pattern, names):
    assert sorted(clip.path for clip in library.clips(path=pattern)) == sorted(names)


def test_absolute_paths_and_names_of_roots_are_taken_as_they_are_printed(tmp_path):
    for root in ("[a] shoot", "b"):
        write(tmp_path / root / "day" / "walk.npy", len(root))
    bundle = SmallBundle()
    roots = [tmp_path / "[a] shoot", tmp_path / "b"]
    motionseek.index(roots, library=tmp_path / "lib", bundle=bundle, jobs=1)
    with motionseek.open(tmp_path / "lib", bundle=bundle) as library:

        def found(path):
            return [clip.file for clip in library.clips(path=path)]

        first, second = (root / "day" / "walk.npy" for root in roots)
        for path in (first, first.parent, roots[0], "[a] shoot/day/walk.npy", "[a] shoot", f"{roots[0]}/*"):
            assert found(str(path)) == [first], path
        assert found("b/day/*") == found("B/DAY") == [second]
        assert found("day") == [first, second]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"path": "fihgts/*"}, "no clip passes path='fihgts/*'; there are fights"),
        ({"path": "zzz"}, "no clip passes path='zzz'; there are [2024] shoot/, 2 shoot/, Fights/, "),
        ({"format": "bvh"}, "no clip passes format='bvh'; there are array"),
        ({"min_duration": 99.0}, "no clip passes min_duration=99.0; clips last 4.0 to 4.0 s"),
        ({"captioned": True, "path": "*"}, "no clip passes captioned=True; no clip has a caption"),
        ({"path": "fights", "format": "array"}, ""),
        ({}, ""),
    ],
)
def test_a_filter_that_nothing_passes_says_which_part_and_what_there_is(library, given, said):
    assert Filters.of(given).why_none(library).startswith(said)
    assert bool(said) == bool(Filters.of(given).why_none(library))


def test_filters_that_nothing_passes_at_once_say_so(tmp_path):
    with motionseek.open(tmp_path, create=True, bundle=SmallBundle()) as library:
        library.add("short", moving(1, 2.0).astype(np.float32), fps=20)
        library.add("long", moving(1, 6.0).astype(np.float32), fps=20)
        why = Filters(path="short", min_duration=5).why_none(library)
        assert why == "no clip passes min_duration and path at once; each alone lets some through"
