"""Opening a USD stage with all its layers, none of which may lie outside the folder of the file."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

from encoders.errors import UnreadableMotion

ENDINGS = (".usd", ".usda", ".usdc", ".usdz")
#: A file of so many bytes, and a scene of so many layers, is cut into parts.
MAX_BYTES = 1 << 30
MAX_LAYERS = 1000


@contextmanager
def opened_stage(path: str | PathLike[str], data: bytes) -> Iterator[Any]:
    """A `pxr.Usd.Stage` of a file; what it refers to is found beside it, if the file is there itself.

    Raises
    ------
    UnreadableMotion
        If usd-core is not installed, the file is damaged or too large, or refers to something outside its folder;
        also for what pxr raises in the body of the `with` statement, and any ValueError there.
    """
    try:
        from pxr import Sdf, Usd, UsdUtils
    except ImportError:
        raise UnreadableMotion(
            path, "USD is read by usd-core, which is not installed: pip install 'motionseek[usd]'"
        ) from None
    if len(data) > MAX_BYTES:
        raise UnreadableMotion(path, f"the USD is larger than {MAX_BYTES >> 30} GB; cut it into takes")
    delegate = UsdUtils.CoalescingDiagnosticDelegate()  # keeps what USD would print
    try:
        with _on_disk(Path(path), data) as place:
            layer = Sdf.Layer.FindOrOpen(str(place))
            if layer is None:
                raise UnreadableMotion(path, "the USD is damaged: it cannot be opened")
            _check_layers(path, layer, place.parent)
            yield Usd.Stage.Open(layer)
    except (RuntimeError, ValueError, TypeError) as error:  # pxr's own is a RuntimeError
        raise UnreadableMotion(path, f"the USD is damaged: {_said(error)}") from None
    finally:
        delegate.TakeCoalescedDiagnostics()
        delegate.TakeUncoalescedDiagnostics()


@contextmanager
def _on_disk(path: Path, data: bytes) -> Iterator[Path]:
    """The file itself, or a copy of what it holds where it is packed, a member of an archive, or called otherwise."""
    ending = path.suffix.lower()
    if ending in ENDINGS and path.is_file() and path.stat().st_size == len(data):
        yield Path(os.path.abspath(path))
        return
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        copy = Path(os.path.realpath(folder)) / f"motion{'.usdz' if ending == '.usdz' else '.usd'}"
        copy.write_bytes(data)
        yield copy


def _check_layers(path: str | PathLike[str], root: Any, folder: Path) -> None:
    """Follow sublayers, references, payloads and value clips; all must lie in the folder or below it."""
    from pxr import Ar, Sdf

    waiting, seen = [root], {root.identifier}
    while waiting:
        layer = waiting.pop()
        for asset in (*layer.GetCompositionAssetDependencies(), *_clips(layer)):
            name = Sdf.Layer.SplitIdentifier(layer.ComputeAbsolutePath(asset))[0] if asset else ""
            outer = os.path.normpath(Ar.SplitPackageRelativePathOuter(name)[0])
            if not name or "`" in asset or not os.path.isabs(outer) or not Path(outer).is_relative_to(folder):
                raise UnreadableMotion(path, f"it refers to {asset[:80]!r} outside its folder; flatten it to one file")
            if name in seen:
                continue
            seen.add(name)
            if len(seen) > MAX_LAYERS:
                raise UnreadableMotion(path, f"it has more than {MAX_LAYERS} layers; flatten it to one file")
            other = Sdf.Layer.FindOrOpen(name)
            if other is not None:  # what is missing is missing from the stage, too
                waiting.append(other)


def _clips(layer: Any) -> list[str]:
    """The files of value clips that a layer names; a template is taken for a file."""
    from pxr import Sdf

    found: list[str] = []

    def collect(value: Any) -> None:
        if isinstance(value, Sdf.AssetPath):
            found.append(value.path)
        elif isinstance(value, dict):
            for key, inner in value.items():
                if key == "templateAssetPath" and isinstance(inner, str):
                    found.append(inner)
                collect(inner)
        elif not isinstance(value, str) and hasattr(value, "__iter__"):
            for inner in value:
                collect(inner)

    def visit(place: Any) -> None:
        if place.IsPrimPath() or place.IsPrimVariantSelectionPath():
            spec = layer.GetPrimAtPath(place)
            if spec is not None and spec.HasInfo("clips"):
                collect(spec.GetInfo("clips"))

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    return found


def _said(error: Exception) -> str:
    """What an error says, in a line; one of USD holds several."""
    try:
        first = error.args[0] if error.args else type(error).__name__
        text = str(getattr(first, "commentary", first))
    except UnicodeDecodeError:
        return "it holds text that is not UTF-8"
    return " ".join(text.split())[:200]
