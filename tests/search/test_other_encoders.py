"""A model and a kind of features of another distribution: indexed with, searched with, ranked by its token vectors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import motionseek
from encoders.errors import BundleError
from encoders.skeleton import BONE_LENGTHS, INDEX, PARENTS, RAW_OFFSETS
from search.ranking.late_interaction import max_sim
from tests.distributions import install
from tests.search.conftest import Run

#: Five chains of joints, each spread over 16 points, as MotionPatches (Yu et al., CVPR 2024) lays a body out; a patch
#: is 16 frames. The model is a toy whose answers are known: how much each chain moves, by the names of chains.
CODE = '''
import numpy as np
from motionseek import EncoderAdapter, FeatureKind

CHAINS = {"trunk": (0, 3, 6, 9, 12, 15), "left arm": (13, 16, 18, 20), "right arm": (14, 17, 19, 21),
          "left leg": (1, 4, 7, 10), "right leg": (2, 5, 8, 11)}
POINTS, FRAMES = 16, 16

def points_of_chains(motion):
    joints = motion.resample(20.0).joints
    local = joints - joints[:, :1]
    spread = []
    for chain in CHAINS.values():
        at = np.linspace(0, len(chain) - 1, POINTS)
        low = np.minimum(at.astype(int), len(chain) - 2)
        share = (at - low)[:, None]
        track = local[:, chain]
        spread.append(track[:, low] * (1 - share) + track[:, low + 1] * share)
    return np.stack(spread, axis=1).reshape(len(joints), -1).astype(np.float32)

chains = FeatureKind("points-of-chains", len(CHAINS) * POINTS * 3, 20.0, points_of_chains)

def movement(features):
    """How far each chain goes from frame to frame (..., 5)."""
    points = features.reshape(*features.shape[:-1], len(CHAINS), POINTS, 3)
    return np.linalg.norm(np.diff(points, axis=-4), axis=-1).mean(axis=-1)

def tokenize(sentences):
    return [[i for i, name in enumerate(CHAINS) if name in sentence] or [0] for sentence in sentences]

class Chains(EncoderAdapter):
    def __init__(self):
        super().__init__(
            name="chains", fingerprint="chains-1", features=chains, latent_size=len(CHAINS), max_frames=200,
            motions=lambda features, lengths: np.stack([movement(x[:n]).sum(axis=0) + 1e-6
                                                        for x, n in zip(features, lengths)]),
            tokenizer=tokenize,
            texts=lambda ids, mask: np.stack([np.eye(len(CHAINS), dtype=np.float32)[i[m > 0]].sum(axis=0)
                                              for i, m in zip(ids, mask)]))

class Patches(Chains):
    def __init__(self):
        super().__init__()
        self.name, self.fingerprint = "patches", "patches-1"
    def motion_tokens(self, features):
        found = []
        for rows in features:
            starts = range(0, max(len(rows) - FRAMES, 0) + 1, FRAMES)
            moved = np.stack([movement(rows[s : s + FRAMES]).sum(axis=0) + 1e-6 for s in starts])
            found.append(moved / np.linalg.norm(moved, axis=1, keepdims=True))
        return found
    def text_tokens(self, sentences):
        return [np.eye(len(CHAINS), dtype=np.float32)[ids] for ids in tokenize(sentences)]

class Crooked(Patches):
    def __init__(self):
        super().__init__()
        self.name, self.fingerprint = "crooked", "crooked-1"
    def text_tokens(self, sentences):
        return [2 * rows for rows in super().text_tokens(sentences)]
'''


@pytest.fixture(autouse=True)
def distribution(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    models = {"chains": "Chains", "patches": "Patches", "crooked": "Crooked"}
    entries = {"motionseek.models": models, "motionseek.features": {"points-of-chains": "chains"}}
    install(monkeypatch, tmp_path / "site", "motion_chains", CODE, entries)


def moving(*parts: dict[str, float]) -> np.ndarray:
    """Joints (T, 22, 3) of a body that stands and swings joints, each so far; part after part of the same length."""
    rest = np.zeros((22, 3))
    for joint, parent in enumerate(PARENTS):
        rest[joint] = 0 if parent < 0 else rest[parent] + RAW_OFFSETS[joint] * BONE_LENGTHS[joint]
    tracks = []
    for part in parts:
        track = np.tile(rest + np.array([0, 1, 0]), (64 // len(parts), 1, 1))
        for name, far in part.items():
            track[:, INDEX[name], 2] += far * np.sin(np.arange(len(track)) * 0.7)
        tracks.append(track)
    return np.concatenate(tracks)


ARM, LEG = {"right_wrist": 0.154}, {"left_ankle": 0.05, "left_foot": 0.05}
#: "both" fits "right arm and left leg" best as a whole: its arm moves as much as its leg, in "in turn" more.
CLIPS = {
    "in turn": moving({"right_wrist": 0.17}, LEG),
    "both": moving(ARM | LEG),
    "right arm": moving(ARM),
    "left leg": moving(LEG),
}


def made(folder: Path, model: str) -> Path:
    with motionseek.open(folder, create=True, bundle=motionseek.load_model(model)) as library:
        library.add_many(motionseek.NewClip(name, joints) for name, joints in CLIPS.items())
    return folder


def test_a_kind_of_features_of_another_distribution_is_indexed_and_searched(tmp_path: Path) -> None:
    with motionseek.open(made(tmp_path / "library", "chains")) as library:  # it finds its model by itself
        assert library.bundle.feature_kind == "points-of-chains"
        assert {hit.path for hit in library.search("moves the right arm", k=2)} == {"right arm", "in turn"}
        assert {hit.path for hit in library.search("moves the left leg", k=2)} == {"left leg", "in turn"}
        assert [hit.path for hit in library.search("right arm and left leg", k=2)] == ["both", "in turn"]


def test_commands_take_the_model_by_its_name(run: Run, tmp_path: Path) -> None:
    moves = tmp_path / "moves"
    moves.mkdir()
    for name, joints in CLIPS.items():
        np.save(moves / f"{name}.npy", joints)
    assert run("index", moves, "--model", "chains", "--jobs", 1).code == 0
    hits = run("search", "left leg", "--library", moves, "--json").document["hits"]
    assert {hit["path"] for hit in hits[:2]} == {"left leg.npy", "in turn.npy"}
    listed = {row["name"]: row["place"] for row in run("model", "list", "--json").document["models"]}
    assert listed["chains"] == "motion_chains 1.0"
    assert run("model", "info", "--model", "chains", "--json").document["feature_kind"] == "points-of-chains"


def test_token_vectors_rank_the_first_hits_again(tmp_path: Path) -> None:
    with motionseek.open(made(tmp_path / "library", "patches")) as library:
        hits = library.search("right arm and left leg")
        assert [hit.path for hit in hits][:2] == ["in turn", "both"]
        assert hits[0].score == pytest.approx(1, abs=0.02)  # a patch for each of the two
        assert hits[1].score == pytest.approx(np.sqrt(0.5), abs=0.02)
        assert [hit.score for hit in hits] == sorted((hit.score for hit in hits), reverse=True)
        assert [hit.path for hit in library.search("right arm and left leg", k=1)] == ["in turn"]
        assert library.search(library.bundle.encode_texts(["right arm and left leg"]))[0].path == "both"  # no words


def test_token_vectors_that_are_none_are_named(tmp_path: Path) -> None:
    with (
        motionseek.open(made(tmp_path / "library", "crooked")) as library,
        pytest.raises(BundleError, match="crooked: token vectors must be finite and of length 1"),
    ):
        library.search("right arm")


def test_max_sim_worked_out_by_hand() -> None:
    parts = np.array([[1, 0], [0.6, 0.8]])
    assert max_sim(np.array([[1.0, 0], [0, 1.0]]), parts) == pytest.approx((1 + 0.8) / 2)
    assert max_sim(np.array([[-1.0, 0]]), parts) == pytest.approx(-0.6)
