"""Runout and height with an error bar, from repeated runs at two spacings, or at three where two do not suffice."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import hypot, sqrt
from pathlib import Path
from shlex import quote

import numpy as np

from mpmcol.case import load_case
from mpmcol.errors import UsageError
from mpmcol.io.names import REPEATS_FOLDER
from mpmcol.io.run_folder import replace_run
from mpmcol.studies.convergence import converged_value, pooled_scatter
from mpmcol.studies.definition import as_overrides
from mpmcol.studies.pareto.proposed import completed
from mpmcol.studies.pareto.recommend import Recommendation, configuration_values, finer_grid
from mpmcol.studies.runs import CFL, repeated_cfl
from mpmcol.sweep.engine import Outcome, unsuccessful
from mpmcol.sweep.fits import student_t
from mpmcol.sweep.runner import SweepObserver, discard_runs, run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run
from mpmcol.sweep.table import make_rows

REPEATS = 3  # at each spacing
RATIO = sqrt(2.0)  # of the spacings, approximately, since the radius is a whole number of cells
ORDER = 1.0  # the lowest order of convergence that is usual for front and height
SAFETY = 1.25
MIN_RUNS = 2  # successful ones at each spacing


@dataclass(frozen=True)
class ErrorBar:
    """Mean of a quantity at the finest spacing, with its absolute error bar and the parts of this."""

    quantity: str
    means: Mapping[float, float]  # r_i / h -> mean of the runs, coarsest first
    scatter: float  # standard deviation of one run
    from_spacings: float  # from the change of the mean with the spacing
    from_scatter: float  # 95 % confidence interval of the extrapolation
    from_study: float  # of the configuration in the study

    @property
    def value(self) -> float:
        """Mean at the finest spacing."""
        return self.means[max(self.means)]

    @property
    def error(self) -> float:
        """The larger of the error from the spacings and that of the study.

        Spacings can agree by coincidence or converge at a lower order than assumed.
        """
        return max(hypot(self.from_spacings, self.from_scatter), self.from_study)

    @property
    def relative(self) -> float:
        """The error relative to the value."""
        return self.error / abs(self.value)

    @property
    def cause(self) -> str:
        """What determines the width of the bar."""
        if self.from_study >= hypot(self.from_spacings, self.from_scatter):
            return "the error of this grid in the study"
        return "the change with the spacing" if self.from_spacings >= self.from_scatter else "the scatter of the runs"

    def __str__(self) -> str:
        cells = ", ".join(f"{one:g}" for one in self.means)
        means = ", ".join(f"{mean:.3f}" for mean in self.means.values())
        return (
            f"{self.quantity} = {self.value:.3f} +- {self.error:.3f} ({self.relative:.1%}); means at r_i/h = {cells}: "
            f"{means}; scatter of a run {self.scatter:.3f}; error in the study {self.from_study:.3f}"
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
    """Run a case as recommended and on a coarser grid, several times each, and compute error bars.

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

    def run_all(levels: Sequence[float], errors: Mapping[str, float]) -> tuple[list[Outcome], list[ErrorBar]]:
        runs = planned(levels)
        outcomes = run_sweep(runs, repeats, jobs=jobs, threads=threads, observer=observer)
        return outcomes, _error_bars(outcomes, levels, errors, repeats)

    levels = [max(round(advice.cells / RATIO), 2), advice.cells]
    following, errors = finer_grid(source, overrides, advice)
    if fresh:
        discard_runs(planned([*levels, following]))
    outcomes, bars = run_all(levels, advice.errors)
    if any(bar.relative > accuracy for bar in bars):
        outcomes, bars = run_all([*levels, following], errors)
    replace_run(_finest(outcomes).run.folder, out)
    return outcomes, bars


def error_bar(quantity: str, levels: Mapping[float, Sequence[float]], study_error: float = 0.0) -> ErrorBar:
    """Compute the error of the mean at the finest spacing.

    At two spacings it is the grid convergence index of Roache 1994 (doi:10.1115/1.2910291), SAFETY |change| /
    (ratio^ORDER - 1), and likewise for the 95 % confidence interval of the change. At three or more it is SAFETY times
    the difference from the extrapolated value, and the confidence interval of this value.

    Args:
        levels: r_i / h -> values of the repeated runs.
        study_error: relative error of the finest configuration in the study.
    """
    means = {cells: float(np.mean(levels[cells])) for cells in sorted(levels)}
    finest = means[max(means)]
    interval = student_t(sum(len(values) - 1 for values in levels.values()))
    scatter = pooled_scatter(levels) or 0.0
    if limit := converged_value({1.0 / cells: values for cells, values in levels.items()}):
        difference, deviation = limit.value - finest, interval * limit.error
    else:
        coarse, fine = list(means)[-2:]
        factor = 1.0 / ((fine / coarse) ** ORDER - 1.0)
        difference = factor * (finest - means[coarse])
        deviation = SAFETY * factor * interval * scatter * sqrt(1.0 / len(levels[coarse]) + 1.0 / len(levels[fine]))
    return ErrorBar(quantity, means, scatter, SAFETY * abs(difference), deviation, study_error * abs(finest))


def _error_bars(
    outcomes: Sequence[Outcome], levels: Sequence[float], errors: Mapping[str, float], folder: Path
) -> list[ErrorBar]:
    rows = [row for row in make_rows(outcomes) if row["status"] == "done"]
    values = {
        quantity: {cells: [row[quantity] for row in rows if row["cells"] == cells] for cells in levels}
        for quantity in errors
    }
    if any(len(runs) < MIN_RUNS for by_cells in values.values() for runs in by_cells.values()):
        raise unsuccessful(
            outcomes, f"too few runs were successful for an error bar; `mpmcol status {quote(str(folder))}` lists why"
        )
    return [error_bar(quantity, by_cells, errors[quantity]) for quantity, by_cells in values.items()]


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
