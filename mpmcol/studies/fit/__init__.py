"""Fits of unknown values of a case to measurements of a deposit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.case.geometry import GeometryTable
from mpmcol.errors import UsageError
from mpmcol.studies.fit.agreement import Agreement, agreement_of
from mpmcol.studies.fit.forward import Forward
from mpmcol.studies.fit.levels import Level, level_at, levels_for, make_level
from mpmcol.studies.fit.quantities import PROFILE, Target
from mpmcol.studies.fit.response import design
from mpmcol.studies.fit.search import Notify, Search, Solution
from mpmcol.studies.fit.unknowns import Unknown
from mpmcol.studies.frame import RUNS
from mpmcol.studies.runs import MOST_REPEATS
from mpmcol.sweep.arguments import require_accuracy, require_count
from mpmcol.sweep.engine import KeptPool
from mpmcol.sweep.plan import PLAN_FILE
from mpmcol.sweep.runner import SweepObserver
from mpmcol.sweep.runs import PlannedRun
from mpmcol.units import length_text

REPEATS = LEAST_REPEATS = 2  # runs for each set of values
FAR = 5.0  # times the height of the column: a measured profile is in another unit


@dataclass(frozen=True)
class Fit:
    """A fit that has ended."""

    source: str | Path
    overrides: tuple[str, ...]
    unknowns: tuple[Unknown, ...]
    targets: tuple[Target, ...]
    solution: Solution
    folder: Path

    @property
    def agreement(self) -> Agreement:
        """The measurements beside the computed values."""
        return agreement_of(self.targets, self.solution)

    @property
    def is_grid_known(self) -> bool:
        """Whether the error of the grid is known for any of the measured quantities."""
        return self.solution.last.level.errors is not None and any(one.has_grid_error for one in self.targets)


def carry_out_fit(
    source: str | Path,
    overrides: Sequence[str],
    unknowns: Sequence[Unknown],
    targets: Sequence[Target],
    out: Path,
    *,
    accuracy: float | None = None,
    repeats: int = REPEATS,
    jobs: int | None = None,
    threads: int | None = None,
    fresh: bool = False,
    observer: SweepObserver | None = None,
    notify: Notify = lambda line: None,
) -> Fit:
    """Find the values of the unknowns with the least misfit to the targets, with runs in `out`/RUNS.

    The ends and the middle of the ranges are computed first. A quadratic response surface of the targets gives the
    values with the least misfit; they are computed, and the surface, corrected by the result, gives the next ones,
    until they change by less than half of their standard errors (a secant method for one unknown, Gauss-Newton for
    several). Computed values are corrected for the error of the grid in the study: first for that in the middle of the
    ranges, at the end for that at the solution. With an accuracy, the search begins on coarse grids of the study; the
    surface is corrected on each finer one, which then needs few evaluations.
    Runs that have ended are not repeated, so that the same call resumes a fit that was stopped, with equal results.

    Raises:
        UsageError: there are fewer measured values than unknowns, the study has no configuration for this case, or the
            folder holds something else.
        CaseError: a value of the case is invalid.
        MpmcolError: no run with some values was successful; it has the exit code of the runs.
    """
    _require_valid(unknowns, targets, load_case(source, overrides).geometry, accuracy, repeats)
    _require_own(out)
    with KeptPool() as kept:
        forward = Forward(
            source, tuple(overrides), tuple(unknowns), tuple(targets), out / RUNS, repeats, kept,
            jobs, threads, fresh, observer,
        )  # fmt: skip
        search = Search(forward, notify)
        shares = np.full(len(unknowns), 0.5)
        for number, one in enumerate(levels_for(accuracy), 1):
            level = make_level(source, overrides, unknowns, targets, shares, one, number)
            if search.evaluations and level.overrides == search.evaluations[-1].level.overrides:
                continue
            notify(f"{level.name}: {level.text}")
            solution = search.run(level, shares if search.evaluations else search.begin(level))
            shares = solution.shares
        corrected = level_at(source, overrides, unknowns, shares, solution.last.level)
        if corrected != solution.last.level:
            search.correct(corrected)
            solution = search.run(corrected, solution.last.shares)
    return Fit(source, tuple(overrides), tuple(unknowns), tuple(targets), solution, out)


def plan_fit(
    source: str | Path,
    overrides: Sequence[str],
    unknowns: Sequence[Unknown],
    targets: Sequence[Target],
    out: Path,
    *,
    accuracy: float | None = None,
    repeats: int = REPEATS,
) -> tuple[list[Level], list[PlannedRun]]:
    """The grids of a fit, and its first runs: at the middle and the ends of the ranges. Arguments as `carry_out_fit`.

    Raises as `carry_out_fit` before it computes.
    """
    _require_valid(unknowns, targets, load_case(source, overrides).geometry, accuracy, repeats)
    _require_own(out)
    middle = np.full(len(unknowns), 0.5)
    levels = [
        make_level(source, overrides, unknowns, targets, middle, one, number)
        for number, one in enumerate(levels_for(accuracy), 1)
    ]
    with KeptPool() as kept:
        forward = Forward(source, tuple(overrides), tuple(unknowns), tuple(targets), out / RUNS, repeats, kept)
    return levels, [run for one in design(len(unknowns)) for run in forward.planned(levels[0], one)]


def _require_own(out: Path) -> None:
    """Raise UsageError if a folder holds something else than a fit."""
    if out.is_dir() and any(out.iterdir()) and not (out / RUNS / PLAN_FILE).exists():
        raise UsageError(f"{out} is not empty and holds no fit; use --out for another folder")


def _require_valid(
    unknowns: Sequence[Unknown], targets: Sequence[Target], column: GeometryTable, accuracy: float | None, repeats: int
) -> None:
    require_accuracy(accuracy)
    require_count("repeats", repeats, LEAST_REPEATS, MOST_REPEATS)
    require_enough(unknowns, targets)
    for target in targets:
        if target.name == PROFILE and target.values.max() > FAR * column.h_i:
            raise UsageError(
                f"the measured profile is up to {length_text(float(target.values.max()))} high, the column "
                f'{length_text(column.h_i)}; lengths in mm need the header "r [mm],z [mm]"'
            )


def require_enough(unknowns: Sequence[Unknown], targets: Sequence[Target]) -> None:
    """Raise UsageError if there are fewer measured values than unknowns, or none of either."""
    values = sum(len(target.values) for target in targets)
    if not unknowns:
        raise UsageError("no unknown; give --vary KEY=LOW:HIGH, for example --vary material.friction_deg=20:45")
    if values < len(unknowns):
        keys, names = " and ".join(one.key for one in unknowns), ", ".join(one.name for one in targets) or "nothing"
        raise UsageError(
            f"{len(unknowns)} unknown{'s' if len(unknowns) > 1 else ''} ({keys}) cannot follow from {values} measured "
            f"value{'s' if values != 1 else ''} ({names}); give more with --to, for example zeta and beta, or --profile"
        )
