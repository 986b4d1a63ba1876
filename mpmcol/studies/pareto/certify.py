"""Runout and height extrapolated to zero node spacing, with an error bar, from repeated runs at several spacings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from shlex import quote

import numpy as np

from mpmcol.case import load_case
from mpmcol.errors import UsageError
from mpmcol.io.names import REPEATS_FOLDER
from mpmcol.io.run_folder import replace_run
from mpmcol.studies.convergence import pooled_scatter
from mpmcol.studies.definition import as_overrides
from mpmcol.studies.pareto.proposed import completed
from mpmcol.studies.pareto.recommend import Recommendation, configuration_values, finer_grid
from mpmcol.studies.runs import CFL, repeated_cfl
from mpmcol.sweep.engine import Outcome, unsuccessful
from mpmcol.sweep.runner import SweepObserver, discard_runs, run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run
from mpmcol.sweep.table import make_rows

REPEATS = 3  # at each spacing
LEVELS = 3  # spacings of an error bar
RATIO = sqrt(2.0)  # of the spacings, approximately, since the radius is a whole number of cells
ORDERS = (0.75, 2.0)  # range of the order of convergence of runout and height
CONFIDENCE = 2.0  # standard errors
LEAST_ERROR = 0.01  # relative; convergence is not smooth enough for less
MIN_RUNS = 2  # successful ones at each spacing


@dataclass(frozen=True)
class ErrorBar:
    """A quantity extrapolated to zero spacing, with its absolute error bar and the parts of this."""

    quantity: str
    means: Mapping[float, float]  # r_i / h -> mean of the runs, coarsest first
    scatter: float  # standard deviation of one run
    value: float  # extrapolated
    from_order: float  # half the difference between the extrapolations with the lowest and the highest order
    from_misfit: float  # CONFIDENCE standard errors of the extrapolation

    @property
    def finest(self) -> float:
        """Mean at the finest spacing."""
        return self.means[max(self.means)]

    @property
    def error(self) -> float:
        """The sum of both parts, at least LEAST_ERROR of the value."""
        return max(self.from_order + self.from_misfit, LEAST_ERROR * abs(self.value))

    @property
    def relative(self) -> float:
        """The error relative to the value."""
        return self.error / abs(self.value)

    @property
    def cause(self) -> str:
        """What determines the width of the bar."""
        if self.from_order >= self.from_misfit:
            return "the unknown order of convergence"
        return "the scatter of the runs or an irregular change with the spacing"

    def __str__(self) -> str:
        cells = ", ".join(f"{one:g}" for one in self.means)
        means = ", ".join(f"{mean:.3f}" for mean in self.means.values())
        return (
            f"{self.quantity} = {self.value:.3f} +- {self.error:.3f} ({self.relative:.1%}), extrapolated to zero "
            f"spacing; means at r_i/h = {cells}: {means}; scatter of a run {self.scatter:.3f}"
        )


def certify(
    source: str | Path,
    overrides: Sequence[str],
    advice: Recommendation,
    accuracy: float,
    out: Path,
    *,
    jobs: int | None = None,
    threads: int | None = None,
    fresh: bool = False,
    observer: SweepObserver | None = None,
) -> tuple[list[Outcome], list[ErrorBar]]:
    """Run a case as recommended and on two coarser grids, several times each, and compute error bars.

    If a bar exceeds the relative `accuracy`, the case is also run on a finer grid. `out` becomes the results folder of
    the first run on the finest grid; the sweep of all runs is in REPEATS_FOLDER inside it. With `fresh` its earlier
    runs are discarded.

    Raises:
        UsageError: `out` holds something else.
        MpmcolError: with the exit code of the runs, if fewer than MIN_RUNS at a spacing were successful.
    """
    repeats = out / REPEATS_FOLDER
    if out.is_dir() and any(out.iterdir()) and not repeats.exists():
        raise UsageError(f"{out} is not empty and holds no run with --certify; use --out for another folder")

    def planned(levels: Sequence[float]) -> list[PlannedRun]:
        return [run for cells in levels for run in _repeated_runs(source, overrides, advice.variant, cells, repeats)]

    def run_all(levels: Sequence[float]) -> tuple[list[Outcome], list[ErrorBar]]:
        runs = planned(levels)
        outcomes = run_sweep(runs, repeats, jobs=jobs, threads=threads, observer=observer)
        return outcomes, _error_bars(outcomes, levels, list(advice.errors), repeats)

    levels = [*(round(advice.cells / RATIO**k) for k in range(LEVELS - 1, 0, -1)), advice.cells]
    following = finer_grid(source, overrides, advice)
    if fresh:
        discard_runs(planned([*levels, following]))
    outcomes, bars = run_all(levels)
    if any(bar.relative > accuracy for bar in bars):
        outcomes, bars = run_all([*levels, following])
    replace_run(_finest(outcomes).run.folder, out)
    return outcomes, bars


def error_bar(quantity: str, levels: Mapping[float, Sequence[float]]) -> ErrorBar:
    """Extrapolate a quantity to zero spacing from its LEVELS finest spacings, with an error bar.

    q(h) = q_0 + c h^p is fitted to the means by least squares with the lowest and the highest order p; the value is
    the mean of both q_0 (Richardson extrapolation, Roache 1994, doi:10.1115/1.2910291). The standard error follows from
    the misfit, or from the scatter of the runs where this is larger.

    Args:
        levels: r_i / h -> values of the repeated runs, for at least LEVELS spacings.
    """
    means = {cells: float(np.mean(levels[cells])) for cells in sorted(levels)}
    finest, scatter = list(means)[-LEVELS:], pooled_scatter(levels) or 0.0
    values = np.array([means[cells] for cells in finest])
    runs = min(len(levels[cells]) for cells in finest)
    low, high = (_extrapolate(np.array(finest) ** -order, values, scatter / sqrt(runs)) for order in ORDERS)
    return ErrorBar(
        quantity, means, scatter, (low[0] + high[0]) / 2.0, abs(low[0] - high[0]) / 2.0,
        CONFIDENCE * (low[1] + high[1]) / 2.0,
    )  # fmt: skip


def _extrapolate(x: np.ndarray, values: np.ndarray, scatter: float) -> tuple[float, float]:
    """Intercept of the line through `values` over x, and its standard error; scatter: of the values, at least."""
    coefficients, covariance = np.polyfit(x, values, 1, cov="unscaled")
    misfit = np.linalg.norm(values - np.polyval(coefficients, x)) / sqrt(len(x) - 2)
    return float(coefficients[1]), max(float(misfit), scatter) * sqrt(covariance[1, 1])


def _error_bars(
    outcomes: Sequence[Outcome], levels: Sequence[float], quantities: Sequence[str], folder: Path
) -> list[ErrorBar]:
    rows = [row for row in make_rows(outcomes) if row["status"] == "done"]
    values = {
        quantity: {cells: [row[quantity] for row in rows if row["cells"] == cells] for cells in levels}
        for quantity in quantities
    }
    if any(len(runs) < MIN_RUNS for by_cells in values.values() for runs in by_cells.values()):
        raise unsuccessful(
            outcomes, f"too few runs were successful for an error bar; `mpmcol status {quote(str(folder))}` lists why"
        )
    return [error_bar(quantity, by_cells) for quantity, by_cells in values.items()]


def _finest(outcomes: Sequence[Outcome]) -> Outcome:
    """The first successful run on the finest grid."""
    return max((one for one in outcomes if one.status == "done"), key=lambda one: one.run.inputs["cells"])


def _repeated_runs(
    source: str | Path, overrides: Sequence[str], variant: str, cells: float, out: Path
) -> list[PlannedRun]:
    values = configuration_values(load_case(source, overrides), variant, cells)
    configured = [*overrides, *as_overrides(completed(source, overrides, values) or values)]
    base = load_case(source, configured)
    runs = []
    for cfl in repeated_cfl(base.time.cfl, REPEATS):
        case = load_case(source, [*configured, f"{CFL}={cfl}"])
        runs.append(plan_run(case, out, {"cells": cells, CFL: float(cfl)}, f"cells{cells:g}-cfl{float(cfl):.4g}"))
    return runs
