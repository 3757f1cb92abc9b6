"""Decimal numbers in text, all at once: eight characters are one machine word, and array arithmetic does the rest.

In a little-endian word the decimal point is found and taken out by masks, and the digits add up in three
multiplications: pairs, fours, eights. Two words hold sixteen characters; longer numbers are read by numpy's C parser
or by Python.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bits = NDArray[np.uint64]
Bools = NDArray[np.bool_]

#: Characters of a word at most; what is longer is no number and no name.
MAX_WORD = 256

#: Makes spaces of the commas and semicolons of a text.
SEPARATORS = bytes.maketrans(b",;", b"  ")

_BLOCK = 1 << 17  # characters: all arrays of a block stay in the processor's cache
_SIZE = 16  # characters of two machine words
_MANY = 0.1  # share of a block's words for which numpy's parser is tried before Python's

_EXPONENTS = 290  # larger ones come near to what a float can hold
_POWERS = np.array([float(f"1e{k}") for k in range(_EXPONENTS + _SIZE + 1)])

_U = np.uint64


def _each(byte: int) -> np.uint64:
    """A machine word of eight equal bytes."""
    word: np.uint64 = _U(0x0101010101010101 * byte)
    return word


_ZERO, _ZEROS, _POINTS = _U(ord("0")), _each(ord("0")), _each(ord("."))
_ONE, _ONES, _HIGHEST, _OVER_NINE = _U(1), _each(0x01), _each(0x80), _each(0x80 - 10)
#: By how many of eight characters are wanted: a mask for those, and zeros ("0") for the others.
_KEPT = np.array([2**64 - (1 << 8 * (8 - k)) for k in range(9)], np.uint64)
_FILLED = np.array([int(_ZEROS) >> 8 * k for k in range(9)], np.uint64)
_BYTE = np.array([1, 256], np.uint64)
_SIGN = np.array([1.0, -1.0])
#: Digits, pairs and fours: which bits are kept, by what they are multiplied, where the sums then stand.
_SUMS = (
    (_each(0x0F), _U(10 * 2**8 + 1), _U(8)),
    (_U(0x00FF00FF00FF00FF), _U(100 * 2**16 + 1), _U(16)),
    (_U(0x0000FFFF0000FFFF), _U(10000 * 2**32 + 1), _U(32)),
)
#: Times 256**k it has 7 - k, the number of bytes after byte k, in its highest three bits.
_BYTES_AFTER, _THREE_BITS = _U(sum((7 - k) << (61 - 8 * k) for k in range(8))), _U(61)


class Words(NamedTuple):
    """The words of a text: its characters, and where in them each word starts and ends."""

    letters: NDArray[np.uint8]
    starts: Ints
    ends: Ints

    @classmethod
    def of(cls, text: bytes) -> Words:
        """What white space parts."""
        letters = np.frombuffer(bytes(_SIZE) + text + b" " * 8, np.uint8)
        ink = letters > ord(" ")
        edges = (ink[1:] != ink[:-1]).nonzero()[0]
        edges += 1
        return cls(letters, edges[::2], edges[1::2])

    def where(self, chosen: Bools) -> Words:
        """Some of the words."""
        return Words(self.letters, self.starts[chosen], self.ends[chosen])

    def at(self, index: int) -> bytes:
        """One word."""
        return self.letters[self.starts[index] : self.ends[index]].tobytes()

    def before_line_ends(self, line_end: int) -> Ints:
        """How many words precede each end of a line, which is a character."""
        before: Ints = np.searchsorted(self.starts, (self.letters == line_end).nonzero()[0])
        return before

    def numbers(self) -> Floats:
        """The words as numbers, NaN where one is none; a few units in the last place off if of more than 15 digits."""
        if not len(self.starts):
            return np.empty(0)
        owners, exponents, mantissas = self._exponents()
        digits, decimals, is_plain, is_negative = mantissas._integers()
        values = digits.astype(np.float64)
        if len(owners):
            exponents -= decimals[owners]
            decimals[owners] = 0
            values[owners] /= _POWERS.take(-exponents, mode="clip")
            values[owners] *= _POWERS.take(exponents, mode="clip")
        values /= _POWERS[decimals]
        values *= _SIGN[is_negative.view(np.uint8)]
        if not is_plain.all():
            self._read_others(values, is_plain)
        return values

    def _exponents(self) -> tuple[Ints, Ints, Words]:
        """Which words have exponents; these; the words without them."""
        marks = self._after_digits(b"eE")
        if not len(marks):
            return marks, marks, self
        owners = np.searchsorted(self.starts, marks, side="right") - 1
        first = self.letters[marks + 1]
        is_negative = first == ord("-")
        sizes = self.ends[owners] - marks - 1 - (is_negative | (first == ord("+")))
        digits = self.eights(self.ends[owners], sizes)
        fits = (sizes > 0) & (sizes <= 8) & _are_digits(digits, (np.empty_like(digits), np.empty_like(digits)))
        exponents = _sum(digits).view(np.int64) * np.where(is_negative, -1, 1)
        fits &= np.abs(exponents) <= _EXPONENTS
        marks, owners = marks[fits], owners[fits]
        ends = self.ends.copy()
        ends[owners] = marks
        return owners, exponents[fits], Words(self.letters, self.starts, ends)

    def _after_digits(self, wanted: bytes) -> Ints:
        """Where letters stand after a digit or a point."""
        text = self.letters.tobytes()
        places = [(self.letters == letter).nonzero()[0] for letter in wanted if letter in text]
        marks: Ints = np.sort(np.concatenate(places)) if places else np.empty(0, np.int64)
        follows: Ints = marks[self.letters[marks - 1] <= ord("9")]
        return follows

    def _integers(self) -> tuple[Bits, Ints, Bools, Bools]:
        """The digits of numbers, how many are decimals; whether a word is a number, and a negative one."""
        first = self.letters[self.starts]
        is_negative = first == ord("-")
        sizes = self.ends - self.starts
        sizes -= is_negative | (first == ord("+"))
        count = int(self.ends[0] - 1 - self.starts[0]) - self.at(0).find(b".")
        if count <= 8 and (self.letters[self.ends - count - 1] == ord(".")).all():
            return *self._with_decimals(sizes, count), is_negative
        return *self._with_any_decimals(sizes), is_negative

    def _with_decimals(self, sizes: Ints, count: int) -> tuple[Bits, Ints, Bools]:
        """Numbers that all have the same count of decimals, at most eight."""
        decimals = np.full(len(sizes), count)
        fraction = self.eights(self.ends, decimals)
        sizes -= count + 1
        whole = self.eights(self.ends - count - 1, sizes)
        spare = np.empty_like(whole), np.empty_like(whole)
        is_number = (sizes >= (count == 0)) & (sizes <= 8)
        is_number &= _are_digits(whole, spare)
        is_number &= _are_digits(fraction, spare)
        digits = _sum(whole)
        digits *= _U(10**count)
        digits += _sum(fraction)
        return digits, decimals, is_number

    def _with_any_decimals(self, sizes: Ints) -> tuple[Bits, Ints, Bools]:
        low = self.eights(self.ends, sizes)
        spare = np.empty_like(low), np.empty_like(low)
        point = _point(low, spare[0])
        has_point = point != 0
        decimals = _bytes_after(point)
        _take_out(low, point, has_point, spare)
        is_number = sizes > has_point
        are_long = sizes > 8
        count = np.count_nonzero(are_long)
        if count:
            long = slice(None) if count > len(sizes) / 2 else are_long.nonzero()[0]
            high = self.eights(self.ends[long] - 8, sizes[long] - 8)
            in_low = has_point[long]
            low[long] += ((high >> _U(56)) - _ZERO) * in_low
            high_spare = np.empty_like(high), np.empty_like(high)
            point = _point(high, high_spare[0])
            point *= ~in_low
            in_high = point != 0
            decimals[long] += (_bytes_after(point) + 8) * in_high
            _take_out(high, point, in_low | in_high, high_spare)
            is_number[long] &= _are_digits(high, high_spare) & (sizes[long] <= _SIZE)
        is_number &= _are_digits(low, spare)
        digits = _sum(low)
        if count:
            digits[long] += _sum(high) * _U(10**8)
        return digits, decimals, is_number

    def eights(self, ends: Ints, sizes: Ints) -> Bits:
        """The last characters before some places, eight at most; zeros ("0") in front of fewer."""
        every = np.ndarray(len(self.letters) - 7, "<u8", self.letters.data, strides=(1,))
        eights: Bits = every[ends - 8]
        eights &= _KEPT.take(sizes, mode="clip")
        eights |= _FILLED.take(sizes, mode="clip")
        return eights

    def _read_others(self, values: Floats, is_plain: Bools) -> None:
        """Put the numbers that are not plain in their places."""
        if np.count_nonzero(is_plain) < (1 - _MANY) * len(values):
            all_values = _fromstring(self.letters[_SIZE:].tobytes())
            if all_values is not None and len(all_values) == len(values):
                values[~is_plain] = all_values[~is_plain]
                return
        for i in (~is_plain).nonzero()[0]:
            values[i] = as_number(self.at(int(i)))


class Numbers(NamedTuple):
    """Numbers (N,) of a text, NaN where a word is none; how many precede each line's end; the first such word."""

    values: Floats
    before_line_ends: Ints
    wrong: str

    def per_line(self) -> Ints:
        """How many numbers each line holds that holds any."""
        counts = np.diff(self.before_line_ends, prepend=0, append=len(self.values))
        return counts[counts > 0]


def parse_numbers(text: bytes) -> Floats:
    """All numbers of a text, separated by white space, commas or semicolons.

    Raises
    ------
    ValueError
        If something in it is no number; names it.
    """
    numbers = parse_lines(text.translate(SEPARATORS))
    if numbers.wrong:
        raise ValueError(f"{numbers.wrong[:40]!r} is no number")
    return numbers.values


def parse_lines(text: bytes) -> Numbers:
    """All numbers of a text, separated by white space, and how they lie in lines.

    Raises
    ------
    ValueError
        If something is longer than a number can be; names it.
    """
    values: list[Floats] = []
    line_ends: list[Ints] = []
    line_end = ord("\n") if b"\n" in text else ord("\r")
    count, wrong = 0, ""
    for words in blocks(text):
        values.append(words.numbers())
        line_ends.append(words.before_line_ends(line_end) + count)
        count += len(words.starts)
        if not wrong and np.isnan(values[-1]).any():
            wrong = words.at(int(np.isnan(values[-1]).argmax())).decode("latin-1")
    if not values:
        return Numbers(np.empty(0), np.empty(0, np.int64), "")
    ends = np.concatenate(line_ends)
    return Numbers(np.concatenate(values), ends[np.diff(ends, prepend=-1) > 0], wrong)


def blocks(text: bytes) -> Iterator[Words]:
    """The words of a text, some thousand at a time.

    Raises
    ------
    ValueError
        If one is longer than `MAX_WORD`.
    """
    at = 0
    while at < len(text):
        block = text[at : at + _BLOCK]
        at += len(block)
        if at < len(text):
            split = block.rsplit(None, 1)
            if len(split) == 2:  # the last word may go on in the next block
                kept = block.rfind(split[1])
                at -= len(block) - kept
                block = block[:kept]
        words = Words.of(block)
        if len(words.starts) and (sizes := words.ends - words.starts).max() > MAX_WORD:
            start = words.at(int(sizes.argmax()))[:40].decode("latin-1")
            raise ValueError(f"{start!r}... is longer than {MAX_WORD} characters")
        yield words


def as_number(word: bytes) -> float:
    """A number of any form, or NaN."""
    try:
        return float(word) if b"_" not in word else np.nan  # which Python would take between digits
    except ValueError:
        return np.nan


def _point(eights: Bits, spare: Bits) -> Bits:
    """256**k where character k is the first decimal point, else 0."""
    np.bitwise_xor(eights, _POINTS, out=spare)
    points = spare - _ONES
    np.invert(spare, out=spare)
    points &= spare
    points &= _HIGHEST
    points &= np.negative(points, out=spare)
    points >>= _U(7)
    return points


def _bytes_after(point: Bits) -> Ints:
    """How many characters of eight come after a point; 0 where there is none."""
    point = point * _BYTES_AFTER
    point >>= _THREE_BITS
    return point.view(np.int64)


def _take_out(eights: Bits, point: Bits, shifted: Bools, spare: tuple[Bits, Bits]) -> None:
    """Take the point out of eight characters; where `shifted`, those before it move up behind a zero ("0")."""
    before, factor = spare
    np.subtract(point, _ONE, out=before)
    before &= eights
    before *= _BYTE.take(shifted.view(np.uint8), out=factor, mode="clip")
    np.left_shift(point, _U(8), out=point)
    np.negative(point, out=point)
    eights &= point
    eights |= before
    eights |= np.multiply(shifted, _ZERO, out=before)


def _are_digits(eights: Bits, spare: tuple[Bits, Bits]) -> Bools:
    values, over = spare
    np.bitwise_xor(eights, _ZEROS, out=values)
    np.add(values, _OVER_NINE, out=over)
    over |= values
    over &= _HIGHEST
    are_digits: Bools = over == 0
    return are_digits


def _sum(digits: Bits) -> Bits:
    """The number that eight digits are. Changes them."""
    for mask, factor, shift in _SUMS:
        digits &= mask
        digits *= factor
        digits >>= shift
    return digits


def _fromstring(text: bytes) -> Floats | None:
    """The numbers of a text, or None where it holds something else."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=np.float64, sep=" ")
        except (DeprecationWarning, ValueError):
            return None
