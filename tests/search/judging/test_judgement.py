"""A whole judgement, by an evaluator whose vectors are known: every figure, the real motions' own, what is missing."""

import numpy as np
import pytest

from encoders.errors import QueryError
from search.judging.figure_kinds import FIGURES
from search.judging.judgement import judge
from search.judging.judgement_tables import csv_rows, figure_rows, latex_rows, remarks
from search.judging.motion_table import paired
from tests.search.judging.evaluator import WristEncoder, raising

REAL = [raising("stand", 0.0), raising("raise", 0.5), raising("high", 1.0)]
MADE = [
    raising("a", 0.0, text="stands", label="stands", reference="stand", transitions=(20,)),
    raising("b", 0.2, text="raises a hand", label="raises a hand", reference="raise", transitions=(20,)),
    raising("c", 0.6, text="raises a hand", label="raises a hand", reference="raise", transitions=(20,)),
    raising("d", 1.0, text="raises it high", label="raises it high", reference="high", transitions=(20,)),
]


def test_every_figure_of_motions_that_all_is_known_of() -> None:
    found = judge([MADE], REAL, WristEncoder(), repeats=3)
    made, real = ({name: one.value for name, one in row.items()} for row in (found.generated, found.real))
    scores = [0.5 + 0.5 * np.cos(angle) for angle in (0, 0.3, 0.1, 0)]
    assert made["score_text"] == made["score_motion"] == pytest.approx(np.mean(scores))
    assert made["text_distance"] == pytest.approx(np.mean([0, 2 * np.sin(0.15), 2 * np.sin(0.05), 0]))
    # "b" is nearer to standing.
    assert [made[f"precision_{k}"] for k in (1, 2)] == [75.0, 100.0]
    assert [made[f"accuracy_{k}"] for k in (1, 5)] == [75.0, 100.0]
    assert made["multimodality_text"] == pytest.approx(2 * np.sin(0.2))
    assert made["ape_root"] == made["ave_root"] == pytest.approx(0, abs=1e-6)
    # The wrist is off by 0.3 and 0.1 at the ends, half of it on average; one joint of 22.
    assert made["ape_global"] == pytest.approx((0.15 + 0.05) / 4 / 22, rel=1e-4)
    # The best of "b" and "c".
    assert made["displacement"] == pytest.approx(0.05, rel=1e-4)
    assert made["futures"] == pytest.approx(0.2, rel=1e-4)
    assert made["transition"] == pytest.approx(100 * np.mean([0, 0.2, 0.6, 1.0]) / 40 / 22, rel=1e-4)
    assert real["transition"] == pytest.approx(100 * np.mean([0, 0.5, 1.0]) / 40 / 22, rel=1e-4)
    assert (real["score_text"], real["score_motion"], real["accuracy_1"], real["ape_local"]) == (1.0, 1.0, 100.0, 0.0)
    assert made["skate"] == made["skating"] == made["penetration"] == 0.0
    assert found.missing["precision32_1"] == "4 pairs are fewer than one batch of 32"
    assert found.missing["sliding_frechet"] == "all motions are shorter than 80 frames"
    assert found.generated.keys() | found.missing.keys() == FIGURES.keys()
    assert not found.generated.keys() & found.missing.keys()


def test_long_motions_have_windows_and_short_ones_are_named() -> None:
    long = [raising(str(i), 0.2 * i, frames=200, transitions=(100,)) for i in range(6)]
    found = judge([[*long, raising("short", 0.0, reference="0", transitions=(20,))]], long, WristEncoder(), repeats=2)
    assert {name for name in FIGURES if name.startswith(("sliding", "transition"))} <= found.generated.keys()
    assert found.generated["transition_frechet"].value == pytest.approx(0, abs=1e-9)
    assert found.generated["sliding_frechet"].value == pytest.approx(0, abs=1e-9)
    assert found.short == ["short"]
    assert any("1 shorter motions (short)" in line for line in remarks(found))


def test_intervals_are_over_draws_of_one_set_or_over_sets() -> None:
    one = judge([MADE], REAL, WristEncoder(), repeats=5)
    assert np.isnan(one.generated["score_text"].interval)
    assert one.generated["diversity"].repeats == 5
    other = [raising(m.name, 0.0, text=m.text, label=m.label, reference=m.reference) for m in MADE]
    two = judge([MADE, other], REAL, WristEncoder())
    scores = one.generated["score_text"].value, judge([other], REAL, WristEncoder()).generated["score_text"].value
    assert two.generated["score_text"].value == pytest.approx(np.mean(scores))
    assert two.generated["score_text"].interval == pytest.approx(1.96 * abs(scores[0] - scores[1]) / 2)
    assert "transition" in two.missing  # the second set states none


def test_motions_alone_have_a_few_figures_and_reasons_for_the_rest() -> None:
    found = judge([[raising("a", 0.1), raising("b", 0.2)]], None, WristEncoder(), repeats=2)
    assert set(found.generated) == {"diversity", "skate", "skating", "penetration"}
    assert {found.missing[name] for name in ("score_text", "frechet", "accuracy_1")} == {
        "no texts", "no references", "no labels",
    }  # fmt: skip
    assert any("no row of real motions" in line for line in remarks(found))


def test_rows_name_unit_aim_evaluator_and_source() -> None:
    found = judge([MADE], REAL, WristEncoder(), repeats=2)
    columns, rows = figure_rows(found)
    assert dict(zip(columns, rows[0], strict=True)) == {
        "figure": "TMR-score, motion to text (0..1)", "better": "higher", "generated": "0.994", "real": "1.000",
    }  # fmt: skip
    columns, rows = csv_rows(found)
    assert dict(zip(columns, rows[0], strict=True))["evaluator"] == "wrist (0123456789ab)"
    assert all("20" in row[columns.index("source")] for row in rows)
    columns, rows = latex_rows(found)
    assert [row[0] for row in rows] == ["real", "generated"]
    assert {len(row) for row in rows} == {len(columns)}


def test_some_motions_without_a_reference_are_refused_and_all_without_are_no_pairs() -> None:
    assert paired(MADE, REAL) == [0, 1, 1, 2]
    assert paired([raising("raise", 0.1)], REAL) == [1]
    assert paired([raising("x", 0.1), raising("y", 0.1)], REAL) is None
    with pytest.raises(QueryError, match=r"no reference for 1 \(x\) of 2 motions"):
        paired([raising("x", 0.1), raising("raise", 0.1)], REAL)
    with pytest.raises(QueryError, match="its reference gone is not among the 3"):
        paired([raising("x", 0.1, reference="gone")], REAL)


def test_a_label_that_is_not_among_the_labels_is_refused() -> None:
    with pytest.raises(QueryError, match="'raises it high' is asked for"):
        judge([MADE], None, WristEncoder(), labels=["stands", "raises a hand"])
