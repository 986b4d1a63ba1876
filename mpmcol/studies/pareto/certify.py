"""Runout and height extrapolated to zero node spacing, with an error bar, from runs at several spacings."""

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
from mpmcol.studies.definition import as_overrides
from mpmcol.studies.pareto.proposed import completed
from mpmcol.studies.pareto.recommend import Recommendation, configuration_values, finer_grid
from mpmcol.studies.pareto.score import BETA
from mpmcol.sweep.engine import Outcome, unsuccessful
from mpmcol.sweep.runner import SweepObserver, discard_runs, run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run
from mpmcol.sweep.table import make_rows

LEVELS = 3  # spacings of an error bar
NEIGHBOURS = 2  # runs at each of them, with one cell fewer in the radius: a front depends on where the nodes lie
RATIO = sqrt(2.0)  # of the spacings, approximately, since the radius is a whole number of cells
ORDERS = (0.75, 2.0)  # range of the order of convergence of runout and height
CONFIDENCE = 2.0  # standard errors
LEAST_ERROR = 0.01  # relative; convergence is not smooth enough for less
# Node spacings on the finest grid: the least error of a position. Heights of columns with a of about 1 stay equal from
# r_i/h = 14 to 40 and rise on finer grids, which coarser ones do not announce; with this 95 % of the bars from the
# study contain its grid-converged heights, and 80 % without (`tests/unit/studies/test_recommend.py`).
LEAST_SPACINGS = 1.5
MIN_RUNS = 4  # successful ones: with fewer, the misfit has one degree of freedom


@dataclass(frozen=True)
class ErrorBar:
    """A quantity extrapolated to zero spacing, with its absolute error bar and the parts of this."""

    quantity: str
    runs: Mapping[float, float]  # r_i / h -> result of the run, coarsest first
    value: float  # extrapolated
    from_order: float  # half the difference between the extrapolations with the lowest and the highest order
    from_misfit: float  # CONFIDENCE standard errors of the extrapolation
    from_spacing: float  # LEAST_SPACINGS of the finest grid

    @property
    def error(self) -> float:
        """The sum of the first two parts, at least the third and LEAST_ERROR of the value."""
        return max(self.from_order + self.from_misfit, self.from_spacing, LEAST_ERROR * abs(self.value))

    @property
    def relative(self) -> float:
        """The error relative to the value."""
        return self.error / abs(self.value)

    @property
    def cause(self) -> str:
        """What determines the width of the bar."""
        if self.from_spacing >= self.from_order + self.from_misfit:
            return f"the spacing: {LEAST_SPACINGS:g} node spacings of the finest grid"
        if self.from_order >= self.from_misfit:
            return "the unknown order of convergence"
        return "the scatter of the runs or an irregular change with the spacing"

    def __str__(self) -> str:
        cells = ", ".join(f"{one:g}" for one in self.runs)
        results = ", ".join(f"{result:.3f}" for result in self.runs.values())
        return (
            f"{self.quantity} = {self.value:.3f} +- {self.error:.3f} ({self.relative:.1%}), extrapolated to zero "
            f"spacing; runs at r_i/h = {cells}: {results}"
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
    """Run a case as recommended and on two coarser grids, each with a neighbouring one, and compute error bars.

    If a bar exceeds the relative `accuracy`, the case is also run on a finer grid. `out` becomes the results folder of
    the first run on the finest grid; the sweep of all runs is in REPEATS_FOLDER inside it. With `fresh` its earlier
    runs are discarded.

    Raises:
        UsageError: `out` holds something else.
        MpmcolError: with the exit code of the runs, if fewer than MIN_RUNS were successful.
    """
    repeats = out / REPEATS_FOLDER
    if out.is_dir() and any(out.iterdir()) and not repeats.exists():
        raise UsageError(f"{out} is not empty and holds no run with --certify; use --out for another folder")

    def run_all(runs: Sequence[PlannedRun]) -> tuple[list[Outcome], list[ErrorBar]]:
        outcomes = run_sweep(runs, repeats, jobs=jobs, threads=threads, observer=observer)
        return outcomes, _error_bars(outcomes, list(advice.errors), repeats, load_case(source, overrides).geometry.a)

    first, all_runs = (planned_runs(source, overrides, advice, out, with_finer) for with_finer in (False, True))
    if fresh:
        discard_runs(all_runs)
    outcomes, bars = run_all(first)
    if any(bar.relative > accuracy for bar in bars):
        outcomes, bars = run_all(all_runs)
    replace_run(_finest(outcomes).run.folder, out)
    return outcomes, bars


def planned_runs(
    source: str | Path, overrides: Sequence[str], advice: Recommendation, out: Path, with_finer: bool
) -> list[PlannedRun]:
    """The runs of `certify`, coarsest first; with_finer: also those on the finer grid."""
    levels = [*(round(advice.cells / RATIO**k) for k in range(LEVELS - 1, 0, -1)), advice.cells]
    levels += [finer_grid(source, overrides, advice)] if with_finer else []
    grids = sorted({cells - i for cells in levels for i in range(NEIGHBOURS)})
    return [_run(source, overrides, advice.variant, cells, out / REPEATS_FOLDER) for cells in grids]


def error_bar(quantity: str, runs: Mapping[float, float], unit: float = 1.0) -> ErrorBar:
    """Extrapolate a quantity to zero spacing from runs at several spacings, with an error bar.

    q(h) = q_0 + c h^p is fitted to the finest runs by least squares with the lowest and the highest order p; the value
    is the mean of both q_0 (Richardson extrapolation, Roache 1994, doi:10.1115/1.2910291). The standard error is the
    larger of both, from the misfit.

    Args:
        runs: r_i / h -> result, for at least three spacings; the finest LEVELS * NEIGHBOURS count.
        unit: length of a value of one, over r_i: 1 for zeta, a for beta.
    """
    ordered = {cells: runs[cells] for cells in sorted(runs)}
    cells, values = (np.array(one)[-LEVELS * NEIGHBOURS :] for one in (list(ordered), list(ordered.values())))
    low, high = (_extrapolate(cells**-order, values) for order in ORDERS)
    value, from_order = (low[0] + high[0]) / 2.0, abs(low[0] - high[0]) / 2.0
    from_spacing = LEAST_SPACINGS / (cells[-1] * unit)
    return ErrorBar(quantity, ordered, value, from_order, CONFIDENCE * max(low[1], high[1]), from_spacing)


def _extrapolate(x: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Intercept of the line through `values` over x, and its standard error."""
    coefficients, covariance = np.polyfit(x, values, 1, cov="unscaled")
    misfit = float(np.linalg.norm(values - np.polyval(coefficients, x))) / sqrt(len(x) - 2)
    return float(coefficients[1]), misfit * sqrt(covariance[1, 1])


def _error_bars(outcomes: Sequence[Outcome], quantities: Sequence[str], folder: Path, a: float) -> list[ErrorBar]:
    rows = [row for row in make_rows(outcomes) if row["status"] == "done"]
    if len(rows) < MIN_RUNS:
        raise unsuccessful(
            outcomes, f"too few runs were successful for an error bar; `mpmcol status {quote(str(folder))}` lists why"
        )
    return [
        error_bar(quantity, {row["cells"]: row[quantity] for row in rows}, a if quantity == BETA else 1.0)
        for quantity in quantities
    ]


def _finest(outcomes: Sequence[Outcome]) -> Outcome:
    """The successful run on the finest grid."""
    return max((one for one in outcomes if one.status == "done"), key=lambda one: one.run.inputs["cells"])


def _run(source: str | Path, overrides: Sequence[str], variant: str, cells: float, out: Path) -> PlannedRun:
    values = configuration_values(load_case(source, overrides), variant, cells)
    case = load_case(source, [*overrides, *as_overrides(completed(source, overrides, values) or values)])
    return plan_run(case, out, {"cells": cells}, f"cells{cells:g}")
