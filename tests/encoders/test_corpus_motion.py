"""Made motion does what its scene says, on bodies that keep their bones, with feet that stand still."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from encoders.corpus.actions.programs import compatible, parts_of, programs, sample_step
from encoders.corpus.composition.scene_clips import act_scene, make_clip
from encoders.corpus.engine.arm_carriage import CARRIAGES
from encoders.corpus.engine.curves import ANKLE, HANGING, STAND, Curves, standing
from encoders.corpus.engine.joining import join
from encoders.corpus.engine.posing import OFFSETS, pose, random_geometry
from encoders.corpus.engine.program import program
from encoders.corpus.engine.style import NEUTRAL, STYLES, Manner, apply_manner
from encoders.corpus.engine.style_variants import STYLE_VARIANTS
from encoders.corpus.scene import ActionStep, Scene, SceneClip
from encoders.motion import Motion
from encoders.skeleton import INDEX, PARENTS

PROGRAMS = programs()
OWN = sorted(n for n, p in PROGRAMS.items() if p.make.__module__.rpartition(".")[2] in {
    "locomotion", "turning", "stepping", "paths", "bowing", "unsteady",
    "jumps", "climbing", "posture", "bending", "floor", "acrobatics"})  # fmt: skip


def plain(*groups: ActionStep | tuple[ActionStep, ...], seed: int = 0) -> SceneClip:
    scene = Scene(tuple(g if isinstance(g, tuple) else (g,) for g in groups))
    return make_clip(scene, np.random.default_rng(seed), variation=0.0)


def act(step: ActionStep, seed: int = 0, frames: int = 0) -> Curves:
    return PROGRAMS[step.action].make(step, NEUTRAL, np.random.default_rng(seed), frames)


def joint(clip: SceneClip, name: str) -> np.ndarray:
    return clip.joints[:, INDEX[name]].astype(np.float64)


def test_the_same_seed_makes_the_same_clip() -> None:
    scene = Scene(((ActionStep("walk"), ActionStep("wave", side="left")), (ActionStep("sit down"),)))
    first, second, other = (make_clip(scene, np.random.default_rng(seed)) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first.joints, second.joints)
    assert first.spans == second.spans
    assert first.joints.shape != other.joints.shape or not np.allclose(first.joints, other.joints)


@pytest.mark.parametrize("name", OWN)
def test_every_program_makes_a_human_clip_whatever_it_is_asked(name: str) -> None:
    for seed in range(3):
        rng = np.random.default_rng(seed)
        clip = make_clip(Scene(((sample_step(PROGRAMS[name], rng, detail=0.8),),)), rng)
        assert clip.joints.dtype == np.float32
        assert np.isfinite(clip.joints).all()
        assert 0.5 <= len(clip.joints) / clip.fps <= 40
        assert -0.3 < clip.joints[..., 1].min() < 0.6
        speed = np.linalg.norm(np.diff(clip.joints, axis=0), axis=-1).max() * clip.fps
        assert speed < 25, "no joint leaps between frames"
        (start, end), *_ = clip.spans
        assert 0 <= start < end <= len(clip.joints) / clip.fps + 1e-6


def test_there_are_many_programs_with_the_particulars_they_honour() -> None:
    assert len(OWN) >= 60
    assert {"left", "backward", "zigzag", "clockwise", "in place"} <= set(PROGRAMS["walk"].directions)
    assert all(p.weight > 0 and p.starts and p.ends for p in PROGRAMS.values())
    with pytest.raises(ValueError, match="twice"):
        program("walk", group="locomotion")(PROGRAMS["walk"].make)


def test_bones_keep_their_lengths() -> None:
    rng = np.random.default_rng(0)
    curves = act_scene(Scene(((ActionStep("run"),), (ActionStep("squat", count=2),))), rng)
    joints = pose(curves, random_geometry(rng))
    bones = np.linalg.norm(joints[:, 1:] - joints[:, PARENTS[1:]], axis=-1)
    np.testing.assert_allclose(bones, np.broadcast_to(bones[0], bones.shape), atol=1e-9)


def test_knees_bend_forward_and_elbows_back() -> None:
    clip = plain(ActionStep("walk", direction="forward"))
    for side in ("left", "right"):
        hip, knee, ankle = (joint(clip, f"{side}_{n}") for n in ("hip", "knee", "ankle"))
        assert ((knee - (hip + ankle) / 2)[:, 2] > -0.01).all()
        shoulder, elbow, wrist = (joint(clip, f"{side}_{n}") for n in ("shoulder", "elbow", "wrist"))
        assert ((elbow - (shoulder + wrist) / 2)[:, 2] < 0.02).mean() > 0.95


@pytest.mark.parametrize(
    "step",
    [
        ActionStep("walk", direction="forward"),
        ActionStep("walk", direction="clockwise"),
        ActionStep("walk", direction="backward"),
        ActionStep("turn", direction="left"),
        ActionStep("sidestep", direction="left"),
        ActionStep("squat", count=2),
        ActionStep("march"),
    ],
    ids=str,
)
def test_feet_do_not_slide_in_stance(step: ActionStep) -> None:
    curves = act(step)
    flat = (np.abs(curves.feet[..., 1] - ANKLE) < 1e-3) & (np.abs(curves.foot_pitch) < 1e-3)
    stands = flat[1:] & flat[:-1]
    assert stands.mean() > 0.15
    speed = np.linalg.norm(np.diff(curves.feet[..., [0, 2]], axis=0), axis=-1) * 20
    assert speed[stands].mean() < 0.02, "planted in the curves"
    posed = pose(curves, OFFSETS)[:, [INDEX["left_ankle"], INDEX["right_ankle"]]]
    speed = np.linalg.norm(np.diff(posed[..., [0, 2]], axis=0), axis=-1) * 20
    assert speed[stands].mean() < 0.05, "and within reach of the legs"


@pytest.mark.parametrize(("direction", "toward"), [
    ("forward", (0, 1)), ("backward", (0, -1)), ("left", (1, 0)), ("right", (-1, 0)),
    ("forward-left", (1, 1)), ("forward-right", (-1, 1)), ("backward-left", (1, -1)),
])  # fmt: skip
def test_walking_goes_where_the_step_says_left_being_plus_x(direction: str, toward: tuple[int, int]) -> None:
    for seed in range(6):
        curves = act(ActionStep("walk", direction=direction), seed, 100)
        way = curves.root[-1, [0, 2]] - curves.root[0, [0, 2]]
        for axis in (0, 1):
            if toward[axis]:
                assert way[axis] * toward[axis] > 0.3
    assert plain(ActionStep("walk", direction="forward")).joints[0, INDEX["left_hip"], 0] > 0


@pytest.mark.parametrize(
    ("direction", "sign"), [("left", 1), ("right", -1), ("counterclockwise", 1), ("clockwise", -1)]
)
def test_turning_left_is_counterclockwise_from_above(direction: str, sign: int) -> None:
    assert all(sign * act(ActionStep("turn", direction=direction), seed).heading[-1] > 0.9 for seed in range(4))
    assert sign * act(ActionStep("spin jump", direction=direction)).heading[-1] > 0.9
    clip = plain(ActionStep("turn", direction=direction))
    across = joint(clip, "left_hip") - joint(clip, "right_hip")
    turned = np.unwrap(np.arctan2(-across[:, 2], across[:, 0]))
    assert sign * (turned[-1] - turned[0]) > 0.9


def test_walking_in_place_stays_and_back_and_forth_returns() -> None:
    assert np.abs(act(ActionStep("walk", direction="in place")).root[:, [0, 2]]).max() < 0.1
    curves = act(ActionStep("walk", direction="back and forth"), 0, 160)
    assert np.ptp(curves.root[:, 2]) > 1
    assert np.abs(np.gradient(curves.heading)).max() > 0.05


@pytest.mark.parametrize(("name", "low", "high"), [("walk", 0.7, 1.8), ("run", 0.9, 5.2), ("sprint", 1.6, 7.1)])
def test_gaits_go_at_human_speeds(name: str, low: float, high: float) -> None:
    for seed in range(8):
        speed = (
            np.linalg.norm(
                np.diff(act(ActionStep(name, direction="forward"), seed, 80).root[:, [0, 2]], axis=0), axis=1
            )
            * 20
        )
        assert low < np.median(speed) < high


def _ahead(curves: Curves) -> np.ndarray:
    return np.diff(curves.root[:, 2]) * 20


def test_who_sprints_goes_fast_in_any_manner_and_who_runs_may_not() -> None:
    tired = Manner(pace=-0.6, stride=-0.5)

    def speeds(name: str) -> list[float]:
        step, make = ActionStep(name, direction="forward"), PROGRAMS[name].make
        return [
            float(np.percentile(_ahead(make(step, tired, np.random.default_rng(seed), 80)), 90)) for seed in range(12)
        ]

    assert min(speeds("sprint")) > 2.3
    assert max(speeds("run")) < 2.3


def test_a_slower_run_lifts_the_feet_less_and_stands_longer() -> None:
    slow, fast = (
        [act(ActionStep("run", direction="forward", speed=speed), seed, 80).feet[..., 1] - ANKLE for seed in range(12)]
        for speed in ("slow", "fast")
    )
    assert np.mean([x.max() for x in slow]) < 0.75 * np.mean([x.max() for x in fast])
    assert np.mean([(x < 0.02).mean() for x in slow]) > np.mean([(x < 0.02).mean() for x in fast])


def test_some_runners_let_their_arms_hang_and_some_hold_them_off_the_body() -> None:
    hands = np.array(
        [act(ActionStep("run", direction="forward"), seed, 80).hands.mean(axis=(0, 1)) for seed in range(40)]
    )
    outward, height = hands[:, 0], hands[:, 1]
    assert height.min() < -0.75 < -0.6 < height.max()
    assert outward.min() < 0.06
    assert outward.max() > 0.2


def test_who_turns_at_speed_takes_room_for_it() -> None:
    for seed in range(12):
        clip = make_clip(
            Scene(((ActionStep("sprint", direction="back and forth", amplitude="large"),),)),
            np.random.default_rng(seed),
        )
        head = np.linalg.norm(np.diff(joint(clip, "head"), axis=0), axis=-1) * clip.fps
        assert head.max() < 14


def _peaks(curve: np.ndarray, level: float) -> int:
    above = curve > level
    return int((above[1:] & ~above[:-1]).sum() + above[0])


@pytest.mark.parametrize("count", [1, 2, 4])
def test_counts_are_kept(count: int) -> None:
    for seed in range(3):
        feet = act(ActionStep("jump", count=count), seed).feet[..., 1].min(axis=1)
        assert _peaks(feet, ANKLE + 0.03) == count
        assert _peaks(STAND - act(ActionStep("squat", count=count), seed).root[:, 1], 0.1) == count
        bow = act(ActionStep("bow", count=count), seed)
        assert _peaks((bow.spine + bow.pelvis)[:, 0], 0.2) == count


@pytest.mark.parametrize(("direction", "sign"), [("left", 1), ("right", -1)])
def test_sidesteps_keep_facing_ahead(direction: str, sign: int) -> None:
    turned = []
    for seed in range(8):
        curves = act(ActionStep("sidestep", direction=direction), seed)
        turned.append(np.abs(curves.heading).max())
        assert sign * (curves.root[-1, 0] - curves.root[0, 0]) > 0.3
    assert np.median(turned) < 0.2, "most keep facing ahead"
    assert max(turned) < 0.41, "a straight way bends by at most 0.4"


@pytest.mark.parametrize("count", [1, 3, 6])
@pytest.mark.parametrize(("direction", "axis", "sign"), [("forward", 2, 1), ("backward", 2, -1), ("left", 0, 1)])
def test_so_many_steps_are_taken_that_way(direction: str, axis: int, sign: int, count: int) -> None:
    for seed in range(3):
        curves = act(ActionStep("take steps", direction=direction, count=count), seed)
        lifts = sum(_peaks(curves.feet[:, foot, 1], ANKLE + 0.025) for foot in (0, 1))
        assert lifts in ((2 * count,) if direction == "left" else (count, count + 1))  # with and without closing
        assert sign * curves.root[-1, axis] > 0.1 * count


@pytest.mark.parametrize(("direction", "sign"), [("left", 1), ("right", -1)])
def test_half_a_circle_turns_half_round(direction: str, sign: int) -> None:
    for seed in range(4):
        assert 2.3 < sign * act(ActionStep("walk half circle", direction=direction), seed).heading[-1] < 4.0


def test_an_eight_goes_round_both_ways_and_comes_back() -> None:
    for seed in range(4):
        curves = act(ActionStep("walk figure eight"), seed)
        assert np.ptp(curves.heading) > 5.0
        assert abs(curves.heading[-1] - curves.heading[0]) < 1.0


@pytest.mark.parametrize(("direction", "axis", "sign"), [("forward", 2, 1), ("backward", 2, -1), ("right", 0, -1)])
def test_a_push_moves_the_body_that_way(direction: str, axis: int, sign: int) -> None:
    for seed in range(5):
        curves = act(ActionStep("get pushed", direction=direction), seed)
        assert sign * (curves.root[-1, axis] - curves.root[0, axis]) > 0.15
        assert np.abs(np.diff(curves.root[-5:], axis=0)).max() < 0.02, "it stands again"


def test_cut_clips_keep_their_spans() -> None:
    scene = Scene(((ActionStep("walk"),), (ActionStep("wave"),)))
    for seed in range(30):
        clip = make_clip(scene, np.random.default_rng(seed))
        assert all(0 <= a < b <= len(clip.joints) / clip.fps + 1e-6 for a, b in clip.spans)


@pytest.mark.parametrize("side", ["left", "right"])
def test_sides_are_the_bodys_own(side: str) -> None:
    on = ("left", "right").index(side)
    hop = act(ActionStep("hop", side=side, direction="in place"))
    middle = len(hop) // 2
    assert hop.feet[middle, on, 1] < hop.feet[middle, 1 - on, 1] - 0.1
    kneeling = act(ActionStep("kneel", side=side))
    assert kneeling.feet[:, on, 2].min() < kneeling.feet[:, 1 - on, 2].min() - 0.3
    balance = act(ActionStep("balance on one leg", side=side))
    assert balance.feet[len(balance) // 2, 1 - on, 1] > balance.feet[len(balance) // 2, on, 1] + 0.2


def test_mirrored_curves_are_the_mirrored_motion() -> None:
    curves = act_scene(
        Scene(((ActionStep("lunge", side="left"),), (ActionStep("turn", direction="left"),))), np.random.default_rng(1)
    )
    mirrored = Motion(pose(curves, OFFSETS).astype(np.float32)).mirror().joints
    np.testing.assert_allclose(pose(curves.mirrored(), OFFSETS), mirrored, atol=1e-5)
    arm = Curves(standing(4).data, [(0, 4)], frozenset({"left_arm"}))
    assert arm.mirrored().parts == {"right_arm"}


def test_steps_in_sequence_join_where_the_one_before_ended() -> None:
    walk, turn = act(ActionStep("walk", direction="forward"), 0, 60), act(ActionStep("turn", direction="left"))
    joined = join(walk, turn)
    frames = len(joined) - len(walk) - len(turn)
    assert 4 <= frames <= 26
    assert joined.spans == [(0, len(walk)), (len(walk) + frames, len(joined))]
    np.testing.assert_array_equal(joined.data[: len(walk)], walk.data)
    assert joined.heading[len(walk) + frames] == pytest.approx(walk.heading[-1])
    speed = np.linalg.norm(np.diff(pose(joined, OFFSETS), axis=0), axis=-1) * 20
    assert speed.max() < 8
    clip = plain(ActionStep("walk"), ActionStep("jump", count=2), ActionStep("sit down"))
    assert len(clip.spans) == 3
    assert all(a[1] <= b[0] for a, b in zip(clip.spans, clip.spans[1:], strict=False))


def test_steps_at_once_share_the_body() -> None:
    assert parts_of(ActionStep("wave", side="left")) == {"left_arm"}
    assert compatible(ActionStep("walk"), ActionStep("wave", side="left"))
    assert not compatible(ActionStep("walk"), ActionStep("run"))
    both = plain((ActionStep("walk", direction="forward"), ActionStep("raise arm", side="left", height="high")))
    assert len(both.spans) == 1
    raised = joint(both, "left_wrist")[:, 1] - joint(both, "left_shoulder")[:, 1]
    hanging = joint(both, "right_wrist")[:, 1] - joint(both, "right_shoulder")[:, 1]
    assert raised.max() > 0.2 > 0 > hanging.max()
    assert np.ptp(joint(both, "pelvis")[:, 2]) > 1


@pytest.mark.parametrize(("style", "measure", "sign"), [
    ("old", "bend", 1), ("proud", "bend", -1), ("tired", "speed", -1), ("energetic", "speed", 1), ("heavy", "width", 1),
    ("feminine", "width", -1), ("sad", "nod", 1), ("happy", "bob", 1), ("zombie", "hands", 1),
])  # fmt: skip
def test_styles_change_the_body(style: str, measure: str, sign: int) -> None:
    def measured(name: str) -> float:
        values = []
        for seed in range(12):
            curves = act_scene(
                Scene(((ActionStep("walk", direction="forward", style=name),),)), np.random.default_rng(seed)
            )
            values.append({
                "bend": curves.spine[:, 0].mean(),
                "speed": np.linalg.norm(np.diff(curves.root[:, [0, 2]], axis=0), axis=1).mean(),
                "width": np.abs(np.diff(curves.feet[..., 0], axis=1)).mean(),
                "nod": (curves.head + curves.spine)[:, 0].mean(),
                "bob": curves.root[:, 1].std(),
                "hands": curves.hands[..., 1].mean(),
            }[measure])  # fmt: skip
        return float(np.mean(values))

    assert sign * (measured(style) - measured("")) > 0
    assert style in STYLES


def test_other_ways_to_act_a_style_are_of_styles_that_exist_and_say_manner_fields() -> None:
    assert set(STYLE_VARIANTS) <= set(STYLES)
    named = {field.name for field in fields(NEUTRAL)}
    assert all(set(way) <= named for ways in STYLE_VARIANTS.values() for way in ways)


@pytest.mark.parametrize(("action", "style", "sign"), [
    ("stand", "old", 1), ("wave", "tired", 1), ("point", "proud", -1), ("guide", "sad", 1),
])  # fmt: skip
def test_styles_change_gestures_and_standing_too(action: str, style: str, sign: int) -> None:
    def bend(name: str) -> float:
        scene = Scene(((ActionStep(action, style=name),),))
        return float(np.mean([act_scene(scene, np.random.default_rng(s)).spine[:, 0].mean() for s in range(12)]))

    assert sign * (bend(style) - bend("")) > 0.1


@pytest.mark.parametrize("carriage", sorted(CARRIAGES))
def test_idle_hands_are_carried_but_not_the_hand_that_acts(carriage: str) -> None:
    manner = replace(NEUTRAL, carriage=carriage)
    idle, waving = standing(40), standing(40)
    waving.hands[10:30, 0] = (0.2, 0.4, 0.3)
    for curves in (idle, waving):
        apply_manner(curves, manner, np.random.default_rng(0))
    assert np.abs(idle.hands - np.array(HANGING)).max() > 0.05
    np.testing.assert_allclose(waving.hands[10:30, 0], np.broadcast_to((0.2, 0.4, 0.3), (20, 3)))


def test_who_walks_ahead_is_a_little_askew_and_diagonals_stay_apart() -> None:
    def aside(direction: str) -> np.ndarray:
        found = []
        for seed in range(40):
            curves = act(ActionStep("walk", direction=direction), seed, 80)
            way = curves.root[-1, [0, 2]] - curves.root[0, [0, 2]]
            if np.ptp(curves.heading) < 0.3:  # the others turn to where they go
                found.append(np.degrees(np.arctan2(way[0], way[1]) - curves.heading.mean()))
        return np.array(found)

    ahead, diagonal = aside("forward"), aside("forward-left")
    assert np.std(ahead) > 2
    assert np.abs(ahead).max() < 18
    assert 20 < diagonal.min() < diagonal.max() < 70


def test_bodies_and_performers_differ() -> None:
    scene = Scene(((ActionStep("stand"),),))
    clips = [make_clip(scene, np.random.default_rng(seed)) for seed in range(10)]
    across = [np.linalg.norm(joint(c, "left_shoulder") - joint(c, "right_shoulder"), axis=1).mean() for c in clips]
    assert np.std(across) > 0.015
    assert 0.2 < min(across) < max(across) < 0.6
    assert HANGING[1] < 0
    plain_bones = (
        plain(ActionStep("stand")).joints[0, INDEX["left_knee"]]
        - plain(ActionStep("stand")).joints[0, INDEX["left_hip"]]
    )
    assert np.linalg.norm(plain_bones) == pytest.approx(0.4, abs=1e-3)


def test_unknown_actions_and_styles_are_refused() -> None:
    with pytest.raises(KeyError):
        plain(ActionStep("levitate"))
    with pytest.raises(KeyError):
        plain(ActionStep("walk", style="quantum"))
