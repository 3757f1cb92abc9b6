"""An ONNX graph built node by node, with weights quantised on request."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper
from torch import Tensor, nn

from encoders.tmr.conversion.quantise import MIDDLE, int4_rows, int8_rows

OPSET = 20
IR_VERSION = 10

#: Matrices with fewer numbers stay in floating point: they weigh nothing and their error would.
_SMALLEST = 2048
#: Numbers of an output channel that share a scale; one scale for the whole channel moves MiniLM's vectors three times
#: as far (1 - cosine of 100 sentence embeddings: 4.7e-4 against 1.6e-4 on average).
_BLOCK = 64


class GraphBuilder:
    """Builds an ONNX graph; every method adds nodes and returns the name of their output."""

    def __init__(self, *, int8: bool) -> None:
        self._int8 = int8
        self._nodes: list[onnx.NodeProto] = []
        self._weights: list[TensorProto] = []
        self._constants: dict[tuple[Any, ...], str] = {}

    def add(self, operator: str, *inputs: str, outputs: int = 1, **attributes: Any) -> Any:
        """One node; the name of its output, or a list of them where it has several."""
        names = [f"{operator.lower()}_{len(self._nodes)}" + (f"_{i}" if outputs > 1 else "") for i in range(outputs)]
        self._nodes.append(helper.make_node(operator, inputs, names, **attributes))
        return names[0] if outputs == 1 else names

    def constant(self, values: Any, dtype: Any = np.int64) -> str:
        """A constant of any shape; equal ones are stored once."""
        array = np.asarray(values, dtype)
        key = (array.dtype.str, array.shape, array.tobytes())
        if key not in self._constants:
            self._constants[key] = self._store(array, "constant")
        return self._constants[key]

    def matrix(self, weight: Tensor) -> str:
        """A weight matrix (out, in); int8 is dequantised when the runtime loads it."""
        array = weight.detach().numpy()
        if not self._int8 or array.size < _SMALLEST:
            return self._store(array, "weight")
        block = _BLOCK if array.shape[1] % _BLOCK == 0 else array.shape[1]
        values, scales = int8_rows(array.reshape(-1, block))
        rows = self.add("DequantizeLinear", self._store(values, "int8"), self._store(scales, "scale"), axis=0)
        return str(self.add("Reshape", rows, self.constant(array.shape)))

    def rows(self, table: Tensor, indices: str) -> str:
        """Rows of an embedding table (V, D) at indices (A, B); of 4 bits, only these rows are dequantised."""
        array = table.detach().numpy()
        if not self._int8:
            return self.add("Gather", self._store(array, "table"), indices)
        width = array.shape[1]
        block = _BLOCK if width % _BLOCK == 0 else width
        packed, scales = int4_rows(array, block)
        pairs = self.add("Gather", self._store(packed, "table"), indices)
        low = self.add("BitwiseAnd", pairs, self.constant([15], np.uint8))
        high = self.add("BitShift", pairs, self.constant([4], np.uint8), direction="RIGHT")
        steps = self.add("Cast", self.add("Concat", low, high, axis=2), to=TensorProto.FLOAT)
        centred = self.add("Sub", steps, self.constant(MIDDLE, np.float32))
        blocks = self.add("Reshape", centred, self.constant([0, 0, -1, block]))
        scale = self.add("Cast", self.add("Gather", self._store(scales, "scale"), indices), to=TensorProto.FLOAT)
        scaled = self.add("Mul", blocks, self.add("Unsqueeze", scale, self.constant([3])))
        return str(self.add("Reshape", scaled, self.constant([0, 0, width])))

    def linear(self, x: str, weight: Tensor, bias: Tensor) -> str:
        """x (N, in) -> (N, out)."""
        return self.add("Gemm", x, self.matrix(weight), self.constant(bias.detach().numpy(), np.float32), transB=1)

    def norm(self, x: str, layer: nn.LayerNorm) -> str:
        """Layer normalisation over the last axis."""
        scale, bias = (self.constant(p.detach().numpy(), np.float32) for p in (layer.weight, layer.bias))
        return self.add("LayerNormalization", x, scale, bias, epsilon=layer.eps)

    def size(self, x: str, axis: int) -> str:
        """The length of an axis, shape (1,)."""
        return self.add("Shape", x, start=axis, end=axis + 1)

    def shape(self, *sizes: str | int) -> str:
        """A shape out of numbers and of names of sizes."""
        parts = [size if isinstance(size, str) else self.constant([size]) for size in sizes]
        return self.add("Concat", *parts, axis=0)

    def model(
        self,
        name: str,
        inputs: Mapping[str, tuple[int, Sequence[Any]]],
        outputs: Mapping[str, tuple[str, Sequence[Any]]],
    ) -> onnx.ModelProto:
        """The graph as a checked model.

        Parameters
        ----------
        inputs : {name: (type, shape)}
        outputs : {name: (what was added last of it, shape)}
        """
        for key, (output, _) in outputs.items():
            self._nodes.append(helper.make_node("Identity", [output], [key]))
        graph = helper.make_graph(
            self._nodes,
            name,
            [helper.make_tensor_value_info(key, kind, shape) for key, (kind, shape) in inputs.items()],
            [helper.make_tensor_value_info(key, TensorProto.FLOAT, shape) for key, (_, shape) in outputs.items()],
            self._weights,
        )
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=IR_VERSION)
        onnx.checker.check_model(model)
        return model

    def _store(self, array: NDArray[Any], kind: str) -> str:
        name = f"{kind}_{len(self._weights)}"
        self._weights.append(numpy_helper.from_array(np.array(array, order="C"), name))
        return name
