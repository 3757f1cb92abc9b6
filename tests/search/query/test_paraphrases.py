"""Paraphrases of a query: the query first, then its verb in other forms."""

from __future__ import annotations

import pytest

from search.query.paraphrases import paraphrases


def test_a_query_comes_first_among_its_wordings() -> None:
    words = paraphrases("A person walks backwards.")
    assert words[0] == "A person walks backwards."
    assert "walking backwards" in words
    assert len(words) == 3
    assert "a person turns right" in paraphrases("turn right")


@pytest.mark.parametrize("query", ["", "   ", "Rechnung für März", "歩く", "0x3f", "a " * 500])
def test_any_query_can_be_worded(query: str) -> None:
    assert paraphrases(query)[0] == query
