"""Whether `mpmcol run --accuracy` holds on columns that its table was not made from, and the error bar of `--certify`.

    python scripts/accuracy_cases.py OUT [--accuracy 5%] [--count 20] [--jobs N]

Columns are drawn at random, fixed by their number: model, friction, size, aspect ratio. Each is run as advised (where
no setting keeps to the accuracy, with the most accurate one, and judged by what that one promises) and, finer, as
reference: the mean of two families, with half their difference as uncertainty. Prints, for each column, the errors of
the first advised run against that and whether the error bar holds it; then in how many columns both quantities held,
and were within twice the accuracy. Finished runs in OUT are kept.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.errors import UsageError
from mpmcol.studies.pareto.certify import Certified, certify
from mpmcol.studies.pareto.recommend import Advice, advise, as_overrides, options, values_for
from mpmcol.studies.pareto.shipped import QUANTITIES
from mpmcol.sweep.runner import run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run
from mpmcol.sweep.table import make_rows
from mpmcol.units import to_unit

FINE = {"light, nine points": 112.0, "light, sixteen points": 80.0}  # family -> r_i / h of the reference
FINE_TALL = {"light, nine points": 56.0, "light, sixteen points": 40.0}  # as many cells in the height
TALL = 1.5  # a

Values = Mapping[str, float]  # by quantity


@dataclass(frozen=True)
class Column:
    """A case, and what was advised for it."""

    number: int
    source: str
    a: float
    radius: float  # m
    friction_deg: float
    accuracy: float  # that is asked for, or the best that there is

    @property
    def overrides(self) -> tuple[str, ...]:
        """Of the shipped case."""
        return (
            f"geometry.aspect={self.a:.4g}", f"geometry.radius={self.radius:.4g}",
            f"geometry.base_thickness={0.2 * self.radius:.4g}", f"grid.spacing={self.radius / 20.0:.6g}",
            f"material.friction_deg={self.friction_deg:.4g}", "output.snapshots=1",
        )  # fmt: skip

    def __str__(self) -> str:
        return (
            f"{self.number:2d} {self.source} a = {self.a:.2f}, {self.friction_deg:.0f} deg, r_i = {self.radius:.2f} m"
        )


@dataclass(frozen=True)
class Checked:
    """A column's errors against its reference."""

    errors: Values  # of one run as advised
    unsure: Values  # of the reference, relative
    bars: Sequence[bool]  # whether the error bars hold the reference


def draw(number: int, accuracy: float) -> tuple[Column, Advice]:
    """Column `number` with the setting for it."""
    rng = np.random.default_rng(number)
    source = ("lube-cylinder", "lube-channel")[rng.integers(2)]
    a, radius = float(np.exp(rng.uniform(np.log(0.5), np.log(3.0)))), float(np.exp(rng.uniform(np.log(0.05), 0.0)))
    column = Column(number, source, a, radius, float(rng.uniform(22.0, 42.0)), accuracy)
    try:
        return column, advise(source, column.overrides, accuracy)
    except UsageError:
        best = min(options(source, column.overrides), key=lambda one: one.error)
        return Column(number, source, a, radius, column.friction_deg, best.error), best


def check(column: Column, advice: Advice, out: Path, jobs: int | None) -> Checked:
    """Run a column as advised and as reference."""
    folder = out / f"{column.number:02d}"
    outcomes, bars = certify(column.source, column.overrides, advice, folder / "advised", jobs)
    first = next(row for row in make_rows(outcomes) if row["cells"] == advice.cells)
    fine = FINE if column.a < TALL else FINE_TALL
    points = [_reference(column, family, cells, folder / "reference") for family, cells in fine.items()]
    rows = make_rows(run_sweep(points, folder / "reference", jobs, 1))
    reference = {quantity: (rows[0][quantity] + rows[1][quantity]) / 2.0 for quantity in QUANTITIES}
    return Checked(
        {quantity: first[quantity] / reference[quantity] - 1.0 for quantity in QUANTITIES},
        {quantity: abs(rows[0][quantity] / reference[quantity] - 1.0) for quantity in QUANTITIES},
        [_holds(bar, reference[bar.quantity]) for bar in bars],
    )


def _reference(column: Column, family: str, cells: float, out: Path) -> PlannedRun:
    base = load_case(column.source, column.overrides)
    asked = [*column.overrides, *as_overrides(values_for(base, family, cells))]
    return plan_run(load_case(column.source, asked), out, {"cells": cells}, f"{cells:g}")


def _holds(bar: Certified, reference: float) -> bool:
    return abs(bar.value - reference) <= bar.error


def main() -> None:
    """Draw, run, compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--accuracy", type=lambda text: to_unit(text, ""), default=0.05)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--jobs", type=int)
    words = parser.parse_args()
    held = twice = bars = 0
    for number in range(words.count):
        column, advice = draw(number, words.accuracy)
        checked = check(column, advice, words.out, words.jobs)
        worst = max(abs(error) for error in checked.errors.values()) / column.accuracy
        held, twice, bars = held + (worst <= 1.0), twice + (worst <= 2.0), bars + all(checked.bars)
        told = ", ".join(f"{q} {e:+.1%} (reference +- {checked.unsure[q]:.1%})" for q, e in checked.errors.items())
        print(
            f"{column}; {advice.family}, {advice.cells:g}; asked {column.accuracy:.1%}: {told}; bars {checked.bars}",
            flush=True,
        )
    print(f"of {words.count}: {held} within the accuracy, {twice} within twice that; {bars} within their error bars")


if __name__ == "__main__":
    main()
