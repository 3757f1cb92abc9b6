"""Tables of moment retrieval in Markdown."""

from __future__ import annotations

from search.evaluate.moment_metrics import Overlaps
from search.evaluate.moment_tables import moment_tables


def test_first_answers_recall_and_steps_have_a_table_each() -> None:
    exact = Overlaps()
    exact.add([(0.0, 2.0)], [(0.0, 2.0)])
    figures = {
        "motionseek": exact.figures(),
        "window of 20": exact.figures(),
        "three steps in order": {"questions": 1.0, "all at 0.3": 100.0},
    }
    first, recall, steps = moment_tables(figures)
    assert first.splitlines()[0].startswith("| first answer, by IoU | questions | 0.1 |")
    assert "| window of 20 | 1 | 100.0 |" in first
    assert recall.splitlines()[-1].startswith("| motionseek | 100.0 |"), "baselines have one answer each"
    assert steps.splitlines()[-1] == "| three steps in order | 1 | 100.0 |"
