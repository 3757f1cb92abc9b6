"""What an ONNX graph may hold: the operators of an encoder over its own data, nothing that grows as it is loaded.

A graph is data that somebody else may have crafted. It is looked at here, by the wire format of protobuf, before any
library parses it. Memory at work is bounded apart from this, by the session's allocator: `encoders.bundle.sessions`.
"""

from __future__ import annotations

from math import prod

from encoders.bundle.protobuf import Message, fields, message, text, varints

#: Operators of the encoders that are exported, and those that other exporters write in place of them.
OPERATORS = frozenset(
    "Abs Add And BitShift BitwiseAnd BitwiseOr Cast Clip Concat Constant ConstantOfShape Cos CumSum "
    "DequantizeLinear Div Equal Erf Exp Expand Flatten Gather Gelu Gemm Greater GreaterOrEqual Identity "
    "LayerNormalization Less LessOrEqual Log MatMul Max Min Mod Mul Neg Not Or Pad Pow Range Reciprocal ReduceL2 "
    "ReduceMax ReduceMean ReduceSum Relu Reshape Shape Sigmoid Sin Slice Softmax Split Sqrt Squeeze Sub Tanh "
    "Transpose Trilu Unsqueeze Where".split()
)
#: Those whose output may be of any size whatever their inputs are: not of constants alone, which are computed at once.
_GROWING = frozenset({"ConstantOfShape", "Expand", "Pad", "Range"})
#: Those whose work is not in proportion to what they read and write.
_HEAVY = frozenset({"Gemm", "MatMul"})
#: Those whose output is no larger than their first input.
_KEEPING = frozenset({"Cast", "DequantizeLinear", "Flatten", "Identity", "Reshape", "Slice", "Squeeze", "Transpose"})

#: Nodes of a graph, and numbers of one constant and of all that are computed as it is loaded.
MAX_NODES, MAX_CONSTANT, MAX_CONSTANTS = 20_000, 1 << 26, 1 << 28
#: Numbers that may be computed from shapes alone: at a time where no constant has more, and together with constants.
_FEW, _MANY = 1 << 12, 1 << 30


def check_graph(data: Message) -> int:
    """Check a whole ONNX file.

    Returns
    -------
    int
        Numbers of the largest constant that is to be computed as the graph is loaded. What could be computed from the
        shapes of its inputs may be of any size and is not to be, beyond this.

    Raises
    ------
    ValueError
        Says what it holds that no encoder needs; or that it is no such file.
    """
    graphs = []
    for field, value in fields(data):
        if field in (20, 25):
            raise ValueError("it defines functions or training")
        if field == 7:
            graphs.append(message(value))
    if len(graphs) != 1:
        raise ValueError(f"{len(graphs)} graphs, not one")
    sizes: dict[str, int] = {}
    nodes = []
    for field, value in fields(graphs[0]):
        if field == 1:
            nodes.append(message(value))
        elif field == 5:
            name, size = _tensor(message(value))
            sizes[name] = size
        elif field == 15:
            raise ValueError("it has sparse weights")
    if len(nodes) > MAX_NODES:
        raise ValueError(f"{len(nodes)} nodes are more than {MAX_NODES}")
    computed, largest, of_shapes = 0, _FEW, set[str]()
    for node in nodes:
        size = _node(node, sizes, of_shapes)
        computed, largest = computed + size, max(largest, size)
    if computed > MAX_CONSTANTS:
        raise ValueError(f"constants of {computed} numbers are computed, more than {MAX_CONSTANTS}")
    if computed + largest * len(of_shapes) > _MANY:
        raise ValueError(f"{len(of_shapes)} nodes compute up to {largest} numbers each of shapes alone")
    return largest


def _node(node: memoryview, sizes: dict[str, int], of_shapes: set[str]) -> int:
    """Check one node; how large its outputs are, if all its inputs are constant.

    Notes the sizes of outputs that are, and of others the names of those that no more than the shapes of inputs decide.
    """
    inputs, outputs, operator, own = [], [], "", 0
    for field, value in fields(node):
        if field == 1:
            inputs.append(text(value))
        elif field == 2:
            outputs.append(text(value))
        elif field == 4:
            operator = text(value)
        elif field == 5:
            own += _attribute(message(value))
        elif field == 7 and text(value) not in ("", "ai.onnx"):
            raise ValueError(f"operator of the domain {text(value)!r}")
    if operator not in OPERATORS:
        raise ValueError(f"operator {operator!r}, which no encoder needs")
    if operator != "Constant" and not all(name in sizes for name in inputs if name):
        if operator == "Shape" or all(name in sizes or name in of_shapes for name in inputs if name):
            if operator in _HEAVY:
                raise ValueError(f"{operator} of shapes alone")
            of_shapes.update(outputs)
        return 0
    given = [sizes[name] for name in inputs if name]
    if operator in _GROWING:
        raise ValueError(f"{operator} of constants alone")
    size = own if operator == "Constant" else given[0] if operator in _KEEPING else prod(max(n, 1) for n in given)
    if operator == "Concat":
        size = sum(given)
    if size > MAX_CONSTANT:
        raise ValueError(f"{operator} of constants, of up to {size} numbers")
    sizes.update(dict.fromkeys(outputs, size))
    return size * len(outputs)


def _attribute(attribute: memoryview) -> int:
    """Numbers that an attribute holds."""
    size = 0
    for field, value in fields(attribute):
        if field in (6, 11):
            raise ValueError("a graph within a node")
        if field in (22, 23):
            raise ValueError("it has sparse weights")
        if field in (5, 10):
            size += _tensor(message(value))[1]
        elif field in (4, 7, 8, 9):
            size += len(value) if isinstance(value, memoryview) else 1
    return size


def _tensor(tensor: memoryview) -> tuple[str, int]:
    """Name of a tensor and its size, no larger than its data."""
    name, dims = "", []
    for field, value in fields(tensor):
        if field == 1:
            dims += list(varints(value)) if isinstance(value, memoryview) else [value]
        elif field == 8:
            name = text(value)
        elif field == 13 or (field == 14 and value != 0):
            raise ValueError("weights in another file")
    size = prod(dims)
    if size > 2 * len(tensor):  # two numbers a byte are the fewest bytes there are
        raise ValueError(f"weights {name!r} of {dims} are more than are there")
    return name, size
