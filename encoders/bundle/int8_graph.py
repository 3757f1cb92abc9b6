"""A motion encoder's matrix products in whole numbers of 8 bits, where the processor has units for them.

Weights lie in a bundle as int8 already. Here the activations become int8, too, each tensor with one range, so that a
vector does not depend on what else is in its batch. The ranges are found as the graph is loaded, from smooth random
features, with a margin. The product with the features themselves, which have outliers, stays in floating point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.protobuf import Message, field, fields, message, text, varints

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

#: What Linux calls the units: Intel's and AMD's in both widths.
_UNITS = {"avx512_vnni", "avx_vnni"}
#: Batches that ranges are found from: windows of so many frames each, and how many.
_LENGTHS, _COUNT = (16, 32, 64), 24
#: From a frame to the next a random feature keeps so much. Its spread is up to twice that of a data set's.
_KEPT, _SPREADS = 0.9, (0.3, 2.0)
#: Ranges are wider by this than what was seen, before the first normalisation and after it: an outlier that is cut off
#: costs more than coarser steps.
_MARGINS = (2.5, 1.3)
#: Cosine of the vectors that are found so and those in floating point, at least, on the windows above.
_LEAST_COSINE = 0.995

#: Types of ONNX's tensors.
_FLOAT, _UINT8, _INT8, _INT64 = 1, 2, 3, 7
_NUMPY = {_FLOAT: np.float32, _UINT8: np.uint8, _INT8: np.int8, _INT64: np.int64}

Latents = NDArray[np.float32]
Load = Callable[[bytes], "InferenceSession"]


@cache
def has_int8_units() -> bool:
    """Whether this processor multiplies numbers of 8 bits faster than floating point; only told on Linux."""
    try:
        return not _UNITS.isdisjoint(Path("/proc/cpuinfo").read_text().split())
    except OSError:
        return False


def open_int8(graph: bytes, load: Load) -> InferenceSession | None:
    """A session of the graph with int8 products; None where its form is another, or its vectors would differ.

    Parameters
    ----------
    graph : bytes
        An ONNX file with the inputs `features` and `lengths`, that was checked.
    load : callable
        Makes a session of such a file.
    """
    parsed = _Graph.of(graph)
    products, normaliser = parsed.products(), parsed.normaliser()
    if not products or normaliser is None:
        return None
    names = list(dict.fromkeys(product.input for product in products))
    normalised = parsed.normalised()
    probe = load(parsed.with_outputs(names))
    ranges = dict.fromkeys(names, (0.0, 0.0))
    wanted = []
    for feed in _random_features(*normaliser):
        latent, *seen = probe.run(None, feed)
        wanted.append((feed, latent))
        for name, values in zip(names, seen, strict=True):
            low, high = ranges[name]
            margin = _MARGINS[name in normalised]
            ranges[name] = (min(low, margin * float(values.min())), max(high, margin * float(values.max())))
    session = load(parsed.with_int8(products, ranges))
    agrees = all(_least_cosine(session.run(None, feed)[0], latent) > _LEAST_COSINE for feed, latent in wanted)
    return session if agrees else None


def _random_features(mean: Latents, inverse: Latents) -> Iterator[dict[str, NDArray[Any]]]:
    """Inputs of the graph: features (N, T, F) that drift at random around a data set's mean, in its spread."""
    rng = np.random.default_rng(0)
    for length in _LENGTHS:
        steps = rng.standard_normal((length, _COUNT, len(mean)), np.float32)
        for before, now in pairwise(steps):
            now *= (1 - _KEPT**2) ** 0.5
            now += _KEPT * before
        spread = rng.uniform(*_SPREADS, (_COUNT, 1, 1)).astype(np.float32)
        features = np.ascontiguousarray(steps.swapaxes(0, 1)) * spread / inverse + mean
        yield {"features": features, "lengths": np.full(_COUNT, length, np.int64)}


def _least_cosine(some: Latents, others: Latents) -> float:
    products = (some * others).sum(axis=1)
    return float((products / np.linalg.norm(some, axis=1) / np.linalg.norm(others, axis=1)).min())


@dataclass(frozen=True)
class _Product:
    """A node that multiplies by a constant matrix: its names, and the matrix (in, out)."""

    input: str
    output: str
    bias: str
    weight: Latents


@dataclass(frozen=True)
class _Node:
    inputs: list[str]
    outputs: list[str]
    operator: str

    @classmethod
    def of(cls, node: Message) -> _Node:
        found: dict[int, list[str]] = {1: [], 2: [], 4: []}
        for number, value in fields(node):
            if number in found:
                found[number].append(text(value))
        return cls(found[1], found[2], "".join(found[4]))


@dataclass(frozen=True)
class _Graph:
    """An ONNX file taken apart: the fields of the file but its graph, those of the graph, and what they mean."""

    file: list[tuple[int, int | memoryview]]
    parts: list[tuple[int, int | memoryview]]
    nodes: list[_Node]
    tensors: dict[str, Message]

    @classmethod
    def of(cls, graph: bytes) -> _Graph:
        file = list(fields(graph))
        parts = [part for number, value in file if number == 7 for part in fields(message(value))]
        nodes = [_Node.of(message(value)) for number, value in parts if number == 1]
        tensors = [message(value) for number, value in parts if number == 5]
        return cls([part for part in file if part[0] != 7], parts, nodes, {_name(tensor): tensor for tensor in tensors})

    def normaliser(self) -> tuple[Latents, Latents] | None:
        """Mean and inverse spread (F,), the first nodes' constants."""
        if [node.operator for node in self.nodes[:2]] != ["Sub", "Mul"] or self.nodes[0].inputs[0] != "features":
            return None
        mean, inverse = (self._array(node.inputs[1]) for node in self.nodes[:2])
        return None if mean is None or inverse is None else (mean, inverse)

    def products(self) -> list[_Product]:
        """The products whose weights are stored as int8 rows, but for the first, in order."""
        makers = {output: node for node in self.nodes for output in node.outputs}
        found = []
        for node in self.nodes:
            shaped = makers.get(node.inputs[1]) if node.operator == "Gemm" and len(node.inputs) == 3 else None
            rows = makers.get(shaped.inputs[0]) if shaped and shaped.operator == "Reshape" else None
            if shaped is None or rows is None or rows.operator != "DequantizeLinear" or len(rows.inputs) != 2:
                continue
            stored, scales, shape = (self._array(name) for name in (*rows.inputs, shaped.inputs[1]))
            if stored is None or scales is None or shape is None or stored.dtype != np.int8:
                continue
            weight = (stored.astype(np.float32) * scales[:, None]).reshape(shape)  # (out, in), as `linear` stores it
            found.append(_Product(node.inputs[0], node.outputs[0], node.inputs[2], weight.T))
        return found[1:]

    def normalised(self) -> set[str]:
        """The names of what is computed from the first normalisation on."""
        operators = [node.operator for node in self.nodes]
        first = operators.index("LayerNormalization") if "LayerNormalization" in operators else len(operators)
        return {output for node in self.nodes[first:] for output in node.outputs}

    def with_outputs(self, names: list[str]) -> bytes:
        """The file with further outputs."""
        kind = field(2, field(1, field(1, _FLOAT)))
        outputs = [field(12, field(1, name) + kind) for name in names]
        return self._file([*(field(number, value) for number, value in self.parts), *outputs])

    def with_int8(self, products: list[_Product], ranges: dict[str, tuple[float, float]]) -> bytes:
        """The file with these products in int8."""
        by_output = {product.output: product for product in products}
        parts, quantised, nodes = [], set[str](), iter(self.nodes)
        for number, value in self.parts:
            product = by_output.get(next(nodes).outputs[0]) if number == 1 else None
            if product is None:
                parts.append(field(number, value))
                continue
            if product.input not in quantised:
                quantised.add(product.input)
                parts += _quantised(product.input, *ranges[product.input])
            parts += _int8_product(product)
        return self._file(parts, field(8, field(1, "com.microsoft") + field(2, 1)))

    def _file(self, parts: list[bytes], more: bytes = b"") -> bytes:
        return b"".join([*(field(number, value) for number, value in self.file), more, field(7, b"".join(parts))])

    def _array(self, name: str) -> NDArray[Any] | None:
        """A constant; None where there is none of this name, or it is stored in another way."""
        dims: list[int] = []
        kind, data = 0, None
        for number, value in fields(self.tensors.get(name, b"")):
            if number == 1:
                dims += [value] if isinstance(value, int) else varints(value)
            elif number == 2 and isinstance(value, int):
                kind = value
            elif number == 9:
                data = message(value)
        return None if data is None or kind not in _NUMPY else np.frombuffer(data, _NUMPY[kind]).reshape(dims)


def _name(tensor: Message) -> str:
    return "".join(text(value) for number, value in fields(tensor) if number == 8)


def _quantised(name: str, low: float, high: float) -> list[bytes]:
    """A node that turns a tensor to uint8, and its constants."""
    step = np.float32((high - low) / 255)
    zero = np.uint8(np.rint(-low / step))
    return [
        _tensor(f"{name}/step", step),
        _tensor(f"{name}/zero", zero),
        _node("QuantizeLinear", [name, f"{name}/step", f"{name}/zero"], f"{name}/int8"),
    ]


def _int8_product(product: _Product) -> list[bytes]:
    """A node of ONNX Runtime's own that multiplies, scales and adds the bias; each column has a scale of its own."""
    scales = np.abs(product.weight).max(axis=0) / 127
    weight = np.rint(product.weight / np.maximum(scales, 1e-12)).astype(np.int8)
    source, own = product.input, product.output
    inputs = [f"{source}/int8", f"{own}/weight", f"{source}/step", f"{own}/scales", f"{source}/zero", "", product.bias]
    return [
        _tensor(f"{own}/weight", weight),
        _tensor(f"{own}/scales", scales.astype(np.float32)),
        _node("MatMulIntegerToFloat", inputs, own, "com.microsoft"),
    ]


def _node(operator: str, inputs: list[str], output: str, domain: str = "") -> bytes:
    """A field of a graph."""
    named = [*(field(1, name) for name in inputs), field(2, output), field(4, operator)]
    return field(1, b"".join([*named, field(7, domain)] if domain else named))


def _tensor(name: str, values: NDArray[Any] | np.generic) -> bytes:
    """A field of a graph."""
    array = np.asarray(values)
    kind = next(kind for kind, dtype in _NUMPY.items() if dtype == array.dtype)
    dims = b"".join(field(1, size) for size in array.shape)
    return field(5, dims + field(2, kind) + field(8, name) + field(9, array.tobytes()))
