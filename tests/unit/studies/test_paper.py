"""The figures of the paper: their runs, comparisons with stated numbers, and one of them from the command line."""

from __future__ import annotations

import csv
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mpmcol.case import load_case
from mpmcol.case.values import leaf_values
from mpmcol.experiments import find_experiment
from mpmcol.measure import FRONTS
from mpmcol.studies.paper import FIGURES, PaperStudy, factors, fig5, fig6, fig7, fig8, fig9
from mpmcol.studies.paper.report import Comparison, FigureResult, error_summary, markdown, rounded_csv, series_row
from mpmcol.studies.runs import CompletedRun, StudyRun
from tests.support.cli import invoke

PAPER = Path(__file__).parents[3] / "scripts" / "paper"


def completed(a: float, h: float, zeta: float, beta: float = 0.5) -> CompletedRun:
    """A run with these results."""
    experiment = find_experiment("paper", "plane")
    laws = {f"law.{name}": (experiment.expected(name, a) or (None,))[0] for name in ("zeta", "beta")}
    row: dict[str, Any] = {
        "a": a, "spacing_used": h, "column_points": 100, "beta": beta, "spread": 0.0, "at_rest": True, "steps": 10,
        "seconds": 1.0,
        **{f"zeta.{front}": zeta for front in FRONTS}, **laws,
    }  # fmt: skip
    return CompletedRun(row, Path("nowhere"))


def test_errors_are_relative_to_the_law_within_its_range() -> None:
    row = series_row([completed(1.0, 0.002, 1.52)], completed(1.0, 0.002, 1.52))
    assert row["zeta.front_max error"] == pytest.approx(1.52 / 1.6 - 1.0)
    assert row["zeta.front_max converged"] is None and row["zeta.front_max converged error"] is None
    assert series_row([completed(2.0, 0.002, 3.1)], completed(2.0, 0.002, 3.1))["zeta.front_max error"] is None


def test_the_summary_is_of_absolute_errors() -> None:
    rows = [series_row([run], run) for run in (completed(1.0, 0.002, 1.6 * 1.02), completed(1.5, 0.002, 2.4 * 0.94))]
    mean, largest = error_summary(rows, "zeta.front_max", "channel", 0.036, 0.05)
    assert mean.computed == pytest.approx(0.04) and mean.is_met is False
    assert largest.computed == pytest.approx(0.06) and largest.comment == "a = 1.5" and largest.is_met is False
    (only,) = error_summary(rows, "zeta.front_max", "channel", 0.05)
    assert only.is_met is True


def test_a_comparison_is_formatted_in_one_line() -> None:
    assert str(Comparison("mean |error|", 0.034, 0.036, 0.036)) == "mean |error|: 3.4 %; paper 3.6 %; met"
    assert str(Comparison("mean |error|", 0.04, 0.036, 0.036)) == "mean |error|: 4.0 %; paper 3.6 %; missed"
    assert (
        str(Comparison("undisturbed radius", None, unit="mm", comment="eroded")) == "undisturbed radius: none; eroded"
    )


def test_tables_have_all_rows() -> None:
    rows = [{"a": 1.0, "zeta": 1.23456789, "law": None}]
    result = FigureResult(rows, [Comparison("n", 2.0, unit="")], {"x.png": print})
    assert rounded_csv(rows) == "a,zeta,law\n1,1.23457,\n"
    assert rounded_csv([{"a": 1, "at_rest": False}]) == "a,at_rest\n1,false\n"
    text = markdown(result, "Title", "heading")
    assert "* n: 2\n" in text and "| 1 | 1.235 |  |" in text and "![x](x.png)" in text


@pytest.mark.parametrize("quick", [True, False])
@pytest.mark.parametrize("name", FIGURES)
def test_every_run_of_every_figure_is_a_valid_case(name: str, quick: bool, tmp_path: Path) -> None:
    runs = FIGURES[name].runs(quick)
    folders = {run.plan(tmp_path).folder for run in runs}
    assert len(folders) == len(set(runs)) == len(runs)


def test_figures_share_runs() -> None:
    for quick in (True, False):
        assert set(fig7.runs(quick)) <= set(fig6.runs(quick))
        assert set(fig9.runs(quick)) <= set(fig8.runs(quick))
    assert set(fig5.runs(False)) & set(fig6.runs(False))  # a = 1 at 6, 3 and 2 mm


def test_every_factor_changes_the_case(tmp_path: Path) -> None:
    softening = ("lube-channel-dense", 1.0, 0.0045)
    cases = [
        factors.repeated_runs(column, factor)[0].plan(tmp_path).case
        for column in (factors.QUICK[0], softening)
        for factor in factors.factors_of(column)
    ]
    assert all(one != other for i, one in enumerate(cases) for other in cases[:i])


def test_the_error_of_a_change_includes_those_of_both_means() -> None:
    base = [completed(0.9, 0.01, zeta) for zeta in (1.0, 1.02, 0.98, 1.0)]
    changed = [completed(0.9, 0.01, zeta) for zeta in (1.1, 1.12, 1.08, 1.1)]
    row = factors.effect_row(("lube-cylinder", 0.9, 0.01), "factor", changed, base)
    single = np.std([1.0, 1.02, 0.98, 1.0], ddof=1) / 2.0
    assert row["zeta.front_max change"] == pytest.approx(0.1)
    assert row["zeta.front_max change +-"] == pytest.approx(np.hypot(single / 1.0, single / 1.1))
    assert factors.effect_row(("c", 1.0, 1.0), "factor", [], base)["beta change"] is None


@pytest.mark.parametrize("folder", ["", "filtered"])
def test_the_effects_in_the_documentation_are_those_computed(folder: str) -> None:
    with (PAPER / folder / "factors.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["factor"] != factors.UNCHANGED]
    documented = (PAPER / "README.md").read_text().splitlines()
    lines: dict[tuple[bool, str], list[str]] = defaultdict(list)
    for row in rows:
        lines["-" in row["case"], row["factor"]].append(effect_cell(row))
    missing = [
        line for key, cells in lines.items() if (line := f"| {' | '.join([key[1], *cells])} |") not in documented
    ]
    assert len(lines) >= len(factors.FACTORS) - 1 and not missing


@pytest.mark.parametrize(
    ("row", "figure", "series"),
    [
        ("runout in the channel, Mohr-Coulomb", "fig6", "Mohr-Coulomb, zeta.front_height"),
        ("the same, loose sand", "fig6", "loose, zeta.front_height"),
        ("runout of cylinders, axisymmetric", "fig8", "axisymmetric, zeta.front_height"),
        ("final height of cylinders, axisymmetric", "fig8", "axisymmetric, beta"),
    ],
)
def test_the_errors_in_the_readme_are_those_of_the_figures(row: str, figure: str, series: str) -> None:
    def errors(folder: str) -> str:
        lines = (PAPER / folder / f"{figure}.md").read_text().splitlines()
        means = [line.partition("mean |error|: ") for line in lines if line.startswith(f"* {series}, ")]
        found = [text.partition(";")[0] for _, name, text in means if name]
        return f"{found[0]}; {found[-1]}"

    (line,) = [one for one in (PAPER.parents[1] / "README.md").read_text().splitlines() if one.startswith(f"| {row} |")]
    assert line.startswith(f"| {row} | {errors('')} | {errors('filtered')} |")


def effect_cell(row: Mapping[str, str]) -> str:
    """An effect as the documentation gives it: zeta, its standard error and beta, per cent."""
    if row["runs"] == "0":
        return "diverges (0 of 4 end)"
    names = ("zeta.front_height change", "zeta.front_height change +-", "beta change")
    zeta, error, beta = (100.0 * float(row[name]) for name in names)
    return f"{zeta:+.1f} +- {error:.1f}, {beta:+.1f}"


def test_failed_runs_are_left_out() -> None:
    for figure in FIGURES.values():
        result = figure.evaluate({}, True)
        assert not any(comparison.computed for comparison in result.comparisons)
    run = StudyRun("lube-channel", 1.0, 0.006)
    result = fig6.evaluate({run: completed(1.0, 0.006, 1.5)}, True)
    assert [row["zeta.front_max"] for row in result.rows] == [1.5]


def test_figures_with_the_stress_filter_are_of_the_same_columns() -> None:
    """Of the cases that differ in `method.stress_filter` alone."""
    plain, filtered = (PaperStudy(list(FIGURES), quick=False, filtered=filtered) for filtered in (False, True))
    for one, other in zip(plain.runs(), filtered.runs(), strict=True):
        assert one == replace(other, case=one.case)
    for name in {run.case for run in plain.runs()}:
        values, others = (leaf_values(load_case(case)) for case in (name, name.removeprefix("lube-")))
        assert {key for key in values if values[key] != others[key]} == {"method.stress_filter", "title"}
    run = StudyRun("channel", 1.0, 0.006)
    ended = SimpleNamespace(completed={run: completed(1.0, 0.006, 1.5)})
    result = PaperStudy(["fig6"], quick=True, filtered=True).evaluate(ended)["fig6"]
    assert [row["zeta.front_max"] for row in result.rows] == [1.5]


def test_all_cases_with_the_stress_filter_are_valid(tmp_path: Path) -> None:
    for run in dict.fromkeys(PaperStudy(list(FIGURES), quick=False, filtered=True).runs()):
        run.plan(tmp_path)


def test_an_unknown_figure_is_refused() -> None:
    result = invoke("paper", "fig4")
    assert result.exit_code == 2 and "'fig4'" in result.output and "fig5" in result.output


def test_a_figure_from_the_command_line(tmp_path: Path) -> None:
    """Figure 9, quick: of two cylinders that of a = 0.55 keeps a flat top and that of 0.9 does not, as measured."""
    out = tmp_path / "figures"
    result = invoke("paper", "fig9", "--quick", "--out", out)
    assert result.exit_code == 0, result.output
    with (out / "fig9.csv").open(newline="") as file:
        rows = {float(row["a"]): row for row in csv.DictReader(file)}
    assert 30.0 < float(rows[0.55]["undisturbed_mm"]) < 45.0 and float(rows[0.9]["undisturbed_mm"]) == 0.0
    assert (out / "fig9-top-a0.55.png").stat().st_size > 10_000
    assert "Figure 9" in (out / "fig9.md").read_text() and (out / "environment.json").exists()
    again = invoke("paper", "fig9", "--quick", "--out", out, "--json")
    assert again.exit_code == 0 and "nothing to run" in again.output
