"""Numbers in text: what `float` says, NaN where it says nothing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from indexer.formats.numbers import as_number, parse_lines, parse_numbers


@pytest.mark.parametrize(
    "text",
    [
        "1 -2.5 +3. .5 -.25",
        "0.016666666666666666 1e-3 -1E+2",
        "123456789012345678901 0.1 7",
        "1\t2\n3\r\n4 5",
        "-0.0 000.125 1234567.890123",
        "",
        "  \n ",
    ],
)
def test_numbers_are_exactly_what_float_says(text: str) -> None:
    assert parse_lines(text.encode()).values.tolist() == [float(word) for word in text.split()]


@pytest.mark.parametrize("decimals", [0, 1, 6, 8, 9, 12, 17, None])
@pytest.mark.parametrize("size", [1e-6, 1, 3e2, 1e7, 1e12])
def test_random_numbers_are_exactly_what_float_says(decimals: int | None, size: float) -> None:
    rng = np.random.default_rng(0)
    words = [f"{v:.{rng.integers(10) if decimals is None else decimals}f}" for v in rng.normal(0, size, 500)]
    # Beyond fifteen digits the last one of a float may differ.
    np.testing.assert_allclose(parse_lines(" ".join(words).encode()).values, [float(w) for w in words], rtol=3e-16)
    if decimals is not None and decimals < 3:
        assert parse_lines(" ".join(words).encode()).values.tolist() == [float(word) for word in words]


@pytest.mark.parametrize("digits", [1, 6, 9, 17])
def test_exponents_are_read(digits: int) -> None:
    rng = np.random.default_rng(0)
    words = [f"{v:.{digits}g}" for v in rng.normal(0, 1, 500) * 10.0 ** rng.integers(-320, 300, 500)]
    words += ["0e400", "1e-400", "-3.18055e-015", "5e+07"]
    np.testing.assert_allclose(parse_lines(" ".join(words).encode()).values, [float(w) for w in words], rtol=4e-16)


@pytest.mark.parametrize("word", ["2-3", "1.2.3", "-", "abc", ".", "-.", "+-3", "0x10", "1_000", "e5", "1e", "1e5e5"])
def test_what_is_no_number_is_nan_and_named(word: str) -> None:
    numbers = parse_lines(f"1 2.5 {word} 4".encode())
    assert np.isnan(numbers.values).tolist() == [False, False, True, False]
    assert numbers.wrong == word
    assert np.isnan(parse_lines(f"1.25 {word}".encode()).values).tolist() == [False, True]
    with pytest.raises(ValueError, match="is no number"):
        parse_numbers(f"1, {word}".encode())


@given(st.lists(st.text("0123456789.-+eE", min_size=1, max_size=20), max_size=50))
@settings(max_examples=200, deadline=None, derandomize=True)
def test_any_word_is_what_float_says(words: list[str]) -> None:
    expected = [as_number(word.encode()) for word in words]
    np.testing.assert_allclose(parse_lines(" ".join(words).encode()).values, expected, rtol=4e-16, atol=1e-300)


def test_long_texts_are_read_across_their_blocks() -> None:
    words = [f"{k}.{k % 7}" for k in range(100_000)]
    numbers = parse_lines("\n".join(words).encode())
    assert numbers.values.tolist() == [float(word) for word in words]
    assert (numbers.per_line() == 1).all()


def test_lines_are_counted_whatever_ends_them() -> None:
    for end in ("\n", "\r\n", "\r", "\n\n \n"):
        assert parse_lines(end.join(["1 2 3", "4", "5 6"]).encode()).per_line().tolist() == [3, 1, 2]


def test_a_word_longer_than_any_number_is_refused() -> None:
    with pytest.raises(ValueError, match="longer than"):
        parse_lines(b"1 " + b"1" * 1000)
    with pytest.raises(ValueError, match="longer than"):
        parse_lines(b"1" * 1_000_000)
