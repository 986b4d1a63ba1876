"""Verify the errors of `mpmcol run --accuracy` and the error bars of `--certify` on random columns.

    python scripts/accuracy_cases.py OUT [--accuracy 5%] [--first 0] [--count 20] [--jobs N]

Each column (model, friction, size and aspect ratio) is drawn at random from its number, so that the same columns are
drawn every time. It is run as recommended for the accuracy or, if none is accurate enough, with the most accurate
configuration and its error. Its reference is the mean of two scheme variants on finer grids, with half their difference
as uncertainty. Printed are, for each column, the errors of the first run; the widths of the error bars and whether they
contain the reference; and the same of the intervals of a run by `--corrected`. Then follow the numbers of columns for
which both quantities were within the accuracy and within twice the accuracy, and of those that all error bars and all
intervals contain, also with the uncertainty of the reference: some intervals of heights are narrower than that.
Completed runs in OUT are not repeated.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.errors import UsageError
from mpmcol.studies.definition import as_overrides
from mpmcol.studies.pareto.certify import ErrorBar, certify
from mpmcol.studies.pareto.recommend import Recommendation, configuration_values, options, recommend
from mpmcol.studies.pareto.shipped import QUANTITIES
from mpmcol.sweep.runner import run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run
from mpmcol.sweep.table import make_rows
from mpmcol.units import to_unit

FINE = {"light, 9 points per cell": 112.0, "light, 16 points per cell": 80.0}  # variant -> r_i / h of the reference
FINE_TALL = {"light, 9 points per cell": 56.0, "light, 16 points per cell": 40.0}  # about as many cells in height
TALL = 1.5  # a

Values = Mapping[str, float]  # by quantity


@dataclass(frozen=True)
class Column:
    """A random column and the accuracy that is requested for it."""

    number: int
    source: str
    a: float
    radius: float  # m
    friction_deg: float
    accuracy: float  # requested, or the best available

    @property
    def overrides(self) -> tuple[str, ...]:
        """Values that are replaced in the shipped case."""
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
class Verification:
    """Errors of a column relative to its reference."""

    errors: Values  # of one recommended run
    uncertainty: Values  # of the reference, relative
    bars: Sequence[ErrorBar]
    is_contained: Sequence[bool]  # the reference in each error bar
    coarse: Recommendation  # by --corrected
    corrected_errors: Values  # of its run
    is_in_interval: Mapping[str, bool]  # the reference in the interval of finer grids

    @property
    def agrees(self) -> bool:
        """Whether the intervals of finer grids contain the reference or a value within its uncertainty."""
        return all(
            abs(error) <= self.coarse.intervals[name].relative + self.uncertainty[name]
            for name, error in self.corrected_errors.items()
        )


def draw(number: int, accuracy: float) -> tuple[Column, Recommendation]:
    """Draw column `number` and recommend a configuration for it."""
    rng = np.random.default_rng(number)
    source = ("cylinder", "channel")[rng.integers(2)]
    a, radius = float(np.exp(rng.uniform(np.log(0.5), np.log(3.0)))), float(np.exp(rng.uniform(np.log(0.05), 0.0)))
    column = Column(number, source, a, radius, float(rng.uniform(22.0, 42.0)), accuracy)
    try:
        return column, recommend(source, column.overrides, accuracy)
    except UsageError:
        best = min(options(source, column.overrides), key=lambda one: one.error)
        return Column(number, source, a, radius, column.friction_deg, best.error), best


def verify(column: Column, advice: Recommendation, out: Path, jobs: int | None) -> Verification:
    """Run a column as recommended and as reference, and compare."""
    folder = out / f"{column.number:02d}"
    outcomes, bars = certify(
        column.source, column.overrides, advice, column.accuracy, folder / "recommended", jobs=jobs
    )
    first = next(row for row in make_rows(outcomes) if row["cells"] == advice.cells)
    fine = FINE if column.a < TALL else FINE_TALL
    runs = [_planned(column, variant, cells, folder / "reference") for variant, cells in fine.items()]
    rows = make_rows(run_sweep(runs, folder / "reference", jobs=jobs, threads=1))
    coarse = recommend_corrected(column)
    run = _planned(column, coarse.variant, coarse.cells, folder / "corrected")
    (row,) = make_rows(run_sweep([run], folder / "corrected", jobs=jobs, threads=1))
    reference = {quantity: (rows[0][quantity] + rows[1][quantity]) / 2.0 for quantity in QUANTITIES}
    return Verification(
        {quantity: first[quantity] / reference[quantity] - 1.0 for quantity in QUANTITIES},
        {quantity: abs(rows[0][quantity] / reference[quantity] - 1.0) for quantity in QUANTITIES},
        bars,
        [_contains(bar, reference[bar.quantity]) for bar in bars],
        coarse,
        {name: one.factor * row[name] / reference[name] - 1.0 for name, one in coarse.intervals.items()},
        {name: one.low <= row[name] / reference[name] - 1.0 <= one.high for name, one in coarse.intervals.items()},
    )


def recommend_corrected(column: Column) -> Recommendation:
    """The configuration by `--corrected` or, if none is accurate enough, the most accurate one."""
    try:
        return recommend(column.source, column.overrides, column.accuracy, corrected=True)
    except UsageError:
        return min(options(column.source, column.overrides), key=lambda one: one.corrected_error)


def _planned(column: Column, variant: str, cells: float, out: Path) -> PlannedRun:
    base = load_case(column.source, column.overrides)
    overrides = [*column.overrides, *as_overrides(configuration_values(base, variant, cells))]
    return plan_run(load_case(column.source, overrides), out, {"cells": cells}, f"{cells:g}")


def _contains(bar: ErrorBar, reference: float) -> bool:
    return abs(bar.value - reference) <= bar.error


def main() -> None:
    """Verify all columns."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, help="folder of the runs")
    parser.add_argument("--accuracy", type=lambda text: to_unit(text, ""), default=0.05, help="default: 5%%")
    parser.add_argument("--first", type=int, default=0, help="number of the first column (default: 0)")
    parser.add_argument("--count", type=int, default=20, help="columns (default: 20)")
    parser.add_argument("--jobs", type=int, help="number of concurrent runs")
    args = parser.parse_args()
    within = within_twice = contained = in_intervals = agree = 0
    for number in range(args.first, args.first + args.count):
        column, advice = draw(number, args.accuracy)
        result = verify(column, advice, args.out, args.jobs)
        worst = max(abs(error) for error in result.errors.values()) / column.accuracy
        within, within_twice = within + (worst <= 1.0), within_twice + (worst <= 2.0)
        contained += all(result.is_contained)
        in_intervals += all(result.is_in_interval.values())
        agree += result.agrees
        errors = ", ".join(
            f"{quantity} {error:+.1%} (reference +- {result.uncertainty[quantity]:.1%})"
            for quantity, error in result.errors.items()
        )
        print(
            f"{column}; {advice.variant}, {advice.cells:g}; requested {column.accuracy:.1%}: {errors}; "
            + ", ".join(
                f"error bar {bar.relative:.1%} {'contains' if one else 'does not contain'} the reference"
                for bar, one in zip(result.bars, result.is_contained, strict=True)
            )
            + f"; corrected from {result.coarse.variant}, {result.coarse.cells:g}: "
            + ", ".join(
                f"{quantity} {error:+.1%}, interval +- {result.coarse.intervals[quantity].relative:.1%} "
                f"{'contains' if result.is_in_interval[quantity] else 'does not contain'} the reference"
                for quantity, error in result.corrected_errors.items()
            ),
            flush=True,
        )
    print(
        f"of {args.count} columns {within} are within the accuracy, {within_twice} within twice the accuracy, and "
        f"{contained} within their error bars; {in_intervals} are within the intervals of coarser grids by "
        f"--corrected, {agree} with the uncertainty of the reference"
    )


if __name__ == "__main__":
    main()
