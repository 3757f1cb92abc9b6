"""TMR's encoders and the language model as ONNX graphs, written node by node from the weights.

Not traced: a trace bakes in the shapes it saw, and orders nodes so that the runtime cannot fuse them. Here batch and
length are dynamic, tokens lie in one long matrix so that biases are part of the matrix products, and weights are
quantised on request.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto
from torch import Tensor, nn

from encoders.tmr.conversion.graph_builder import GraphBuilder
from encoders.tmr.model.network import SentenceHead, TransformerEncoder, TransformerLayer
from encoders.tmr.text.language_model import LanguageLayer, LanguageNetwork

_MASKED = -1e9


@dataclass(frozen=True)
class LayerWeights:
    """The weights of a post-norm transformer layer, wherever they come from; queries are scaled by 1 / sqrt(d)."""

    heads: int
    query: tuple[Tensor, Tensor]
    key: tuple[Tensor, Tensor]
    value: tuple[Tensor, Tensor]
    out: nn.Linear
    norm1: nn.LayerNorm
    widen: nn.Linear
    narrow: nn.Linear
    norm2: nn.LayerNorm

    @classmethod
    def of(cls, layer: nn.Module) -> LayerWeights:
        if isinstance(layer, TransformerLayer):
            attention, heads = layer.self_attn, layer.self_attn.heads
            weights, biases = attention.in_proj_weight.chunk(3), attention.in_proj_bias.chunk(3)
            query, key, value = zip(weights, biases, strict=True)
            rest = (attention.out_proj, layer.norm1, layer.linear1, layer.linear2, layer.norm2)
        elif isinstance(layer, LanguageLayer):
            heads = layer.heads
            query, key, value = ((linear.weight, linear.bias) for linear in (layer.q_lin, layer.k_lin, layer.v_lin))
            rest = (layer.out_lin, layer.sa_layer_norm, layer.lin1, layer.lin2, layer.output_layer_norm)
        else:
            raise TypeError(f"{type(layer).__name__} is no layer that can be exported")
        scale = (len(query[1]) // heads) ** -0.5
        return cls(heads, (query[0] * scale, query[1] * scale), key, value, *rest)


def motion_graph(
    encoder: TransformerEncoder, mean: NDArray[np.floating], std: NDArray[np.floating], *, int8: bool = False
) -> onnx.ModelProto:
    """features (batch, frames, F), lengths (batch,) -> latent (batch, D); the normaliser is inside.

    mean, std : (F,) of the features.
    """
    graph = GraphBuilder(int8=int8)
    inverse = (1 / (np.asarray(std, np.float64) + 1e-12)).astype(np.float32)
    x = graph.add("Sub", "features", graph.constant(mean, np.float32))
    x = graph.add("Mul", x, graph.constant(inverse, np.float32))
    x, lengths = _grouped(graph, x, encoder.config.frames_per_token, len(inverse))
    (latent,) = _encode(graph, encoder, x, lengths)
    inputs: dict[str, tuple[int, Sequence[Any]]] = {
        "features": (TensorProto.FLOAT, ["batch", "frames", len(inverse)]),
        "lengths": (TensorProto.INT64, ["batch"]),
    }
    return graph.model("motion_encoder", inputs, {"latent": (latent, ["batch", encoder.latent])})


def text_graph(
    encoder: TransformerEncoder,
    language: LanguageNetwork,
    max_tokens: int,
    *,
    int8: bool = False,
    variances: bool = False,
) -> onnx.ModelProto:
    """input_ids (batch, tokens), attention_mask (batch, tokens), right-padded -> latent (batch, D).

    max_tokens : the most tokens a sentence may have; the table of positions ends there.
    variances : a second output, logvar (batch, D), of which a generator samples; without a sentence head.
    """
    graph = GraphBuilder(int8=int8)
    lengths = graph.add("ReduceSum", "attention_mask", graph.constant([1]), keepdims=0)
    batch, tokens = graph.size("input_ids", 0), graph.size("input_ids", 1)
    places = graph.add(
        "Slice",
        graph.constant(language.position_embeddings.weight[:max_tokens].detach().numpy(), np.float32),
        graph.constant([0]),
        tokens,
        graph.constant([0]),
    )
    x = graph.norm(graph.add("Add", graph.rows(language.word_embeddings.weight, "input_ids"), places), language.norm)
    x = graph.add("Reshape", x, graph.constant([-1, language.config.width]))
    bias = key_bias(graph, lengths, tokens)
    for layer in language.layers:
        x = _layer(graph, LayerWeights.of(layer), x, batch, bias)
    x = graph.add("Reshape", x, graph.shape(batch, tokens, language.config.width))
    head = None if encoder.sentence_head is None else _sentence_head(graph, encoder.sentence_head, x, lengths, tokens)
    latent, *logvar = _encode(graph, encoder, x, lengths, 2 if variances else 1)
    if head is not None:
        latent = graph.add("Add", unit_rows(graph, latent), unit_rows(graph, head))
    inputs = {name: (TensorProto.INT64, ["batch", "tokens"]) for name in ("input_ids", "attention_mask")}
    named = zip(("latent", "logvar"), (latent, *logvar), strict=False)
    return graph.model("text_encoder", inputs, {name: (value, ["batch", encoder.latent]) for name, value in named})


def _sentence_head(graph: GraphBuilder, head: SentenceHead, x: str, lengths: str, tokens: str) -> str:
    """`encoders.tmr.model.network.SentenceHead` of x (batch, tokens, F), of which `lengths` (batch,) count."""
    valid = graph.add("Unsqueeze", _valid(graph, lengths, tokens), graph.constant([2]))
    x = graph.add(
        "ReduceSum", graph.add("Where", valid, x, graph.constant(0, np.float32)), graph.constant([1]), keepdims=0
    )
    x = graph.add("Mul", unit_rows(graph, x), graph.constant(head.widen.in_features**0.5, np.float32))
    for layer in (head.widen, head.mix):
        x = graph.add("Gelu", graph.linear(x, layer.weight, layer.bias))
    return graph.linear(x, head.narrow.weight, head.narrow.bias)


def unit_rows(graph: GraphBuilder, x: str) -> str:
    """Rows of x (N, D) normalised."""
    return str(graph.add("Div", x, graph.add("ReduceL2", x, graph.constant([1]), keepdims=1)))


def _grouped(graph: GraphBuilder, x: str, size: int, features: int) -> tuple[str, str]:
    """Frames (batch, T, F) stacked `size` to a token, zeros past the end; tokens and their number a row."""
    if size == 1:
        return x, "lengths"
    frames = graph.size("features", 1)
    valid = graph.add("Unsqueeze", _valid(graph, "lengths", frames), graph.constant([2]))
    x = graph.add("Where", valid, x, graph.constant(0, np.float32))
    missing = graph.add("Mod", graph.add("Neg", frames), graph.constant([size]))
    x = graph.add("Pad", x, graph.shape(0, 0, 0, 0, missing, 0))
    x = graph.add("Reshape", x, graph.constant([0, -1, size * features]))
    rounded = graph.add("Add", "lengths", graph.constant(size - 1))
    return x, graph.add("Div", rounded, graph.constant(size))


def _valid(graph: GraphBuilder, lengths: str, size: str) -> str:
    """Boolean (batch, size): the first `lengths` places of each row."""
    places = graph.add("Range", graph.constant(0), graph.add("Squeeze", size), graph.constant(1))
    return graph.add("Less", places, graph.add("Unsqueeze", lengths, graph.constant([1])))


def key_bias(graph: GraphBuilder, lengths: str, size: str) -> str:
    """What attention adds to a key's score, (batch, 1, 1, size): nothing, or so little that it never counts."""
    zero, masked = graph.constant(0, np.float32), graph.constant(_MASKED, np.float32)
    bias = graph.add("Where", _valid(graph, lengths, size), zero, masked)
    return graph.add("Unsqueeze", bias, graph.constant([1, 2]))


def _encode(graph: GraphBuilder, encoder: TransformerEncoder, x: str, lengths: str, outputs: int = 1) -> list[str]:
    """An ACTOR-style encoder's mu, with two `outputs` logvar, too, of tokens (batch, L, F) of which `lengths` count."""
    width = encoder.config.width
    batch, given = graph.size(x, 0), graph.size(x, 1)
    x = graph.add("Reshape", x, graph.constant([-1, encoder.projection.in_features]))
    x = graph.linear(x, encoder.projection.weight, encoder.projection.bias)
    x = graph.add("Reshape", x, graph.shape(batch, given, width))
    learned = graph.constant(encoder.tokens.detach().numpy()[None], np.float32)
    x = graph.add("Concat", graph.add("Expand", learned, graph.shape(batch, 1, 1)), x, axis=1)
    tokens = graph.add("Add", given, graph.constant([2]))
    x = graph.add("Add", x, position_rows(graph, tokens, width))
    x = graph.add("Reshape", x, graph.constant([-1, width]))
    bias = key_bias(graph, graph.add("Add", lengths, graph.constant(2)), tokens)
    *layers, last = (LayerWeights.of(layer) for layer in encoder.seqTransEncoder.layers)
    for layer in layers:
        x = _layer(graph, layer, x, batch, bias)
    x = _last_layer(graph, last, x, batch, bias, outputs)
    if isinstance(encoder.to_latent, nn.Linear):
        x = graph.linear(x, encoder.to_latent.weight, encoder.to_latent.bias)
    if outputs == 1:
        return [x]
    x = graph.add("Reshape", x, graph.shape(batch, outputs, encoder.latent))
    return [graph.add("Gather", x, graph.constant(place), axis=1) for place in range(outputs)]


def position_rows(graph: GraphBuilder, count: str, width: int) -> str:
    """Sinusoidal positions (count, width), as `encoders.tmr.model.network.positions`."""
    rates = np.exp(np.arange(0, width, 2, dtype=np.float32) * np.float32(-math.log(10000.0) / width))
    places = graph.add("Range", graph.constant(0), graph.add("Squeeze", count), graph.constant(1))
    column = graph.add("Unsqueeze", graph.add("Cast", places, to=TensorProto.FLOAT), graph.constant([1]))
    angles = graph.add("Unsqueeze", graph.add("Mul", column, graph.constant(rates, np.float32)), graph.constant([2]))
    waves = graph.add("Concat", graph.add("Sin", angles), graph.add("Cos", angles), axis=2)
    return graph.add("Reshape", waves, graph.constant([-1, width]))


def _layer(graph: GraphBuilder, layer: LayerWeights, x: str, batch: str, bias: str) -> str:
    """A post-norm transformer layer over tokens (batch * tokens, width)."""
    return _finish(graph, layer, x, attend(graph, layer, x, x, batch, bias))


def _last_layer(graph: GraphBuilder, layer: LayerWeights, x: str, batch: str, bias: str, count: int) -> str:
    """The same, but only for the first tokens of each sequence: (batch * tokens, width) -> (batch * count, width)."""
    width = layer.out.in_features
    rows = graph.add("Reshape", x, graph.shape(batch, -1, width))
    if count == 1:
        first = graph.add("Gather", rows, graph.constant(0), axis=1)
    else:
        first = graph.add("Slice", rows, graph.constant([0]), graph.constant([count]), graph.constant([1]))
        first = graph.add("Reshape", first, graph.constant([-1, width]))
    return _finish(graph, layer, first, attend(graph, layer, first, x, batch, bias))


def attend(graph: GraphBuilder, layer: LayerWeights, x: str, memory: str, batch: str, bias: str) -> str:
    """MultiHeadAttention of x (batch * any, width) to memory (batch * tokens, width): like x, before its projection."""
    split = graph.shape(batch, -1, layer.heads, layer.out.in_features // layer.heads)
    query, key, value = (
        graph.add("Transpose", graph.add("Reshape", graph.linear(source, *weights), split), perm=perm)
        for source, weights, perm in (
            (x, layer.query, [0, 2, 1, 3]),
            (memory, layer.key, [0, 2, 3, 1]),
            (memory, layer.value, [0, 2, 1, 3]),
        )
    )
    weights = graph.add("Softmax", graph.add("Add", graph.add("MatMul", query, key), bias), axis=-1)
    mixed = graph.add("Transpose", graph.add("MatMul", weights, value), perm=[0, 2, 1, 3])
    return str(graph.add("Reshape", mixed, graph.constant([-1, layer.out.in_features])))


def _finish(graph: GraphBuilder, layer: LayerWeights, x: str, mixed: str) -> str:
    """What follows attention: projection, residual, norm, feed-forward, residual, norm."""
    x = graph.norm(graph.add("Add", x, graph.linear(mixed, layer.out.weight, layer.out.bias)), layer.norm1)
    wide = graph.add("Gelu", graph.linear(x, layer.widen.weight, layer.widen.bias))
    return graph.norm(graph.add("Add", x, graph.linear(wide, layer.narrow.weight, layer.narrow.bias)), layer.norm2)
