"""Several people in one take become one take each; what is no second person stays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from indexer.formats.bvh import bvh_reader as reader
from indexer.rigs.figures import figures
from indexer.rigs.mapping import map_rig
from indexer.rigs.retarget import retarget
from indexer.take import Take
from tests.indexer.performances import bvh, performance, together

FIRST, SECOND = (
    bvh(performance(seed=1)),
    bvh(replace(performance(seed=2), root=np.add(performance().root, [1.5, 0, 0]))),
)


def read(text: str) -> Take:
    (take,) = reader.read("a.bvh", text.encode())
    return take


def below_one_root(*takes: Take) -> Take:
    """Takes as scenes hold them: the skeletons hang below one node at the origin."""
    counts = np.cumsum([1, *(len(take.names) for take in takes)])
    parents = [np.where(take.parents < 0, 0, take.parents + n) for take, n in zip(takes, counts, strict=False)]
    frames = len(takes[0].positions)
    return Take(
        names=("scene", *(name for take in takes for name in take.names)),
        parents=np.concatenate([[-1], *parents]),
        rest=np.concatenate([np.zeros((1, 3)), *(take.rest for take in takes)]),
        positions=np.concatenate([np.zeros((frames, 1, 3)), *(take.positions for take in takes)], axis=1),
        fps=20.0,
        name="Dance",
    )


def prop(frames: int) -> Take:
    """A chain of 20 joints that is no body."""
    places = np.stack([np.arange(20.0), np.zeros(20), np.zeros(20)], axis=-1)
    moved = places + np.arange(frames)[:, None, None] * 0.1
    return Take(tuple(f"link{n}" for n in range(20)), np.arange(-1, 19), places, moved, 20.0)


def test_two_roots_are_two_figures_each_as_in_a_file_of_its_own():
    both = figures(read(together(FIRST, SECOND)))
    assert [take.name for take in both] == ["", "2"]
    for take, text in zip(both, (FIRST, SECOND), strict=True):
        alone = read(text)
        assert take.names == alone.names
        np.testing.assert_allclose(take.positions, alone.positions, atol=1e-5)
        joints = retarget(take, path="").joints
        np.testing.assert_allclose(joints, retarget(alone, path="").joints, atol=1e-4)


def test_figures_below_one_node_are_found_and_named_after_the_take():
    first, second = read(FIRST), read(SECOND)
    found = figures(below_one_root(first, second))
    assert [take.name for take in found] == ["Dance", "Dance#2"]
    np.testing.assert_array_equal(found[1].positions, second.positions)
    assert found[1].parents[0] == -1


@pytest.mark.parametrize(
    "take",
    [
        read(FIRST),
        below_one_root(read(FIRST)),
        below_one_root(read(FIRST), prop(30)),
        read(bvh(performance("mixamo"))),
        read(bvh(performance("daz"))),
    ],
    ids=["one", "below a node", "with a prop", "mixamo", "daz"],
)
def test_a_take_of_one_person_is_left_as_it_is(take):
    assert figures(take) == [take]


def hand(frames: int) -> Take:
    """A hand as a skeleton of its own: five fingers of four joints, of which two pairs and a middle one are like."""
    spread, lengths = np.linspace(-0.04, 0.04, 5), (0.09, 0.09, 0.11, 0.07, 0.07)
    names, parents, places = ["hand"], [-1], [np.zeros(3)]
    for finger, (x, size) in enumerate(zip(spread, lengths, strict=True)):
        for bone in range(4):
            parents.append(0 if bone == 0 else len(names) - 1)
            names.append(f"f{finger}_{bone}")
            places.append(np.array([x, 0.08 + bone * size / 3, 0.0]))
    rest = np.array(places)
    return Take(tuple(names), np.array(parents), rest, rest + np.arange(frames)[:, None, None] * 0.1, 20.0)


def test_hands_with_roots_of_their_own_are_no_people():
    body, left, right = read(FIRST), hand(30), hand(30)
    assert map_rig(left, "").missing == []  # by its shape a hand is a body
    take = below_one_root(body, left, replace(right, positions=right.positions + 1))
    assert figures(take) == [take]


def test_people_without_names_are_told_apart_by_shape():
    first, second = (
        replace(read(text), names=tuple(f"j{n}" for n in range(200))[: len(read(text).names)])
        for text in (FIRST, SECOND)
    )
    found = figures(below_one_root(first, second))
    assert len(found) == 2


def test_a_second_skeleton_on_the_same_body_is_no_second_person():
    first = read(FIRST)
    (only,) = figures(below_one_root(first, first))
    assert only.names == first.names


def test_someone_who_stands_still_is_a_person_too():
    first, second = read(FIRST), read(SECOND)
    still = replace(second, positions=np.repeat(second.rest[None], 30, axis=0))
    found = figures(below_one_root(still, first))
    assert [take.name for take in found] == ["Dance", "Dance#2"]
    np.testing.assert_array_equal(found[1].positions, first.positions)
