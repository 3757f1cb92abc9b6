"""A trained TMR becomes a bundle: two ONNX graphs with small weights, a tokenizer and a manifest.

Weights of matrices and embeddings are stored as int8 with one scale per output channel (per row for embeddings) and
turned back to floating point when the graph is loaded; activations are floating point throughout.
"""

from __future__ import annotations

import json
import logging
import shutil
import tempfile
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
import onnx
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from encoders.kinds import FEATURE_KINDS
from encoders.manifest import CALIBRATION, FORMAT, MANIFEST, MOTION, TEXT, TOKENIZER, digest
from encoders.tmr.language import LanguageModel, LanguageNetwork
from encoders.tmr.network import TMR, Config, Encoder, Tower, valid_mask
from encoders.tmr.quantise import to_int8

OPSET = 18


class MotionGraph(nn.Module):
    """features (N, T, F), lengths (N,) -> latent (N, D), the normaliser included."""

    def __init__(self, encoder: Encoder, mean: NDArray[np.float32], std: NDArray[np.float32]) -> None:
        super().__init__()
        self.encoder = encoder
        self.mean: Tensor
        self.std: Tensor
        self.register_buffer("mean", torch.as_tensor(mean, dtype=torch.float32))
        self.register_buffer("std", torch.as_tensor(std, dtype=torch.float32) + 1e-12)

    def forward(self, features: Tensor, lengths: Tensor) -> Tensor:
        """See the class."""
        return self.encoder.mean((features - self.mean) / self.std, valid_mask(lengths, features.shape[1]))


class TextGraph(nn.Module):
    """input_ids (N, L), attention_mask (N, L) -> latent (N, D), the language model included."""

    def __init__(self, encoder: Encoder, language: LanguageNetwork) -> None:
        super().__init__()
        self.encoder = encoder
        self.language = language

    def forward(self, input_ids: Tensor, attention_mask: Tensor) -> Tensor:
        """See the class."""
        mask = attention_mask > 0
        return self.encoder.mean(self.language(input_ids, mask), mask)


def motion_graph(encoder: Encoder, mean: NDArray[np.float32], std: NDArray[np.float32]) -> onnx.ModelProto:
    """The fp32 graph of `MotionGraph`."""
    example = (torch.zeros(2, 12, len(mean)), torch.tensor([12, 7]))
    shapes = ({0: "batch", 1: "frames"}, {0: "batch"})
    return _trace(MotionGraph(encoder, mean, std), example, ("features", "lengths"), shapes)


def text_graph(encoder: Encoder, language: LanguageNetwork) -> onnx.ModelProto:
    """The fp32 graph of `TextGraph`."""
    example = (torch.zeros(2, 9, dtype=torch.int64), torch.ones(2, 9, dtype=torch.int64))
    shapes = ({0: "batch", 1: "tokens"}, {0: "batch", 1: "tokens"})
    return _trace(TextGraph(encoder, language), example, ("input_ids", "attention_mask"), shapes)


def _trace(
    module: nn.Module, example: tuple[Tensor, ...], inputs: tuple[str, ...], shapes: tuple[dict[int, str], ...]
) -> onnx.ModelProto:
    training = module.training
    quiet = logging.getLogger("torch.onnx")
    level = quiet.level
    quiet.setLevel(logging.ERROR)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            program = torch.onnx.export(
                module.eval(),
                example,
                input_names=list(inputs),
                output_names=["latent"],
                opset_version=OPSET,
                dynamo=True,
                dynamic_shapes=shapes,
                verbose=False,
            )
    finally:
        module.train(training)
        quiet.setLevel(level)
    if program is None:
        raise RuntimeError("torch.onnx.export gave no program")
    return _without_traces(program.model_proto)


def _without_traces(model: onnx.ModelProto) -> onnx.ModelProto:
    """Drop what the exporter notes about the source (file names, line numbers): it is no part of the model."""
    for part in (model, model.graph, *model.graph.node, *model.graph.input, *model.graph.output, *model.functions):
        part.ClearField("metadata_props")
        part.ClearField("doc_string")
    for tensor in model.graph.initializer:
        tensor.ClearField("metadata_props")
        tensor.ClearField("doc_string")
    model.graph.ClearField("value_info")
    return model


def export_bundle(
    folder: Path,
    *,
    name: str,
    motion_encoder: Encoder,
    text_encoder: Encoder,
    language: LanguageModel,
    mean: NDArray[np.float32],
    std: NDArray[np.float32],
    feature_kind: str,
    max_frames: int,
    weights: Literal["int8", "float32"] = "int8",
    licence: str = "MIT",
    training: Mapping[str, Any] | None = None,
    calibration: Mapping[str, NDArray[Any]] | None = None,
) -> Path:
    """Write a bundle; a bundle that was in `folder` before is replaced only when the new one is whole.

    Parameters
    ----------
    mean, std : (F,)
        Of the features; the motion graph takes raw features and normalises them.
    max_frames : int
        Longest motion, in feature frames, that passes the encoder as a whole.
    training : mapping of plain values
        What the manifest says about how the model came to be.
    calibration : mapping of arrays
        Written as calibration.npz; changes no embedding.
    """
    kind = FEATURE_KINDS[feature_kind]
    if np.shape(mean) != (kind.size,) or np.shape(std) != (kind.size,):
        raise ValueError(f"mean {np.shape(mean)} and std {np.shape(std)} must be ({kind.size},) for {feature_kind!r}")
    folder = Path(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=f".{folder.name}-") as temporary:
        new = Path(temporary) / "bundle"
        new.mkdir()
        graphs = {
            MOTION: motion_graph(motion_encoder, mean, std),
            TEXT: text_graph(text_encoder, truncated(language)),
        }
        for file, graph in graphs.items():
            onnx.save(to_int8(graph) if weights == "int8" else graph, new / file)
        (new / TOKENIZER).write_text(language.tokenizer.to_str(), "utf-8")
        if calibration is not None:
            np.savez_compressed(new / CALIBRATION, **calibration)  # type: ignore[arg-type]
        manifest = {
            "format": FORMAT,
            "name": name,
            "feature_kind": feature_kind,
            "fps": kind.fps,
            "max_frames": max_frames,
            "latent_size": motion_encoder.latent,
            "language_model": language.name,
            "max_tokens": language.max_tokens,
            "weights": weights,
            "licence": licence,
            "training": dict(training or {}),
            "files": {file.name: digest(file) for file in sorted(new.iterdir())},
        }
        (new / MANIFEST).write_text(json.dumps(manifest, indent=2, sort_keys=True) + "\n", "utf-8")
        if folder.exists():
            folder.rename(Path(temporary) / "old")
        shutil.move(new, folder)
    return folder


def truncated(language: LanguageModel) -> LanguageNetwork:
    """The language network with no more positions than the tokenizer lets through."""
    network = LanguageNetwork(language.network.config)
    network.load_state_dict(language.network.state_dict())
    network.places.weight = nn.Parameter(network.places.weight[: language.max_tokens].clone())
    return network.eval().requires_grad_(False)


def default_config(features: int, token_features: int) -> Config:
    """The sizes of the default model: about a quarter of published TMR's, four frames a token."""
    return Config(
        motion=Tower(features=features, layers=3, feedforward=768, frames_per_token=4),
        text=Tower(features=token_features, layers=2, feedforward=768),
        decoder=Tower(features=features, width=192, layers=1, feedforward=384, frames_per_token=4),
        latent=256,
    )


def untrained_bundle(folder: Path, seed: int = 0, feature_kind: str = "body") -> Path:
    """A bundle of the default sizes that has learned nothing: everything runs with it, nothing is found."""
    kind = FEATURE_KINDS[feature_kind]
    language = LanguageModel.load()
    torch.manual_seed(seed)
    network = TMR(default_config(kind.size, language.width))
    return export_bundle(
        folder,
        name="untrained",
        motion_encoder=network.motion_encoder,
        text_encoder=network.text_encoder,
        language=language,
        mean=np.zeros(kind.size, np.float32),
        std=np.ones(kind.size, np.float32),
        feature_kind=feature_kind,
        max_frames=round(10 * kind.fps),
        training={"note": "untrained"},
    )
