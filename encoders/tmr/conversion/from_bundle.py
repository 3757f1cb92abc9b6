"""A bundle becomes a trainable TMR again, to fine-tune: its graphs' weights, read in the order they were written in.

Weights that were stored as int8 come back as the nearest of 255 steps, which moves vectors by less than 1e-4.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import onnx
import torch
from numpy.typing import NDArray
from onnx import numpy_helper
from torch import nn

from encoders.bundle.manifest import MOTION, TEXT, read_manifest
from encoders.errors import BundleError
from encoders.tmr.model.network import TMR, EncoderLayer, MultiHeadAttention, TMRConfig, TransformerEncoder
from encoders.tmr.model.normaliser import Normaliser

Array = NDArray[np.float32]


def restore(folder: Path, config: TMRConfig) -> tuple[TMR, Normaliser]:
    """The encoders of the bundle in `folder`, with its normaliser.

    Weights it does not hold are initialised at random: a decoder always, a sentence head where the bundle has none.

    Raises
    ------
    BundleError
        If the bundle is missing or damaged, or a graph was not written by
        `encoders.tmr.conversion.onnx_graph`, or holds networks of other sizes than `config`.
    """
    read_manifest(folder)
    model = TMR(config)
    try:
        motion, text = (_GraphWeights(onnx.load(folder / name)) for name in (MOTION, TEXT))
        _fill(model.motion_encoder, motion)
        _fill(model.text_encoder, text)
        mean, inverse = motion.first("Sub"), motion.first("Mul")
    except (OSError, LookupError, ValueError, RuntimeError) as error:
        raise BundleError(f"{folder}: no bundle with networks of these sizes to fine-tune ({error})") from error
    return model, Normaliser(mean=mean, std=(1 / inverse).astype(np.float32))


class _GraphWeights:
    """The constants of a graph, by the kind of node that uses them, in order."""

    def __init__(self, model: onnx.ModelProto) -> None:
        self._stored: Mapping[str, NDArray[np.generic]] = {
            one.name: numpy_helper.to_array(one) for one in model.graph.initializer
        }
        self._nodes = list(model.graph.node)
        self._makers = {output: node for node in self._nodes for output in node.output}

    def of(self, operator: str, inputs: int) -> list[tuple[Array, ...]]:
        """The constants among the last `inputs` inputs of each node of a kind."""
        return [
            tuple(self._value(name) for name in node.input[-inputs:])
            for node in self._nodes
            if node.op_type == operator
        ]

    def first(self, operator: str) -> Array:
        """The constant of the first node of a kind."""
        return self.of(operator, 1)[0][0]

    @property
    def learned(self) -> Array:
        """The learned tokens (2, width), which are expanded to a batch."""
        return next(self._value(n.input[0])[0] for n in self._nodes if n.op_type == "Expand")

    def _value(self, name: str) -> Array:
        if name in self._stored:
            return self._stored[name]  # type: ignore[return-value]
        node = self._makers[name]
        if node.op_type == "Reshape":
            return self._value(node.input[0]).reshape(self._value(node.input[1]))
        if node.op_type == "DequantizeLinear":
            return self._value(node.input[0]).astype(np.float32) * self._value(node.input[1])[:, None]
        raise LookupError(f"{name} is no constant")


def _fill(encoder: TransformerEncoder, weights: _GraphWeights) -> None:
    """Put a graph's weights into an encoder: the last nodes of its graph, after those of the sentence head."""
    matrices, scales = weights.of("Gemm", 2), weights.of("LayerNormalization", 2)
    linears = list(_matrices(encoder))
    head = encoder.sentence_head
    above = [] if head is None else [head.widen, head.mix, head.narrow]
    norms = [norm for layer in _layers(encoder) for norm in (layer.norm1, layer.norm2)]
    if len(linears) > len(matrices) or len(norms) > len(scales):
        raise ValueError("it has fewer layers")
    before = matrices[-len(linears) - len(above) : -len(linears)]
    if above and [weight.shape for weight, _ in before] == [tuple(linear.weight.shape) for linear in above]:
        linears = [*((linear.weight, linear.bias) for linear in above), *linears]
    with torch.no_grad():
        encoder.tokens.copy_(_tensor(weights.learned))
        stored = [*matrices[-len(linears) :], *scales[-len(norms) :]]
        for (weight, bias), values in zip([*linears, *((n.weight, n.bias) for n in norms)], stored, strict=True):
            weight.copy_(_tensor(values[0]))
            bias.copy_(_tensor(values[1]))
        for layer in _layers(encoder):
            _unscale(layer.self_attn)


def _layers(encoder: TransformerEncoder) -> list[EncoderLayer]:
    return [layer for layer in encoder.seqTransEncoder.layers if isinstance(layer, EncoderLayer)]


def _matrices(encoder: TransformerEncoder) -> Iterator[tuple[torch.Tensor, torch.Tensor]]:
    """Every matrix with its bias, but the sentence head's, in the order in which a graph computes them."""
    yield encoder.projection.weight, encoder.projection.bias
    for layer in _layers(encoder):
        attention = layer.self_attn
        yield from zip(attention.in_proj_weight.chunk(3), attention.in_proj_bias.chunk(3), strict=True)
        for linear in (attention.out_proj, layer.linear1, layer.linear2):
            yield linear.weight, linear.bias
    if isinstance(encoder.to_latent, nn.Linear):
        yield encoder.to_latent.weight, encoder.to_latent.bias


def _unscale(attention: MultiHeadAttention) -> None:
    """Queries, which a graph holds divided by the root of a head's width, as the network wants them."""
    width = attention.out_proj.in_features
    for stored in (attention.in_proj_weight, attention.in_proj_bias):
        stored[:width] *= (width // attention.heads) ** 0.5


def _tensor(values: Array) -> torch.Tensor:
    return torch.from_numpy(np.array(values, np.float32))
