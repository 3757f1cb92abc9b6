"""Long takes with exact annotations."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.concatenation import concatenate_clips
from encoders.corpus.composition.long_takes import joined_take, synthetic_take
from encoders.motion import Motion
from encoders.skeleton import INDEX


def walker(frames: int, *, heading: float = 0.0, place: tuple[float, float] = (0.0, 0.0), step: float = 0.05) -> Motion:
    """A stiff figure that faces and moves along `heading` (0: along z)."""
    pose = np.zeros((22, 3))
    pose[:, 1] = np.linspace(0.9, 1.7, 22)
    for side, sign in (("left", 1), ("right", -1)):
        for joint in ("hip", "shoulder"):
            pose[INDEX[f"{side}_{joint}"], 0] = 0.1 * sign
    joints = np.repeat(pose[None], frames, axis=0)
    joints[..., 2] += step * np.arange(frames)[:, None]
    c, s = np.cos(heading), np.sin(heading)
    turned = joints @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    turned[..., 0] += place[0]
    turned[..., 2] += place[1]
    return Motion(turned)


def test_each_clip_starts_where_and_facing_as_the_previous_one_ended() -> None:
    clips = [walker(40).joints, walker(30, heading=2.0, place=(5, -3)).joints, walker(20, heading=-1.0).joints]
    joined = concatenate_clips(clips)
    assert joined.shape == (90, 22, 3)
    root = joined[:, INDEX["pelvis"]]
    assert root[:, 0] == pytest.approx(np.zeros(90), abs=1e-4)
    assert (np.diff(root[:, 2]) >= -1e-4).all()
    assert root[-1, 2] == pytest.approx(0.05 * (39 + 29 + 19), abs=1e-3)


def test_the_seam_does_not_jump() -> None:
    high = walker(20).joints + np.array([0, 0.5, 0], np.float32)
    joined = concatenate_clips([walker(20).joints, high])
    assert np.abs(np.diff(joined, axis=0)).max() < 0.15


def test_concatenation_leaves_its_inputs_unchanged() -> None:
    clips = [walker(10).joints.copy(), walker(10, heading=1.0).joints.copy()]
    before = [clip.copy() for clip in clips]
    concatenate_clips(clips)
    assert all(np.array_equal(a, b) for a, b in zip(clips, before, strict=True))


def test_annotations_of_joined_clips_are_exact_at_any_frame_rate() -> None:
    clips = [(Motion(walker(frames).joints, fps), text) for frames, fps, text in ((50, 30.0, "a"), (77, 24.0, "b"))]
    taken = joined_take([*clips, (walker(40), "a")])
    lengths = [len(motion.resample(20.0)) for motion, _ in clips] + [40]
    ends = np.cumsum(lengths) / 20
    assert len(taken.motion) == sum(lengths)
    assert [annotation.sentence for annotation in taken.annotations] == ["a", "b"]
    assert taken.annotations[0].spans == ((0.0, ends[0]), (ends[1], ends[2]))
    assert taken.annotations[1].spans == ((ends[0], ends[1]),)
    assert taken.motion.duration == ends[-1]


def test_a_synthetic_take_annotates_every_action() -> None:
    taken = synthetic_take(np.random.default_rng(3), least=12.0, most=12.0)
    spans = sorted({span for annotation in taken.annotations for span in annotation.spans})
    assert 12.0 <= taken.motion.duration < 60.0
    assert len({annotation.sentence for annotation in taken.annotations}) == len(taken.annotations)
    assert all(annotation.spans for annotation in taken.annotations)
    assert spans[0][0] == pytest.approx(0.0, abs=1.5)
    assert spans[-1][1] <= taken.motion.duration + 1e-6
    assert all(start < end for start, end in spans)
