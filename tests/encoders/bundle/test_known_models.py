"""Models by name: the shipped one, the user's, and those of other distributions."""

from __future__ import annotations

import shutil

import pytest

from encoders.bundle.bundle import Bundle
from encoders.bundle.known_models import folder_of, known_models, load_model, model_with, models_folder
from encoders.errors import ArgumentError, BundleError
from tests.distributions import install
from tests.encoders.bundle.conftest import change

CODE = """
import numpy as np

class Constant:
    name, fingerprint, feature_kind, fps, max_frames, latent_size = "constant", "constant-1", "body", 10.0, 100, 2
    calibration = None
    def features(self, motion): return motion.joints.reshape(-1, 66)
    def encode_features(self, features): return np.tile(np.float32([1, 0]), (len(features), 1))
    def encode_windows(self, features, starts, length): return self.encode_features(starts)
    def encode_motions(self, motions): return self.encode_features(motions)
    def encode_texts(self, sentences): return self.encode_features(sentences)

def broken(): raise RuntimeError("no weights here")
text = "no model"
"""


@pytest.fixture
def kept(tiny_bundle, tmp_path, monkeypatch):
    """A folder of models with the bundles `first` and `second`, of two fingerprints."""
    folder = tmp_path / "Modelle für alle"
    monkeypatch.setenv("MOTIONSEEK_MODELS", str(folder))
    for name, frames in (("first", 100), ("second", 50)):
        shutil.copytree(tiny_bundle, folder / name)
        change(folder / name, max_frames=frames)
    (folder / "notes").mkdir()
    (folder / "read me.txt").touch()
    return folder


@pytest.fixture
def distribution(tmp_path, monkeypatch):
    names = {"constant": "Constant", "broken": "broken", "text": "text", "lost": "nowhere"}
    install(monkeypatch, tmp_path / "site", "some_models", CODE, {"motionseek.models": names})


def test_bundles_stand_side_by_side_and_are_listed(kept):
    listed = known_models()
    assert [model.name for model in listed] == ["default", "first", "second"]
    assert listed[2].place == str(kept / "second")
    assert load_model("second").fingerprint == listed[2].manifest.fingerprint != load_model("first").fingerprint
    assert load_model().fingerprint == load_model("default").fingerprint == listed[0].manifest.fingerprint


def test_a_bundle_is_also_named_by_its_folder(kept, monkeypatch):
    assert load_model(kept / "first").max_frames == load_model(str(kept / "first")).max_frames == 100
    monkeypatch.chdir(kept.parent)
    shutil.copytree(kept / "second", "here")
    assert load_model("here").max_frames == 50


def test_a_model_is_found_by_its_fingerprint_whatever_it_is_called(kept):
    wanted = load_model("second").fingerprint
    (kept / "second").rename(kept / "renamed")
    found = model_with(wanted, "tiny")
    assert isinstance(found, Bundle)
    assert (found.fingerprint, found.folder.name) == (wanted, "renamed")
    assert model_with("0" * 64, "tiny") is None


def test_an_unknown_name_is_answered_with_those_that_are_there(kept):
    with pytest.raises(BundleError, match=r"no model 'secnd' in .*; did you mean 'second'\?"):
        load_model("secnd")
    with pytest.raises(BundleError, match="there are default, first, second"):
        load_model("tmr-humanml3d")
    with pytest.raises(BundleError, match="no model bundle here"):
        load_model(kept / "notes")


def test_a_damaged_bundle_is_listed_with_what_is_wrong(kept):
    change(kept / "first", format=99)
    assert [bool(model.problem) for model in known_models()] == [False, True, False]
    (kept / "second" / "text.onnx").write_bytes(b"")
    with pytest.raises(BundleError, match="damaged"):
        load_model("second")


def test_the_folder_is_the_systems_where_none_is_named(monkeypatch, tmp_path):
    monkeypatch.delenv("MOTIONSEEK_MODELS")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    assert models_folder().parts[-2:] == ("motionseek", "models")
    assert [model.name for model in known_models()] == ["default"]


@pytest.mark.parametrize("name", ["", "..", "a/b", ".hidden", "a b", "x" * 65, "default", "constant", 5])
def test_a_name_that_is_none_or_taken_is_refused(name, distribution):
    with pytest.raises(ArgumentError, match="name="):
        folder_of(name)


def test_another_distribution_adds_a_model(kept, distribution):
    listed = {model.name: model.place for model in known_models()}
    assert listed["constant"] == "some_models 1.0"
    model = load_model("constant")
    assert model.encode_texts(["a"]).shape == (1, 2)
    assert model_with("constant-1", "constant").name == "constant"
    assert model_with("constant-2", "constant") is None


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("broken", "'broken' cannot be made .*no weights here"),
        ("text", "names str, not what makes an Encoder"),
        ("lost", "'lost' of some_models 1.0 cannot be loaded"),
    ],
)
def test_a_model_of_another_distribution_that_does_not_work_is_named(distribution, name, message):
    with pytest.raises(BundleError, match=message):
        load_model(name)


def test_a_name_that_two_distributions_claim_is_refused(distribution, tmp_path, monkeypatch):
    install(monkeypatch, tmp_path / "more", "other_models", CODE, {"motionseek.models": {"constant": "Constant"}})
    with pytest.raises(BundleError, match=r"claimed by other_models 1.0 and some_models 1.0"):
        load_model("constant")
