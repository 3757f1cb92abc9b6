"""Animation curves: keys in time, and what each says of the way to the next.

Which bits and numbers of a key mean what is as ufbx (version 0.21), and with it the FBX SDK, has it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx.records import DamagedFbx, Record

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

CONSTANT, CUBIC = 0x2, 0x8
TO_NEXT = 0x100  # of a constant: it takes the next key's value
TCB, USER = 0x200, 0x400
CLAMP, TIME_INDEPENDENT, CLAMP_PROGRESSIVE = 0x1000, 0x2000, 0x4000
_WEIGHTED, _NEXT_WEIGHTED = 0x1000000, 0x2000000
THIRD = 0.333333
_WEIGHT_UNIT = 1e-4
_LAST_TIME = 1 << 60  # in ticks


class Extrapolation(NamedTuple):
    """What a curve does beyond its keys: the format's letter, C where it stays; how often, below 0 for ever."""

    mode: str = "C"
    repeats: int = -1


_STAYS = Extrapolation()
_ARRAYS = ("KeyTime", "KeyValueFloat", "KeyAttrFlags", "KeyAttrDataFloat", "KeyAttrRefCount")


class Attributes(NamedTuple):
    """How a curve goes on from its keys.

    Attributes
    ----------
    runs : int array (R,)
        How many keys in sequence each of the following is for.
    flags : int array (R,)
    slopes : float array (R, 2)
        Of the tangent after the key, and of that before the next key. For TCB keys tension and continuity.
    weights : float array (R, 2)
        Likewise.
    bias : float array (R,)
        Of TCB keys.
    is_straight : bool
        Whether the curve goes straight from all its keys.
    """

    runs: Integers
    flags: Integers
    slopes: Floats
    weights: Floats
    bias: Floats
    is_straight: bool

    @classmethod
    def of(cls, runs: Integers, flags: Integers, slopes: Floats, weights: Floats, bias: Floats) -> Attributes:
        """Attributes, and whether the curve goes straight from all its keys."""
        return cls(runs, flags, slopes, weights, bias, not (flags & (CONSTANT | CUBIC)).any())


@dataclass(frozen=True)
class Curve:
    """Keys of one curve: times (K,) in ticks, ascending; values (K,); how it goes on between and beyond them."""

    times: Integers
    values: Floats
    attributes: Attributes
    before: Extrapolation
    after: Extrapolation

    @property
    def stays(self) -> bool:
        """Whether it stays where it is beyond its keys."""
        return self.before.mode == self.after.mode == "C"

    @property
    def is_still(self) -> bool:
        """Whether it has one value at all times."""
        return self.attributes.is_straight and bool((self.values == self.values[0]).all())


class CurveReader:
    """Reads curves; what several have in common, as most have in files of baked motion, is decoded once."""

    def __init__(self) -> None:
        self._known: dict[tuple[int, ...], tuple[object, Attributes]] = {}
        self._in_order: dict[int, Integers] = {}

    def read(self, record: Record) -> Curve | None:
        """The curve of a record; None where it has no keys.

        Raises
        ------
        DamagedFbx
            Where its arrays do not belong together.
        """
        times, values = record.numbers("KeyTime", "i8"), record.numbers("KeyValueFloat", "f8")
        if not len(times):
            return None
        if len(values) != len(times):
            raise DamagedFbx(f"a curve of {len(times)} keys has {len(values)} values")
        arrays = (
            record.numbers("KeyAttrFlags", "i4"),
            record.numbers("KeyAttrDataFloat", "f4"),
            record.numbers("KeyAttrRefCount", "i4"),
        )
        key = (*map(id, arrays), len(times))
        if key not in self._known:  # the arrays are kept, so that no others get their identities
            self._known[key] = arrays, decoded(*arrays, len(times))
        beyond = extrapolations(record) if len(record.children) > len(_ARRAYS) else (_STAYS, _STAYS)
        curve = Curve(times, values, self._known[key][1], *beyond)
        if id(times) in self._in_order and np.isfinite(values).all():
            return curve
        curve = checked(curve)
        if curve.times is times:
            self._in_order[id(times)] = times
        return curve


def decoded(flags: Integers, data: NDArray[np.float32], runs: Integers, count: int) -> Attributes:
    """Attributes out of flags (R,), four numbers for each (R * 4,), and for how many of `count` keys each is (R,).

    Raises
    ------
    DamagedFbx
        Where they are too few.
    """
    ends = np.minimum(np.cumsum(np.clip(runs.astype(np.int64), 0, count)), count)
    if not len(ends) or ends[-1] < count or len(runs) != len(flags) or len(data) != 4 * len(runs):
        raise DamagedFbx(f"a curve of {count} keys has attributes for fewer")
    data = data.reshape(-1, 4)
    numbers = data[:, :3].astype(np.float64)
    if not np.isfinite(numbers).all():
        numbers = np.nan_to_num(numbers)
    weights = unpacked_weights(flags, np.ascontiguousarray(data[:, 2]))
    return Attributes.of(np.diff(ends, prepend=0), flags.astype(np.int64), numbers[:, :2], weights, numbers[:, 2])


def unpacked_weights(flags: Integers, packed: NDArray[np.float32]) -> Floats:
    """Weights (R, 2), of which two are packed into the bits of one number."""
    if not (flags & (_WEIGHTED | _NEXT_WEIGHTED)).any():
        return np.broadcast_to(THIRD, (len(flags), 2))
    bits = packed.view("<u4").astype(np.int64)
    return np.stack(
        [
            np.where(flags & _WEIGHTED, (bits & 0xFFFF) * _WEIGHT_UNIT, THIRD),
            np.where(flags & _NEXT_WEIGHTED, (bits >> 16) * _WEIGHT_UNIT, THIRD),
        ],
        axis=1,
    )


def checked(curve: Curve) -> Curve:
    """The curve, with keys in order of time.

    Raises
    ------
    DamagedFbx
        Where values are no numbers.
    """
    times = curve.times
    if not np.isfinite(curve.values).all() or max(abs(int(times[0])), abs(int(times[-1]))) > _LAST_TIME:
        raise DamagedFbx("a curve holds values that are no numbers")
    if (times[1:] < times[:-1]).any():
        order = np.argsort(times, kind="stable")
        if max(abs(int(times[order[0]])), abs(int(times[order[-1]]))) > _LAST_TIME:
            raise DamagedFbx("a curve has keys at impossible times")
        runs, flags, slopes, weights, bias, _ = curve.attributes
        run = np.repeat(np.arange(len(runs)), runs)[order]
        ones = np.ones(len(order), np.int64)
        attributes = Attributes.of(ones, flags[run], slopes[run], weights[run], bias[run])
        curve = replace(curve, times=times[order], values=curve.values[order], attributes=attributes)
    return curve


def extrapolations(record: Record) -> tuple[Extrapolation, Extrapolation]:
    found = []
    for name in ("Pre-Extrapolation", "Post-Extrapolation"):
        child = record.find(name)
        kind = child.find("Type") if child is not None else None
        if child is None or kind is None or not kind.values:
            found.append(Extrapolation())
            continue
        mode = kind.values[0]
        letter = chr(mode) if isinstance(mode, int) and 0 < mode < 128 else str(mode)
        found.append(Extrapolation(letter, int(np.clip(child.number("Repetition", -1), -1, 1 << 30))))
    return found[0], found[1]
