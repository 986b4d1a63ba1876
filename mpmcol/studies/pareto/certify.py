"""Runout and height with an error bar, from repeated runs at two spacings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.studies.pareto.recommend import Recommendation
from mpmcol.studies.runs import CFL, repeated_cfl
from mpmcol.sweep.engine import Outcome, unsuccessful
from mpmcol.sweep.fits import student_t
from mpmcol.sweep.runner import SweepObserver, run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run
from mpmcol.sweep.table import make_rows

REPEATS = 3  # at each spacing
RATIO = sqrt(2.0)  # of the spacings, approximately, since the radius is a whole number of cells
ORDER = 1.0  # the lowest order of convergence that is usual for front and height
SAFETY = 1.25
MIN_RUNS = 2  # successful ones at each spacing


@dataclass(frozen=True)
class CertifiedQuantity:
    """A quantity of the finer runs with its absolute error bar and the parts of this."""

    quantity: str
    value: float
    error: float  # the larger of that from the two spacings and that of the study
    change: float  # from the coarser spacing to the finer one
    scatter: float  # standard deviation of one run
    study_error: float  # of the configuration in the study

    def __str__(self) -> str:
        return (
            f"{self.quantity}: {self.value:.3f} +- {self.error:.3f} (change from the coarser grid {self.change:+.3f}, "
            f"scatter of a run {self.scatter:.3f}, error in the study {self.study_error:.3f})"
        )


def certify(
    source: str | Path,
    overrides: Sequence[str],
    advice: Recommendation,
    out: Path,
    *,
    jobs: int | None = None,
    threads: int | None = None,
    observer: SweepObserver | None = None,
) -> tuple[list[Outcome], list[CertifiedQuantity]]:
    """Run a case as recommended and on a coarser grid, several times each, in the folder `out`.

    Raises an MpmcolError with the exit code of the runs if fewer than MIN_RUNS at one of the spacings were successful.
    """
    values = [*overrides, *advice.overrides]
    coarse = max(round(advice.cells / RATIO), 2)
    levels = [_repeated_runs(source, values, cells, out) for cells in (coarse, advice.cells)]
    outcomes = run_sweep([run for level in levels for run in level], out, jobs=jobs, threads=threads, observer=observer)
    rows = [row for row in make_rows(outcomes) if row["status"] == "done"]
    results = {
        quantity: [[row[quantity] for row in rows if row["cells"] == cells] for cells in (coarse, advice.cells)]
        for quantity in advice.errors
    }
    if any(len(level) < MIN_RUNS for both in results.values() for level in both):
        raise unsuccessful(outcomes, f"too few runs were successful for an error bar; `mpmcol status {out}` lists why")
    ratio = advice.cells / coarse
    return outcomes, [
        error_bar(quantity, coarser, finer, ratio, advice.errors[quantity])
        for quantity, (coarser, finer) in results.items()
    ]


def error_bar(
    quantity: str, coarse: Sequence[float], fine: Sequence[float], ratio: float, study_error: float = 0.0
) -> CertifiedQuantity:
    """Compute the error of the finer mean by the grid convergence index of Roache 1994 (doi:10.1115/1.2910291).

    With spacings in the ratio `ratio` it is SAFETY |change| / (ratio^ORDER - 1). The 95 % confidence interval of the
    change, from the pooled scatter of the repetitions, is added to the change in quadrature. Two spacings can agree by
    coincidence or converge at a lower order; the error bar is therefore at least the relative error `study_error` of
    the configuration in the study.
    """
    change = float(np.mean(fine) - np.mean(coarse))
    freedom = len(coarse) + len(fine) - 2
    scatter = sqrt(sum(float(np.var(level)) * len(level) for level in (coarse, fine)) / freedom)
    change_error = scatter * sqrt(1.0 / len(coarse) + 1.0 / len(fine))
    half_width = student_t(freedom) * change_error
    index = SAFETY * float(np.hypot(change, half_width)) / (ratio**ORDER - 1.0)
    value = float(np.mean(fine))
    least = study_error * abs(value)
    return CertifiedQuantity(quantity, value, max(index, least), change, scatter, least)


def _repeated_runs(source: str | Path, overrides: Sequence[str], cells: float, out: Path) -> list[PlannedRun]:
    base = load_case(source, overrides)
    runs = []
    for cfl in repeated_cfl(base.time.cfl, REPEATS):
        case = load_case(source, [*overrides, f"grid.spacing={base.geometry.r_i / cells:.9g}", f"{CFL}={cfl}"])
        runs.append(plan_run(case, out, {"cells": cells, CFL: float(cfl)}, f"cells{cells:g}-cfl{float(cfl):.4g}"))
    return runs
