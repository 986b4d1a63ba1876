"""The statement of accuracy: parts and intervals in closed form, and what is not known is stated."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from math import hypot
from pathlib import Path
from statistics import NormalDist
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mpmcol.case import load_case
from mpmcol.errors import OutputError
from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.model_error import ModelError
from mpmcol.studies.pareto import recommend
from mpmcol.studies.pareto.certify import error_bar
from mpmcol.studies.pareto.error_interval import ErrorInterval
from mpmcol.studies.pareto.recommend import Difference, Recommendation
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.shipped import ColumnParameters, converged_values
from mpmcol.studies.statement import make_statement
from mpmcol.studies.statement_text import corrected_values, statement_lines, stored_lines, write_statement

ROOT = Path(__file__).parents[3]
Z90 = 1.645
INTERVALS = {ZETA: ErrorInterval(-0.1, -0.04), BETA: ErrorInterval(-0.03, 0.01)}
CASES, COLUMN = ["channel, a = 1"], ColumnParameters("plane", 1.0, 33.0)
ADVICE = Recommendation("light", 28.0, 28.0, {}, {ZETA: 0.1, BETA: 0.03}, CASES, COLUMN, 1.0, [])


@pytest.fixture(autouse=True)
def study(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recommend, "error_intervals", lambda *_: INTERVALS)


def stated(
    *overrides: str, zeta: float = 1.5, advice: Recommendation = ADVICE, at_rest: bool = True, bars: Sequence[Any] = ()
) -> dict[str, Any]:
    """The statement of a run of a channel with this result."""
    case = load_case("channel", ["geometry.aspect=1", *overrides])
    geometry, beta = case.geometry, 0.9
    summary: dict[str, Any] = {
        "front": {"front_height": geometry.r_i * (1.0 + zeta)}, "zeta": {"front_height": zeta},
        "height": beta * geometry.h_i, "beta": beta, "at_rest": at_rest,
    }  # fmt: skip
    results: Any = SimpleNamespace(case=case, summary=summary)
    return make_statement(results, advice, 0.05, bars)


def ends(interval: dict[str, float]) -> tuple[float, float]:
    return interval["low"], interval["high"]


def test_finer_grids_differ_by_the_error_and_experiments_by_that_of_the_model_too() -> None:
    """Two experiments fit; the interval is that of the one from which the model differs more."""
    record = stated()
    zeta, converged = record["zeta"], converged_values()["channel, a = 1"][ZETA]
    low, high = 1.5 / 0.96, 1.5 / 0.9
    assert ends(zeta["finer_grids"]) == pytest.approx((low, high))
    assert [one["difference"] for one in zeta["experiments"]] == pytest.approx(
        [converged / 1.6 - 1.0, converged / 1.2 - 1.0]
    )
    model = (1.0 - 1.2 / converged) + Z90 * 0.1 * 1.2 / converged
    middle = 0.5 * (low + high)
    whole = hypot(0.5 * (high - low), model * middle)
    assert ends(zeta["experiment"]) == pytest.approx((middle - whole, middle + whole))
    radius = load_case("channel").geometry.r_i
    assert zeta["finer_grids"]["low_length"] == pytest.approx(radius * zeta["finer_grids"]["low"])
    assert zeta["length"] == pytest.approx(1.5 * radius) and record["beta"]["length"] == pytest.approx(0.9 * radius)
    assert zeta["error"] == {"low": -0.1, "high": -0.04}
    assert zeta["grid"] == pytest.approx(0.5 * (high - low) / middle)


@pytest.mark.parametrize("error", [-0.3, -0.05, 0.05, 0.3])
def test_the_interval_reaches_the_converged_value(monkeypatch: pytest.MonkeyPatch, error: float) -> None:
    """The errors of the study are relative to the converged value, 1.5 here."""
    intervals = dict.fromkeys((ZETA, BETA), ErrorInterval(error - 0.01, error + 0.01))
    monkeypatch.setattr(recommend, "error_intervals", lambda *_: intervals)
    interval = stated(zeta=1.5 * (1.0 + error))["zeta"]["finer_grids"]
    assert interval["low"] < 1.5 < interval["high"]
    assert interval["high"] - interval["low"] == pytest.approx(1.5 * 0.02 / (1.0 + error), rel=1e-2)


@pytest.mark.parametrize("difference", [-0.5, -0.1, 0.0, 0.05, 0.2, 1.0])
def test_the_part_of_the_model_holds_nine_of_ten_experiments(difference: float) -> None:
    """At least; a normal distribution about a value from which the model differs."""
    expected = 1.0 / (1.0 + difference)  # the model computes 1
    experiments = expected * (1.0 + 0.1 * np.random.default_rng(1).standard_normal(20000))
    part = ModelError("", 1.0, 0.1, difference).part
    assert part is not None and 0.89 < np.mean(np.abs(experiments - 1.0) <= part) < 0.96


def test_a_difference_that_is_not_known_gives_no_interval(monkeypatch: pytest.MonkeyPatch) -> None:
    """A column of a friction that the experiments have, beside cases of the study that none of them has."""
    record = stated(advice=replace(ADVICE, cases=["channel, a = 1, 42 degrees"]))
    zeta = record["zeta"]
    assert zeta["experiment"] is None and zeta["model"] is None
    assert "no column to compare with Lube et al. 2007, Lube et al. 2005: the error of the model" in zeta["reason"]
    assert "finer_grids" in zeta and f"  experiments: no interval; {zeta['reason']}" in statement_lines(record)
    both = ["channel, a = 1, 42 degrees", "channel, a = 1"]
    assert stated(advice=replace(ADVICE, cases=both))["zeta"] == stated()["zeta"]


def test_the_widest_difference_of_the_neighbouring_cases_counts() -> None:
    cases = ["channel, a = 1", "channel, a = 3"]
    found = stated("geometry.aspect=1.5", advice=replace(ADVICE, cases=cases))["zeta"]["experiments"][0]
    assert found["expected"] == pytest.approx(2.4)
    assert found["difference"] == pytest.approx(converged_values()["channel, a = 3"][ZETA] / 4.576 - 1.0, abs=1e-3)


@pytest.mark.parametrize(
    ("overrides", "at_rest", "reason"),
    [
        (("material.friction_deg=45",), True, "for friction of 28 to 40 deg; here it is 45 deg"),
        (("geometry.aspect=30",), True, "no law for a >= 20"),
        ((), False, "still moved at the end"),
    ],
)
def test_without_an_experiment_the_reason_is_given(overrides: tuple[str, ...], at_rest: bool, reason: str) -> None:
    record = stated(*overrides, at_rest=at_rest)
    for name in ("zeta", "beta"):
        assert record[name]["experiment"] is None and reason in record[name]["reason"]
        assert record[name]["finer_grids"]["high"] > record[name]["value"]
    assert sum(reason in line for line in statement_lines(record)) == 2


def test_a_quantity_without_a_law_at_this_aspect_ratio_has_its_gap() -> None:
    cylinder = replace(ADVICE, cases=["cylinder, a = 0.9"])
    record = stated("geometry.model=axisymmetric", "geometry.aspect=1.3", advice=cylinder)
    assert record["zeta"]["experiment"] and record["beta"]["reason"] == "Lube et al. 2004: no law for 1 <= a < 1.7"


def test_settings_outside_the_study_are_stated() -> None:
    outside = replace(ADVICE, differences=[Difference("a", "10", "1 to 3")])
    assert statement_lines(stated(advice=outside))[-1].endswith(
        "outside the study, intervals may be too narrow: a = 10, in the study 1 to 3"
    )
    assert "outside" not in statement_lines(stated())[-1]


def test_error_bars_replace_the_bound_of_the_study() -> None:
    bars = [error_bar(quantity, {cells: 1.6 - 2.0 / cells for cells in (14, 20, 28)}) for quantity in (ZETA, BETA)]
    record = stated(bars=bars)
    assert (record["source"], record["cells"]) == ("several spacings", 28)
    for bar, name in zip(bars, ("zeta", "beta"), strict=True):
        interval = record[name]["finer_grids"]
        assert (record[name]["value"], record[name]["grid"], record[name]["error"]) == (bar.value, bar.relative, None)
        assert (interval["low"], interval["high"]) == pytest.approx((bar.value - bar.error, bar.value + bar.error))
    lines = statement_lines(record)
    assert "error bars of runs up to r_i/h = 28, values extrapolated" in lines[-1]
    assert f"error bar {record['zeta']['grid']:.1%}" in lines[0]


def test_the_statement_in_words() -> None:
    lines = statement_lines(stated())
    assert len(lines) == 5
    assert lines[0] == (
        "runout 135 mm, zeta = 1.500; finer grids: 1.562 to 1.667 (140.6 to 150 mm), error of this one -10.0% to -4.0%"
    )
    assert lines[1].startswith("  experiments: 0.9") and lines[1].endswith(
        "and model 38.6% (grid-converged +2.0% against Lube et al. 2007, scatter 10%; +36.0% against Lube et al. 2005, "
        "scatter 10%)"
    )
    assert "Lube et al. 2007 (unverified), scatter 5%" in lines[3]
    assert lines[4] == ('confidence 90%; grid: errors of "light" at r_i/h = 28 in the study (channel, a = 1)')


def test_the_stored_statement_is_the_same_and_is_written_once(tmp_path: Path) -> None:
    assert stored_lines(tmp_path) == []
    record, path = stated(), tmp_path / "accuracy.json"
    write_statement(tmp_path, record)
    assert stored_lines(tmp_path) == statement_lines(record)
    before = path.stat().st_ino
    write_statement(tmp_path, record)
    assert path.stat().st_ino == before
    assert corrected_values(tmp_path) == {}
    write_statement(tmp_path, record | {"corrected": True})
    ends = record["zeta"]["finer_grids"]
    assert corrected_values(tmp_path)["zeta"] == pytest.approx((0.14529, 0.5 * (ends["low"] + ends["high"])), rel=1e-3)
    for damaged in ("{", "[]", "{}", path.read_text().replace('"error"', '"eror"')):
        path.write_text(damaged)
        with pytest.raises(OutputError, match=r"accuracy.json is damaged .*; repeat the command of the run"):
            stored_lines(tmp_path)


def test_the_converged_values_are_those_of_the_report() -> None:
    text = (ROOT / "scripts" / "pareto" / "pareto.md").read_text()
    for case, values in converged_values().items():
        for quantity, value in values.items():
            (shown,) = re.findall(rf"^\| {re.escape(case)} \| {re.escape(quantity)} \| (\S+) \+-", text, re.MULTILINE)
            assert float(f"{value:.4g}") == float(shown)
    assert len(converged_values()) == 12


def test_intervals_are_of_90_percent() -> None:
    assert NORMAL_90 == Z90 == pytest.approx(NormalDist().inv_cdf(0.95), rel=1e-3)
