"""What a generator needs as ONNX graphs: the motion decoder, and a sentence's Gaussian from its vector."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto
from torch import nn

from encoders.tmr.conversion.graph_builder import GraphBuilder
from encoders.tmr.conversion.onnx_graph import LayerWeights, attend, key_bias, position_rows
from encoders.tmr.model.network import Decoder, DecoderLayer
from encoders.tmr.synthesis.motion_vae import NARROWEST, WIDEST, TextGaussian


def decoder_graph(
    decoder: Decoder, mean: NDArray[np.floating], std: NDArray[np.floating], *, int8: bool = False
) -> onnx.ModelProto:
    """latent (batch, D), lengths (batch,) -> features (batch, frames, F) as they are, not standardised.

    Frames beyond a motion's length hold anything. mean, std : (F,) of the features.
    """
    graph = GraphBuilder(int8=int8)
    size, width = decoder.config.frames_per_token, decoder.config.width
    batch = graph.size("lengths", 0)
    rounded = graph.add("Add", "lengths", graph.constant(size - 1))
    lengths = graph.add("Div", rounded, graph.constant(size))
    tokens = graph.add("ReduceMax", lengths, graph.constant([0]), keepdims=1)
    memory = "latent"
    if isinstance(decoder.from_latent, nn.Linear):
        memory = graph.linear(memory, decoder.from_latent.weight, decoder.from_latent.bias)
    queries = position_rows(graph, tokens, width)
    x = graph.add(
        "Reshape", graph.add("Expand", queries, graph.shape(batch, tokens, width)), graph.constant([-1, width])
    )
    bias = key_bias(graph, lengths, tokens)
    for layer in decoder.seqTransDecoder.layers:
        assert isinstance(layer, DecoderLayer)
        x = _layer(graph, layer, x, memory, batch, bias)
    x = graph.linear(x, decoder.final_layer.weight, decoder.final_layer.bias)
    x = graph.add("Reshape", x, graph.shape(batch, -1, len(mean)))
    x = graph.add("Mul", x, graph.constant(np.asarray(std) + 1e-12, np.float32))
    x = graph.add("Add", x, graph.constant(mean, np.float32))
    inputs: dict[str, tuple[int, Sequence[Any]]] = {
        "latent": (TensorProto.FLOAT, ["batch", _latent_size(decoder)]),
        "lengths": (TensorProto.INT64, ["batch"]),
    }
    return graph.model("motion_decoder", inputs, {"features": (x, ["batch", "frames", len(mean)])})


def gaussian_graph(network: TextGaussian, *, int8: bool = False) -> onnx.ModelProto:
    """vector (batch, D), of unit length -> mu (batch, Z), logvar (batch, Z)."""
    graph = GraphBuilder(int8=int8)
    x = graph.add("Mul", "vector", graph.constant(network.widen.in_features**0.5, np.float32))
    for layer in (network.widen, network.mix):
        x = graph.add("Gelu", graph.linear(x, layer.weight, layer.bias))
    x = graph.linear(x, network.narrow.weight, network.narrow.bias)
    mu, logvar = graph.add("Split", x, outputs=2, axis=1, num_outputs=2)
    logvar = graph.add("Clip", logvar, graph.constant(NARROWEST, np.float32), graph.constant(WIDEST, np.float32))
    half = network.narrow.out_features // 2
    inputs: dict[str, tuple[int, Sequence[Any]]] = {"vector": (TensorProto.FLOAT, ["batch", network.widen.in_features])}
    return graph.model("text_gaussian", inputs, {"mu": (mu, ["batch", half]), "logvar": (logvar, ["batch", half])})


def _layer(graph: GraphBuilder, layer: DecoderLayer, x: str, memory: str, batch: str, bias: str) -> str:
    """`encoders.tmr.model.network.DecoderLayer` over tokens (batch * tokens, width) and memory (batch, width)."""
    weights = LayerWeights.of(layer)
    mixed = attend(graph, weights, x, x, batch, bias)
    x = graph.norm(graph.add("Add", x, graph.linear(mixed, weights.out.weight, weights.out.bias)), weights.norm1)
    width = weights.out.in_features
    cross = layer.multihead_attn
    value = graph.linear(memory, cross.in_proj_weight[2 * width :], cross.in_proj_bias[2 * width :])
    value = graph.linear(value, cross.out_proj.weight, cross.out_proj.bias)
    rows = graph.add("Reshape", x, graph.shape(batch, -1, width))
    rows = graph.add("Add", rows, graph.add("Unsqueeze", value, graph.constant([1])))
    x = graph.norm(graph.add("Reshape", rows, graph.constant([-1, width])), layer.norm2)
    wide = graph.add("Gelu", graph.linear(x, weights.widen.weight, weights.widen.bias))
    return graph.norm(graph.add("Add", x, graph.linear(wide, weights.narrow.weight, weights.narrow.bias)), layer.norm3)


def _latent_size(decoder: Decoder) -> int:
    first = decoder.from_latent
    return first.in_features if isinstance(first, nn.Linear) else decoder.config.width
