"""Files of tensors that somebody else has written: nothing in them is run."""

from __future__ import annotations

import collections
import datetime
import os
import pathlib
import zipfile

import pytest

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.errors import BundleError  # noqa: E402
from encoders.tmr.model.tensor_files import module_tensors, read_tensors  # noqa: E402

STATE = {"motion_encoder.tokens": torch.ones(2, 3), "motion_encoder.layers.0.bias": torch.zeros(1)}


class Settings:
    """An object as omegaconf and Lightning keep them."""

    made: list = []  # noqa: RUF012

    def __init__(self, values):
        self.values = values
        self.by_name = collections.defaultdict(list, {"a": [1]})

    def __setstate__(self, state):
        self.made.append(state)


class Attack:
    def __init__(self, target):
        self.target = target

    def __reduce__(self):
        return pathlib.Path.touch, (self.target,)


def test_the_modules_of_a_checkpoint_are_read_and_other_objects_are_never_made(tmp_path):
    others = [Settings({"lr": 1e-4}), pathlib.Path("/run"), datetime.date(2023, 12, 11), Settings, {1: {2: (3,)}}]
    torch.save({"state_dict": STATE, "hyper_parameters": others}, tmp_path / "last.ckpt")
    modules = module_tensors(tmp_path / "last.ckpt")
    assert {name: list(tensors) for name, tensors in modules.items()} == {"motion_encoder": ["tokens", "layers.0.bias"]}
    assert torch.equal(modules["motion_encoder"]["tokens"], torch.ones(2, 3))
    assert Settings.made == []


@pytest.mark.parametrize("read", [read_tensors, module_tensors])
def test_what_would_run_does_not(tmp_path, read):
    torch.save({"state_dict": STATE | {"x.y": Attack(tmp_path / "touched")}}, tmp_path / "last.ckpt")
    with pytest.raises(BundleError, match=r"last\.ckpt"):
        read(tmp_path / "last.ckpt")
    torch.save({"state_dict": STATE, "z": os.getcwd}, tmp_path / "last.ckpt")
    with pytest.raises(BundleError, match=r"objects of posix\.getcwd"):
        read(tmp_path / "last.ckpt")
    assert not (tmp_path / "touched").exists()


def test_weights_by_module_hold_no_objects(tmp_path):
    torch.save({"tokens": torch.ones(2), "path": pathlib.PurePosixPath("/run")}, tmp_path / "text_encoder.pt")
    with pytest.raises(BundleError, match=r"holds objects of pathlib\.PurePosixPath, not only tensors"):
        read_tensors(tmp_path / "text_encoder.pt")


@pytest.mark.parametrize("content", [{"epoch": 1}, [1], {"state_dict": {}}, {"state_dict": {"a.b": 5}}])
def test_a_checkpoint_without_tensors_is_named(tmp_path, content):
    torch.save(content, tmp_path / "last.ckpt")
    with pytest.raises(BundleError, match=r"last\.ckpt: .*no (state_dict|tensor)"):
        module_tensors(tmp_path / "last.ckpt")


def test_the_format_before_zip_is_read(tmp_path):
    torch.save({"state_dict": STATE}, tmp_path / "last.ckpt", _use_new_zipfile_serialization=False)
    assert list(module_tensors(tmp_path / "last.ckpt")) == ["motion_encoder"]


def test_a_damaged_or_compressed_file_is_refused(tmp_path):
    torch.save({"state_dict": STATE}, tmp_path / "whole.ckpt")
    content = (tmp_path / "whole.ckpt").read_bytes()
    for damaged in (b"", b"no checkpoint", content[: len(content) // 2]):
        (tmp_path / "last.ckpt").write_bytes(damaged)
        with pytest.raises(BundleError, match=r"last\.ckpt"):
            module_tensors(tmp_path / "last.ckpt")
    with (
        zipfile.ZipFile(tmp_path / "whole.ckpt") as whole,
        zipfile.ZipFile(tmp_path / "bomb.ckpt", "w", zipfile.ZIP_DEFLATED) as bomb,
    ):
        for name in whole.namelist():
            bomb.writestr(name, whole.read(name))
    with pytest.raises(BundleError, match="is compressed"):
        module_tensors(tmp_path / "bomb.ckpt")
