"""Runout and height with an error bar of their own, from runs at two spacings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.studies.pareto.recommend import Advice
from mpmcol.studies.runs import CFL_STEP
from mpmcol.sweep.engine import Outcome, unsuccessful
from mpmcol.sweep.runner import SweepObserver, run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run
from mpmcol.sweep.table import make_rows

RUNS = 3  # at each spacing, with time steps a little apart
RATIO = sqrt(2.0)  # of the spacings, about: the radius is whole cells
ORDER = 1.0  # the lowest that is usual for the front and the height of a pile
SAFETY = 1.25
FEWEST = 2  # that must have ended well
STUDENT = {2: 4.30, 3: 3.18, 4: 2.78}  # degrees of freedom -> 95 % of Student's t


@dataclass(frozen=True)
class Certified:
    """A quantity of the finer runs with its error bar: absolute, and what it is made of."""

    quantity: str
    value: float
    error: float  # the larger of what the two spacings show and what the study found
    change: float  # from the coarser spacing to the finer
    scatter: float  # standard deviation of one run
    known: float  # error that the setting had in the study

    def __str__(self) -> str:
        return (
            f"{self.quantity}: {self.value:.3f} +- {self.error:.3f} (from the coarser grid {self.change:+.3f}, "
            f"scatter of a run {self.scatter:.3f}, in the study +- {self.known:.3f})"
        )


def certify(
    source: str | Path,
    overrides: Sequence[str],
    advice: Advice,
    out: Path,
    jobs: int | None = None,
    threads: int | None = None,
    observer: SweepObserver | None = None,
) -> tuple[list[Outcome], list[Certified]]:
    """Run a case as advised and at a coarser spacing into the folder `out`, some times each.

    Raises an MpmcolError with the runs' exit code if fewer than FEWEST at one of the spacings ended well.
    """
    asked = [*overrides, *advice.overrides]
    coarse = max(round(advice.cells / RATIO), 2)
    levels = [_points(source, asked, cells, out) for cells in (coarse, advice.cells)]
    outcomes = run_sweep([point for points in levels for point in points], out, jobs, threads, observer=observer)
    rows = [row for row in make_rows(outcomes) if row["status"] == "done"]
    values = {
        quantity: [[row[quantity] for row in rows if row["cells"] == cells] for cells in (coarse, advice.cells)]
        for quantity in advice.within
    }
    if any(len(level) < FEWEST for both in values.values() for level in both):
        raise unsuccessful(outcomes, f"too few runs ended well to tell an error; mpmcol status {out} says why")
    ratio = advice.cells / coarse
    return outcomes, [
        error_bar(quantity, both[0], both[1], ratio, advice.within[quantity]) for quantity, both in values.items()
    ]


def error_bar(
    quantity: str, coarse: Sequence[float], fine: Sequence[float], ratio: float, within: float = 0.0
) -> Certified:
    """The finer mean with the grid convergence index of Roache 1994 (doi:10.1115/1.2910291) and the scatter of means.

    With spacings `ratio` apart: SAFETY |change| / (ratio^ORDER - 1), where the change is taken with the 95 % interval
    of its own scatter, added in squares. Two spacings alone can agree by luck, or approach the limit at a lower order,
    so that the bar is never less than the relative error `within` which the study found of this setting.
    """
    change = float(np.mean(fine) - np.mean(coarse))
    freedom = len(coarse) + len(fine) - 2
    scatter = sqrt(sum(float(np.var(level)) * len(level) for level in (coarse, fine)) / freedom)
    mean_error = scatter * sqrt(1.0 / len(coarse) + 1.0 / len(fine))
    shown = SAFETY * float(np.hypot(change, STUDENT[freedom] * mean_error)) / (ratio**ORDER - 1.0)
    value = float(np.mean(fine))
    known = within * abs(value)
    return Certified(quantity, value, max(shown, known), change, scatter, known)


def _points(source: str | Path, overrides: Sequence[str], cells: float, out: Path) -> list[PlannedRun]:
    base = load_case(source, overrides)
    points = []
    for i in range(RUNS):
        cfl = base.time.cfl * (1.0 - CFL_STEP * i)
        case = load_case(source, [*overrides, f"grid.spacing={base.geometry.r_i / cells:.9g}", f"time.cfl={cfl:.6g}"])
        points.append(plan_run(case, out, {"cells": cells, "time.cfl": cfl}, f"cells{cells:g}-cfl{cfl:.4g}"))
    return points
