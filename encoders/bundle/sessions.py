"""ONNX graphs at work on the CPU: checked before they are loaded, and with a bound on the memory they take."""

from __future__ import annotations

import os
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

from encoders.bundle.graph_check import check_graph
from encoders.bundle.int8_graph import has_int8_units, open_int8
from encoders.errors import BundleError

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

#: Bytes of the largest graph file, and of memory for all graphs of the process together while they run.
LARGEST_GRAPH, MEMORY = 1 << 30, 4 << 30

#: The first onnxruntime that bounds what it computes as it loads a graph.
_BOUNDS_FOLDING = (1, 27)

_allocating = threading.Lock()
_allocators: list[Any] = []


def open_session(path: Path, threads: int | None = None, *, int8: bool = False) -> InferenceSession:
    """An onnxruntime session on the CPU; weights stored small are turned to floating point here, once.

    Parameters
    ----------
    int8 : bool
        Multiply numbers of 8 bits where the processor has units for it; see `encoders.bundle.int8_graph`.

    Raises
    ------
    BundleError
        If the file is none of an encoder; see `check_graph`.
    """
    try:
        if path.stat().st_size > LARGEST_GRAPH:
            raise ValueError(f"larger than {LARGEST_GRAPH >> 20} MB")
        graph = path.read_bytes()
        largest = check_graph(graph)
    except (OSError, ValueError) as error:
        raise BundleError(f"{path}: refused ({error})") from error
    # No telemetry: this must be set before onnxruntime is loaded.
    os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads or 0
    options.log_severity_level = 4  # what fails is raised
    options.add_session_config_entry("session.disable_quant_qdq", "1")  # fold DequantizeLinear into the weights
    # Threads that spin while they wait take cores from readers and other requests: twice the CPU time, and slower.
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    # What is computed as it is loaded has a bound. Older ones know none, and compute at work, where there is another.
    options.add_session_config_entry("optimization.constant_folding_max_output_size_in_bytes", str(8 * largest))
    without = [] if _version(onnxruntime) >= _BOUNDS_FOLDING else ["ConstantFolding"]
    if _has_bounded_allocator(onnxruntime):
        options.add_session_config_entry("session.use_env_allocators", "1")

    def load(graph: bytes) -> InferenceSession:  # from bytes: there is no folder for it to look into
        return onnxruntime.InferenceSession(
            graph, options, providers=["CPUExecutionProvider"], disabled_optimizers=without
        )

    try:
        small = open_int8(graph, load) if int8 and has_int8_units() else None
        return small or load(graph)
    except Exception as error:  # onnxruntime's errors have no common base but Exception
        raise BundleError(f"{path}: onnxruntime cannot load it ({error})") from error


def _version(onnxruntime: Any) -> tuple[int, ...]:
    return tuple(int(part) for part in onnxruntime.__version__.split(".")[:2])


def run(session: InferenceSession, path: Path, feed: dict[str, Any]) -> Any:
    """The first output of a graph.

    Raises
    ------
    BundleError
        If it cannot be computed, or only in more than `MEMORY`.
    """
    try:
        return session.run(None, feed)[0]
    except Exception as error:
        raise BundleError(f"{path}: fails at work ({str(error)[:500]})") from error


def _has_bounded_allocator(onnxruntime: Any) -> bool:
    """Make the allocator of all sessions of this process, once; False where another one is registered."""
    with _allocating:
        if not _allocators:
            kind = onnxruntime.OrtAllocatorType.ORT_ARENA_ALLOCATOR
            place = onnxruntime.OrtMemoryInfo("Cpu", kind, 0, onnxruntime.OrtMemType.DEFAULT)
            try:
                onnxruntime.create_and_register_allocator(place, onnxruntime.OrtArenaCfg(MEMORY, -1, -1, -1))
                _allocators.append(place)
            except Exception:  # onnxruntime's errors have no common base but Exception
                _allocators.append(None)
        return _allocators[0] is not None
