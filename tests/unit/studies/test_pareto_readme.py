"""Figures that READMEs state from the shipped study of cost against error."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from math import hypot, sqrt
from pathlib import Path

import pytest

from mpmcol.experiments import find_experiment
from mpmcol.studies.pareto.error_interval import error_intervals
from mpmcol.studies.pareto.recommend import largest_corrected_error
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.shipped import converged_values, shipped_study, study_case, study_columns
from mpmcol.studies.pareto.study import shipped_studies

ROOT = Path(__file__).parents[3]
README = (ROOT / "scripts" / "pareto" / "README.md").read_text(encoding="utf-8")
ROWS = list(csv.DictReader(shipped_studies()["default"].with_suffix(".csv").read_text(encoding="utf-8").splitlines()))
REFINED = ("light, 9 points per cell", "light, 16 points per cell")


def uncertainty(row: dict[str, str], quantity: str) -> float:
    return float(row[f"{quantity} reference uncertainty"])


def bound(row: dict[str, str]) -> float:
    """The error that `--accuracy` compares with the requested one, for a column like this case."""
    return max(hypot(float(row[f"{quantity} bound"]), uncertainty(row, quantity)) for quantity in (ZETA, BETA))


def corrected_error(row: dict[str, str]) -> float:
    """The same of corrected values."""
    return largest_corrected_error(error_intervals(row["variant"], float(row["cells"]), study_columns()[row["case"]]))


def lines_of_the_table() -> Iterator[str]:
    for case in shipped_study().cases:
        own = [row for row in ROWS if row["case"] == case and row[f"{ZETA} bound"]]
        own = [row for row in own if shipped_study().variants[row["variant"]].selectable]
        cells = [case]
        for error in (bound, corrected_error):
            for accuracy in (0.10, 0.05):
                costs = [float(row["core_seconds"]) for row in own if error(row) <= accuracy]
                cells.append(f"{float(f'{min(costs):.2g}'):g}" if costs else "-")
        cells.append(f"{100.0 * min(map(bound, own)):.1f} %")
        cells.append(f"{100.0 * uncertainty(own[0], ZETA):.1f}, {100.0 * uncertainty(own[0], BETA):.1f} %")
        yield f"| {' | '.join(cells)} |"


def test_the_table_of_costs_is_that_of_the_study() -> None:
    missing = [line for line in lines_of_the_table() if line not in README]
    assert not missing, "\n".join(missing)


@pytest.mark.parametrize(("name", "quantity"), [("runout", ZETA), ("height", BETA)])
def test_the_scatter_is_that_of_the_study(name: str, quantity: str) -> None:
    """Root mean square over the columns, of the variants that are refined."""
    cells = []
    for grid in (10.0, 14.0, 20.0, 28.0, 40.0, 56.0, 80.0):
        own = [row for row in ROWS if row["variant"] in REFINED and float(row["cells"]) == grid]
        cells.append(f"{100.0 * sqrt(sum(float(row[f'{quantity} scatter']) ** 2 for row in own) / len(own)):.1f} %")
    line = f"| {name} | {' | '.join(cells)} |"
    assert line in README, line


def test_the_numbers_of_runs_and_their_time_are_those_of_the_study() -> None:
    runs = sum(int(row["runs"]) for row in ROWS)
    minutes = sum(int(row["runs"]) * float(row["core_seconds"]) for row in ROWS) / 60.0
    assert f"({runs} runs with the stress filter, {minutes:.0f} core-minutes" in README, (runs, minutes)


@pytest.mark.parametrize(("quantity", "law", "words"), [(ZETA, "zeta", "runouts"), (BETA, "beta", "heights")])
def test_the_readme_states_the_range_of_the_converged_values(quantity: str, law: str, words: str) -> None:
    text = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    differences = []
    for name, values in converged_values().items():
        if "degrees" not in name:
            case = study_case(name)
            experiment = find_experiment(case.score.experiment, case.geometry.model, case.geometry.column_section)
            expected = experiment.expected(law, case.geometry.a)
            assert expected
            differences.append(100.0 * (values[quantity] / expected[0] - 1.0))
    found = re.search(rf"{words}[a-z0-9=.() ]* (\d+) % below to (\d+) % above", text)
    assert found and (f"{-min(differences):.0f}", f"{max(differences):.0f}") == found.groups(), differences
