"""Weights of an ONNX graph as int8: a quarter of the bytes, one scale per output channel, activations untouched."""

from __future__ import annotations

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import helper, numpy_helper

#: Smaller tensors stay in floating point: they weigh nothing and their error would.
SMALLEST = 2048


def to_int8(model: onnx.ModelProto) -> onnx.ModelProto:
    """A copy in which large weights of MatMul and Gather are int8.

    A MatMul's (K, N) becomes int8 with N scales and a DequantizeLinear, which the runtime folds into the weights
    when it loads the graph. A Gather's table (V, D) gets a scale a row; only gathered rows are turned back.
    """
    quantised = onnx.ModelProto()
    quantised.CopyFrom(model)
    graph = quantised.graph
    weights = {tensor.name: tensor for tensor in graph.initializer if _is_large_matrix(tensor)}
    nodes: list[onnx.NodeProto] = []
    done: set[str] = set()
    for node in graph.node:
        if node.op_type == "MatMul" and node.input[1] in weights:
            name = node.input[1]
            if name not in done:
                nodes.append(_dequantise(graph, weights[name]))
            node.input[1] = f"{name}_float"
            nodes.append(node)
        elif node.op_type == "Gather" and node.input[0] in weights and _axis(node) == 0:
            name = node.input[0]
            if name not in done:
                _store(graph, weights[name], axis=0, keepdims=True)
            nodes += _gather(node)
        else:
            nodes.append(node)
            continue
        done.add(name)
    kept = [tensor for tensor in graph.initializer if tensor.name not in done]
    del graph.node[:], graph.initializer[:]
    graph.node.extend(nodes)
    graph.initializer.extend(kept)
    onnx.checker.check_model(quantised)
    return quantised


def quantise(weights: NDArray[np.float32], axis: int) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """Symmetric int8 of a matrix with one scale per index along `axis`: (values, scales (weights.shape[axis],))."""
    largest = np.abs(weights).max(axis=1 - axis, keepdims=True)
    scales = np.where(largest > 0, largest / 127, 1).astype(np.float32)
    return np.rint(weights / scales).astype(np.int8), scales.reshape(-1)


def _is_large_matrix(tensor: onnx.TensorProto) -> bool:
    return tensor.data_type == onnx.TensorProto.FLOAT and len(tensor.dims) == 2 and np.prod(tensor.dims) >= SMALLEST


def _axis(node: onnx.NodeProto) -> int:
    return next((attribute.i for attribute in node.attribute if attribute.name == "axis"), 0)


def _store(graph: onnx.GraphProto, tensor: onnx.TensorProto, axis: int, keepdims: bool = False) -> None:
    values, scales = quantise(numpy_helper.to_array(tensor), axis)
    graph.initializer.append(numpy_helper.from_array(values, f"{tensor.name}_int8"))
    graph.initializer.append(numpy_helper.from_array(scales[:, None] if keepdims else scales, f"{tensor.name}_scale"))


def _dequantise(graph: onnx.GraphProto, tensor: onnx.TensorProto) -> onnx.NodeProto:
    _store(graph, tensor, axis=1)
    name = tensor.name
    return helper.make_node("DequantizeLinear", [f"{name}_int8", f"{name}_scale"], [f"{name}_float"], axis=1)


def _gather(node: onnx.NodeProto) -> list[onnx.NodeProto]:
    table, indices, output = node.input[0], node.input[1], node.output[0]
    return [
        helper.make_node("Gather", [f"{table}_int8", indices], [f"{output}_rows"]),
        helper.make_node("Cast", [f"{output}_rows"], [f"{output}_cast"], to=onnx.TensorProto.FLOAT),
        helper.make_node("Gather", [f"{table}_scale", indices], [f"{output}_scales"]),
        helper.make_node("Mul", [f"{output}_cast", f"{output}_scales"], [output]),
    ]
