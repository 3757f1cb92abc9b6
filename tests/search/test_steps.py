"""Steps: how sentences divide, and how steps are found in order."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from encoders.errors import QueryError
from search.moments.sequences import best_chain, candidates, refine_chain
from search.query.question import Question
from search.query.steps import GAP_COST, LARGEST_GAP_COST, in_order, split
from search.spans import iou
from tests.search.fakes import FPS, MeanEncoder, query, take


@pytest.mark.parametrize(
    ("sentence", "steps"),
    [
        ("walks forward, then sits down, then waves", ["walks forward", "sits down", "waves"]),
        ("A person walks then sits down and then waves", ["A person walks", "A person sits down", "A person waves"]),
        ("a man walks, turns around, then sits", ["a man walks", "a man turns around", "a man sits"]),
        ("after running, he jumps", ["he is running", "he jumps"]),
        ("jumps before sitting down", ["jumps", "sitting down"]),
        ("walks, followed by a jump", ["walks", "a jump"]),
        ("stretches; bows; finally jumps", ["stretches", "bows", "jumps"]),
        ("the woman is walking. Then she stops.", ["the woman is walking", "she stops"]),
        ("walks slowly, carefully", ["walks slowly, carefully"]),
        ("walks slowly, as on ice, then sits", ["walks slowly, as on ice", "sits"]),
        ("walks, arms stretched out, steps aside, then sits", ["walks, arms stretched out", "steps aside", "sits"]),
        ("a person waves", ["a person waves"]),
        ("walks and then", ["walks"]),
    ],
)
def test_sentences_divide_at_words_of_order(sentence: str, steps: list[str]) -> None:
    assert split(sentence) == steps


def test_a_question_says_how_its_sentences_go_together() -> None:
    assert Question.of("a person waves").how == "alone"
    assert Question.of("walks, then sits") == Question(("walks", "sits"), "then")
    assert Question.of("walks, then sits", split_steps=False).how == "alone"
    assert Question.of(None, ["walks", "sits"]).sentences == ("walks", "sits")
    assert Question.of("walks", meanwhile=["waves"]) == Question(("walks", "waves"), "while")


@pytest.mark.parametrize("sentence", ["", "  ", "?!", None])
def test_an_empty_question_cannot_be_asked(sentence: str | None) -> None:
    with pytest.raises(QueryError, match="empty"):
        Question.of(sentence)


def test_the_chain_is_the_best_of_all_that_keep_the_order() -> None:
    rng = np.random.default_rng(1)
    starts = rng.uniform(0, 10, 24)
    ends = starts + rng.uniform(0.5, 3, 24)
    scores = rng.normal(size=(3, 24))

    def value(chain: tuple[int, ...]) -> float:
        gaps = (starts[b] - ends[a] for a, b in itertools.pairwise(chain))
        cost = sum(min(GAP_COST * gap, LARGEST_GAP_COST) for gap in gaps)
        return float(sum(scores[step, i] for step, i in enumerate(chain)) - cost)

    legal = [
        chain
        for chain in itertools.permutations(range(24), 3)
        if all(ends[a] <= starts[b] for a, b in itertools.pairwise(chain))
    ]
    found = in_order(starts, ends, scores)
    assert found is not None
    assert tuple(found[0]) == max(legal, key=value)
    assert found[1] == pytest.approx(max(map(value, legal)))


def test_no_chain_where_no_window_follows_another() -> None:
    assert in_order(np.array([0.0, 1.0]), np.array([5.0, 6.0]), np.ones((2, 2))) is None


def test_steps_are_found_in_order_even_where_each_alone_fits_better_elsewhere() -> None:
    features = take(60, (5, 8, 2), (20, 23, 1), (24, 27, 2), (27.5, 31, 3), (50, 53, 3))
    features[50:80, 2] += 1  # the second step is clearest before the first
    chain = best_chain(candidates(MeanEncoder(), features, FPS, query(1, 2, 3)))
    chain = refine_chain(MeanEncoder(), lambda start, end: (features, 0.0), FPS, query(1, 2, 3), chain, [0.0] * 3)
    truth = [(20, 23), (24, 27), (27.5, 31)]
    assert all(iou([m.start], [m.end], a, b)[0] > 0.7 for m, (a, b) in zip(chain, truth, strict=True))
    assert all(before.end <= after.start for before, after in itertools.pairwise(chain))


def test_no_chain_in_a_take_too_short_for_it() -> None:
    assert best_chain(candidates(MeanEncoder(), take(1.2), FPS, query(1, 2, 3))) == []
