"""Bundles that somebody has crafted, sizes and digests made anew: refused by name, and never run."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from encoders.bundle import sessions
from encoders.bundle.bundle import Bundle
from encoders.bundle.graph_check import MAX_NODES, OPERATORS, check_graph
from encoders.bundle.manifest import digest
from encoders.errors import BundleError
from encoders.features.registry import FEATURE_KINDS
from tests.conftest import ROOT
from tests.encoders.bundle.conftest import change

SIZE = FEATURE_KINDS["body"].size


def field(number: int, value: int | bytes | str) -> bytes:
    """One field of a protobuf message."""
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    value = value.encode() if isinstance(value, str) else value
    return varint(number << 3 | 2) + varint(len(value)) + value


def varint(value: int) -> bytes:
    low, rest = value & 0x7F, value >> 7
    return bytes([low | 0x80]) + varint(rest) if rest else bytes([low])


def tensor(name: str, *dims: int, kind: int = 7, data: bytes = b"", more: bytes = b"") -> bytes:
    shape = b"".join(field(1, size) for size in dims)
    return shape + field(2, kind) + field(8, name) + field(9, data) + more


def node(operator: str, inputs: str = "x", output: str = "y", more: bytes = b"") -> bytes:
    names = b"".join(field(1, name) for name in inputs.split())
    return names + field(2, output) + field(4, operator) + more


def model(*nodes: bytes, tensors: tuple[bytes, ...] = (), more: bytes = b"", around: bytes = b"") -> bytes:
    parts = [field(1, one) for one in nodes] + [field(5, one) for one in tensors]
    return field(1, 10) + field(8, field(1, "") + field(2, 20)) + field(7, b"".join(parts) + more) + around


NUMBERS = tensor("c", 4, data=bytes(32))
LARGE = tensor("w", 1 << 24, data=bytes(1 << 23))
SQUARING = [node("Mul", f"s{i} s{i}", f"s{i + 1}") for i in range(64)]
DOUBLING = [node("Concat", f"c{i} c{i}", f"c{i + 1}") for i in range(40)]


@pytest.mark.parametrize(
    ("graph", "reason"),
    [
        (b"", "0 graphs"),
        (b"no graph at all", "no ONNX file"),
        (b"\x3a\xff\xff\xff\xff\x7f", "cut off"),
        (b"\xff" * 40, "no ONNX file"),
        (b"\x0b" * 40, "no ONNX file"),
        (field(7, 3), "no ONNX file"),
        (model() + model(), "2 graphs"),
        (model(node("Loop")), "operator 'Loop', which no encoder needs"),
        (model(node("SequenceMap")), "'SequenceMap'"),
        (model(node("Gemm", more=field(7, "my.code"))), "domain 'my.code'"),
        (model(node("Gemm", more=field(5, field(1, "body") + field(6, b"")))), "graph within a node"),
        (model(node("Gemm", more=field(5, field(1, "w") + field(22, b"")))), "sparse"),
        (model(around=field(25, b"")), "functions"),
        (model(around=field(20, b"")), "training"),
        (model(more=field(15, b"")), "sparse"),
        (model(tensors=(tensor("w", 4, more=field(13, field(1, "location") + field(2, "/x"))),)), "another file"),
        (model(tensors=(tensor("w", 4, more=field(14, 1)),)), "another file"),
        (model(tensors=(tensor("w", 10**6, 10**6, data=bytes(80)),)), r"weights 'w' of \[1000000, 1000000\] are more"),
        (model(tensors=(field(1, varint(2**40)) + field(8, "w"),)), "weights 'w'"),
        (model(node("Constant", "", more=field(5, field(5, tensor("", 2**40))))), "are more than are there"),
        (model(node("ConstantOfShape", "c"), tensors=(NUMBERS,)), "ConstantOfShape of constants alone"),
        (model(node("Expand", "c c"), tensors=(NUMBERS,)), "Expand of constants alone"),
        (model(node("Identity", "c", "c0"), *DOUBLING, tensors=(NUMBERS,)), "Concat of constants"),
        (model(*[node("MatMul", "d d")] * 99, tensors=(tensor("d", 5000, data=bytes(40_000)),)), "computed"),
        (model(*[node("Add")] * (MAX_NODES + 1)), "nodes"),
        (model(node("Shape", "x", "s"), node("Add", "s c", "t"), node("MatMul", "t t"), tensors=(NUMBERS,)), "MatMul"),
        (model(node("Identity", "w", "v"), node("Shape", "x", "s0"), *SQUARING, tensors=(LARGE,)), "of shapes alone"),
    ],
)  # fmt: skip
def test_a_graph_that_is_no_encoder_is_refused(copy: Path, graph: bytes, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        check_graph(graph)
    bundle = crafted(copy, "motion.onnx", graph)
    with pytest.raises(BundleError, match=rf"motion\.onnx: refused \(.*{reason}"):
        bundle.encode_features([np.zeros((9, SIZE), np.float32)])


def test_what_a_model_writes_is_checked_whole(tiny_bundle: Path) -> None:
    graph = (tiny_bundle / "motion.onnx").read_bytes()
    check_graph(graph)
    for cut in range(0, len(graph), 997):
        with pytest.raises(ValueError, match=r"graph|ONNX|weights"):
            check_graph(graph[:cut])
    assert "If" not in OPERATORS


def test_a_graph_that_grows_at_work_runs_into_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sessions, "_allocators", [])
    asked: list[int] = []

    class Runtime:
        class OrtAllocatorType:
            ORT_ARENA_ALLOCATOR = 1

        class OrtMemType:
            DEFAULT = 0

        OrtMemoryInfo = staticmethod(lambda *_: "place")
        OrtArenaCfg = staticmethod(lambda most, *_: asked.append(most))
        create_and_register_allocator = staticmethod(lambda *_: None)

    assert sessions._has_bounded_allocator(Runtime)
    assert sessions._has_bounded_allocator(Runtime)
    assert asked == [sessions.MEMORY]


def growing() -> bytes:
    """A graph of a few bytes that makes 400 MB of the shape of its input, which is known as it is loaded."""

    def value(name: str, *dims: int) -> bytes:
        shape = b"".join(field(1, field(1, size)) for size in dims)
        return field(1, name) + field(2, field(1, field(1, 1) + field(2, shape)))

    last = field(5, field(1, "start") + field(3, 2) + field(20, 2))
    nodes = [
        node("Shape", "x", "s", last), node("Mul", "s c", "t"), node("ConstantOfShape", "t", "u"),
        node("ReduceMax", "u", "v", field(5, field(1, "keepdims") + field(3, 0) + field(20, 2))), node("Add", "x v"),
    ]  # fmt: skip
    around = field(2, "g") + field(11, value("x", 1, 1, 96)) + field(12, value("y", 1, 1, 96))
    return model(*nodes, tensors=(tensor("c", 1, data=(1 << 20).to_bytes(8, "little")),), more=around)


@pytest.mark.skipif(sys.platform != "linux", reason="the peak of memory is not known")
def test_a_graph_that_grows_as_it_is_loaded_does_so_at_work_alone(tmp_path: Path) -> None:
    (tmp_path / "x.onnx").write_bytes(growing())
    script = (
        "import re, sys, onnxruntime, numpy; from pathlib import Path; from encoders.bundle import sessions\n"
        "peak = lambda: int(re.search(r'VmHWM:\\s*(\\d+)', Path('/proc/self/status').read_text())[1]) >> 10\n"
        "before, path = peak(), Path(sys.argv[1]); session = sessions.open_session(path, 1); loaded = peak()\n"
        "sessions.run(session, path, {'x': numpy.zeros((1, 1, 96), 'f')}); print(loaded - before, peak() - before)"
    )
    command = [sys.executable, "-c", script, str(tmp_path / "x.onnx")]
    ran = subprocess.run(command, capture_output=True, env={**os.environ, "PYTHONPATH": str(ROOT)}, check=True)
    loaded, worked = map(int, ran.stdout.split())
    assert loaded < 100 < 200 < worked


def test_a_token_that_the_model_does_not_know_is_an_error(copy: Path) -> None:
    tokenizer = json.loads((copy / "tokenizer.json").read_text())
    vocabulary = tokenizer["model"]["vocab"]
    vocabulary["person"] = 10**9
    bundle = crafted(copy, "tokenizer.json", json.dumps(tokenizer).encode())
    with pytest.raises(BundleError, match=r"text\.onnx: fails at work"):
        bundle.encode_texts(["a person"])


@pytest.mark.parametrize(
    ("part", "step", "reason"),
    [
        ("normalizer", {"type": "Replace", "pattern": {"String": "a"}, "content": "a" * 10**6}, "normalizer 'Replace'"),
        ("normalizer", {"type": "Sequence", "normalizers": [{"type": "Prepend", "prepend": "a"}]}, "'Prepend'"),
        ("pre_tokenizer", {"type": "Split", "pattern": {"Regex": "(a|a)*b"}, "behavior": "Removed"}, "'Split'"),
        ("pre_tokenizer", "Split", "'Split'"),
        ("post_processor", {"type": "Sequence", "processors": [{"type": "Other"}]}, "'Other'"),
        ("model", {"type": "Code"}, "'Code'"),
        ("model", {"type": "WordPiece", "vocab": 3}, "cannot be read"),
    ],
)
def test_a_tokenizer_that_does_more_than_cut_sentences_is_refused(
    copy: Path, part: str, step: object, reason: str
) -> None:
    tokenizer = json.loads((copy / "tokenizer.json").read_text()) | {part: step}
    bundle = crafted(copy, "tokenizer.json", json.dumps(tokenizer).encode())
    with pytest.raises(BundleError, match=rf"tokenizer\.json: .*{reason}"):
        bundle.encode_texts(["a person"])


def test_a_sentence_is_cut_off_whatever_the_tokenizer_states(copy: Path) -> None:
    tokenizer = json.loads((copy / "tokenizer.json").read_text()) | {"truncation": None}
    bundle = crafted(copy, "tokenizer.json", json.dumps(tokenizer).encode())
    assert len(bundle._tokenizer.encode("a person walks " * 900).ids) == 512


@pytest.mark.parametrize("text", ["[" * 200_000, '{"model": null}', "null", '"' + "\\ud800" * 9])
def test_what_is_no_tokenizer_is_refused(copy: Path, text: str) -> None:
    with pytest.raises(BundleError, match=r"tokenizer\.json: cannot be read"):
        crafted(copy, "tokenizer.json", text.encode()).encode_texts(["a person"])


def header(shape: str, kind: str = "<f4") -> bytes:
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}}}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


@pytest.mark.parametrize(
    ("member", "reason"),
    [
        (header("(10**3, 4)"), "cannot be read"),
        (header("(1000000000000,)"), "more than are there"),
        (header("(1,)", "|O") + b"cos\nsystem\n(S'true'\ntR.", "neither numbers nor text"),
        (header("(1,)", "<U9"), "more than are there"),
        (b"nothing", "cannot be read"),
        (bytes(300 << 20), "256 MB"),
    ],
    ids=["code", "absurd", "pickle", "text", "nothing", "bomb"],
)
def test_a_crafted_calibration_is_refused(copy: Path, member: bytes, reason: str) -> None:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("a.npy", member)
    bundle = crafted(copy, "calibration.npz", file.getvalue())
    with pytest.raises(BundleError, match=rf"calibration\.npz: .*{reason}"):
        _ = bundle.calibration


def test_the_shipped_model_passes() -> None:
    bundle = Bundle.load(threads=1)
    assert bundle.calibration
    assert bundle.encode_texts(["a person walks"]).shape == (1, bundle.latent_size)
    assert bundle.encode_features([np.zeros((9, SIZE), np.float32)]).shape == (1, bundle.latent_size)


@pytest.mark.parametrize(
    "values",
    [
        {"latent_size": 10**9},
        {"latent_size": 10**400},
        {"max_frames": 10**9},
        {"files": {f"{i}": "" for i in range(99)}},
    ],
)
def test_a_manifest_of_absurd_numbers_is_refused(copy: Path, values: dict[str, object]) -> None:
    change(copy, **values)
    with pytest.raises(BundleError, match=r"manifest\.json: .*more than"):
        Bundle.load(copy)


def test_a_manifest_that_states_another_size_than_its_graph_is_refused(copy: Path) -> None:
    change(copy, latent_size=25)
    with pytest.raises(BundleError, match=r"motion\.onnx: does not fit its manifest"):
        Bundle.load(copy).encode_features([np.zeros((9, SIZE), np.float32)])


def crafted(folder: Path, name: str, content: bytes) -> Bundle:
    """The bundle with another file, its digest made anew."""
    (folder / name).write_bytes(content)
    files = json.loads((folder / "manifest.json").read_text())["files"]
    change(folder, files=files | {name: digest(folder / name)})
    return Bundle.load(folder)
