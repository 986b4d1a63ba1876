"""The figures of the paper: their runs, the judgement of numbers, and one of them from the command line."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from mpmcol.cli import main as cli
from mpmcol.experiments import find_experiment
from mpmcol.measure import FRONTS
from mpmcol.studies.paper import FIGURES, factors, fig5, fig6, fig7, fig8, fig9
from mpmcol.studies.paper.errors import compare, extrapolate, summaries
from mpmcol.studies.paper.report import Report, Verdict, csv_text, markdown
from mpmcol.studies.runs import Finished, Member


def finished(a: float, h: float, zeta: float, beta: float = 0.5) -> Finished:
    """A run with these results."""
    experiment = find_experiment("paper", "plane")
    laws = {f"law.{name}": (experiment.expected(name, a) or (None,))[0] for name in ("zeta", "beta")}
    row: dict[str, Any] = {
        "a": a, "spacing_used": h, "column_points": 100, "beta": beta, "spread": 0.0, "steps": 10, "seconds": 1.0,
        **{f"zeta.{front}": zeta for front in FRONTS}, **laws,
    }  # fmt: skip
    return Finished(row, Path("nowhere"))


def test_a_line_is_extrapolated_exactly() -> None:
    limit = extrapolate([3.0, 2.0, 1.0], [1.0 + 0.1 * h for h in (3.0, 2.0, 1.0)])
    assert limit is not None
    assert limit.value == pytest.approx(1.0, rel=1e-12) and limit.error == pytest.approx(0.0, abs=1e-12)


def test_the_error_of_a_limit_is_that_of_its_scatter() -> None:
    """Of many series with normal noise, the limits scatter as the fit says on average."""
    rng, h = np.random.default_rng(1), [3.0, 2.5, 2.0, 1.5, 1.0]
    limits = [extrapolate(h, 2.0 + 0.1 * np.array(h) + 0.05 * rng.normal(size=5)) for _ in range(4000)]
    values = np.array([limit.value for limit in limits if limit])
    variances = np.array([limit.error**2 for limit in limits if limit])
    assert values.mean() == pytest.approx(2.0, abs=0.005)
    assert np.sqrt(variances.mean()) == pytest.approx(values.std(), rel=0.05)


def test_coarse_grids_do_not_bend_the_line() -> None:
    limit = extrapolate([10.0, 3.0, 2.0, 1.0], [0.0, 1.3, 1.2, 1.1])
    assert limit is not None and limit.value == pytest.approx(1.0, rel=1e-12)


def test_two_spacings_have_no_limit() -> None:
    assert extrapolate([2.0, 1.0], [1.0, 1.1]) is None
    assert extrapolate([2.0, 2.0, 1.0], [1.0, 1.0, 1.1]) is None


def test_errors_are_against_the_law_and_only_where_it_holds() -> None:
    line = compare([finished(1.0, 0.002, 1.52)], finished(1.0, 0.002, 1.52))
    assert line["zeta.front_max error"] == pytest.approx(1.52 / 1.6 - 1.0)
    assert line["zeta.front_max limit"] is None and line["zeta.front_max limit error"] is None
    assert compare([finished(2.0, 0.002, 3.1)], finished(2.0, 0.002, 3.1))["zeta.front_max error"] is None


def test_means_and_largest_are_of_the_absolute_errors() -> None:
    lines = [compare([run], run) for run in (finished(1.0, 0.002, 1.6 * 1.02), finished(1.5, 0.002, 2.4 * 0.94))]
    mean, largest = summaries(lines, "zeta.front_max", "channel", 0.036, 0.05)
    assert mean.ours == pytest.approx(0.04) and mean.met is False
    assert largest.ours == pytest.approx(0.06) and largest.comment == "a = 1.5" and largest.met is False
    (only,) = summaries(lines, "zeta.front_max", "channel", 0.05)
    assert only.met is True


def test_a_verdict_reads_like_a_sentence() -> None:
    assert str(Verdict("mean |error|", 0.034, 0.036, 0.036)) == "mean |error|: 3.4 %; paper 3.6 %; met"
    assert str(Verdict("mean |error|", 0.04, 0.036, 0.036)) == "mean |error|: 4.0 %; paper 3.6 %; missed"
    assert str(Verdict("undisturbed radius", None, unit="mm", comment="eroded")) == "undisturbed radius: none; eroded"


def test_tables_hold_all_rows() -> None:
    report = Report([{"a": 1.0, "zeta": 1.23456789, "law": None}], [Verdict("n", 2.0, unit="")], {"x.png": print})
    assert csv_text(report.rows) == "a,zeta,law\n1,1.23457,\n"
    text = markdown(report, "Title", "heading")
    assert "* n: 2\n" in text and "| 1 | 1.235 |  |" in text and "![x.png](x.png)" in text


@pytest.mark.parametrize("quick", [True, False])
@pytest.mark.parametrize("name", FIGURES)
def test_every_run_of_every_figure_can_be_planned(name: str, quick: bool, tmp_path: Path) -> None:
    members = FIGURES[name].members(quick)
    folders = {member.plan(tmp_path).folder for member in members}
    assert len(folders) == len(set(members)) == len(members)


def test_figures_share_runs() -> None:
    for quick in (True, False):
        assert set(fig7.members(quick)) <= set(fig6.members(quick))
        assert set(fig9.members(quick)) <= set(fig8.members(quick))
    assert set(fig5.members(False)) & set(fig6.members(False))  # a = 1 at 6, 3 and 2 mm


def test_every_factor_changes_the_case(tmp_path: Path) -> None:
    softening = ("lube-channel-dense", 1.0, 0.0045)
    cases = [
        factors._member(column, factor, "0.5").plan(tmp_path).case
        for column in (factors.QUICK[0], softening)
        for factor in factors._factors(column)
    ]
    assert all(one != other for i, one in enumerate(cases) for other in cases[:i])


def test_changes_carry_the_error_of_both_means() -> None:
    base = [finished(0.9, 0.01, zeta) for zeta in (1.0, 1.02, 0.98, 1.0)]
    factor = [finished(0.9, 0.01, zeta) for zeta in (1.1, 1.12, 1.08, 1.1)]
    line = factors._line(("lube-cylinder", 0.9, 0.01), "factor", factor, base)
    single = np.std([1.0, 1.02, 0.98, 1.0], ddof=1) / 2.0
    assert line["zeta.front_max change"] == pytest.approx(0.1)
    assert line["zeta.front_max change +-"] == pytest.approx(np.hypot(single / 1.0, single / 1.1))
    assert factors._line(("c", 1.0, 1.0), "factor", [], base)["beta change"] is None


def test_runs_that_failed_are_left_out() -> None:
    """Reports are made of what there is."""
    for figure in FIGURES.values():
        report = figure.report({}, True)
        assert not any(verdict.ours for verdict in report.verdicts)
    kept = Member("lube-channel", 1.0, 0.006)
    report = fig6.report({kept: finished(1.0, 0.006, 1.5)}, True)
    assert [row["zeta.front_max"] for row in report.rows] == [1.5]


def test_an_unknown_figure_is_refused() -> None:
    result = CliRunner().invoke(cli, ["paper", "fig4"])
    assert result.exit_code == 2 and "'fig4'" in result.output and "fig5" in result.output


def test_a_figure_from_the_command_line(tmp_path: Path) -> None:
    """Figure 9, quick: two cylinders; the flat top stays at a = 0.55 and is gone at 0.9, as in the experiments."""
    out = tmp_path / "figures"
    result = CliRunner().invoke(cli, ["paper", "fig9", "--quick", "--out", str(out)])
    assert result.exit_code == 0, result.output
    with (out / "fig9.csv").open(newline="") as file:
        rows = {float(row["a"]): row for row in csv.DictReader(file)}
    assert 30.0 < float(rows[0.55]["undisturbed_mm"]) < 45.0 and float(rows[0.9]["undisturbed_mm"]) == 0.0
    assert (out / "fig9-top-a0.55.png").stat().st_size > 10_000
    assert "Figure 9" in (out / "fig9.md").read_text()
    again = CliRunner().invoke(cli, ["paper", "fig9", "--quick", "--out", str(out)])
    assert again.exit_code == 0 and "nothing to run" in again.output
