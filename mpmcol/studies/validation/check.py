"""A check: the column that is run, the quantity that is measured, its band, and negative controls."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
from scipy.stats import sem

from mpmcol.studies.runs import REPEATED_CFL, CompletedRun, CompletedRuns, StudyRun, study_run

SINGLE_CFL = ("0.5",)

Verdict = Literal["passed", "failed", "inconclusive", "unverified", "not run"]
Measure = Callable[[CompletedRun], float | None]  # None: no value, for example the stop time of a moving front


class Draw(Protocol):
    """A function that draws the chart of a check from one of its runs."""

    def __call__(self, path: Path, run: CompletedRun, width: float) -> object:
        """Draw to `path`; `width` is the upper end of the band."""


@dataclass(frozen=True)
class Column:
    """A shipped case at an aspect ratio, with some of its values replaced, on a fine and on a coarse grid."""

    case: str
    a: float
    h: float  # node spacing, m
    quick_h: float
    overrides: tuple[tuple[str, str], ...] = ()

    def runs(self, quick: bool, repeated: bool = True) -> list[StudyRun]:
        """Return the runs of the column: repeated ones, or a single one if `quick` or not `repeated`."""
        values = REPEATED_CFL if repeated and not quick else SINGLE_CFL
        h = self.quick_h if quick else self.h
        return [study_run(self.case, self.a, h, **dict(self.overrides), time__cfl=cfl) for cfl in values]

    def with_values(self, **overrides: str) -> Column:
        """Return this column with other values; a double underscore stands for the dot of a key."""
        return replace(self, overrides=(*self.overrides, *overrides.items()))


@dataclass(frozen=True)
class Band:
    """The closed interval in which a quantity is accepted, taken from experiments, never from our own results."""

    lo: float
    hi: float
    source: str
    verified: bool = True  # whether its numbers were read in the publication

    def __contains__(self, value: float) -> bool:
        return self.lo <= value <= self.hi


@dataclass(frozen=True)
class Check:
    """One quantity of one experiment."""

    name: str
    experiment: str  # name in mpmcol.experiments
    quantity: str  # description
    unit: str
    column: Column
    measure: Measure
    band: Band
    controls: Mapping[str, Column]  # description of the error -> column whose value must be outside the band
    draw: Draw | None = None

    def runs(self, quick: bool) -> list[StudyRun]:
        """Return all runs; each negative control is run once, since its value is far outside."""
        controls = [run for column in self.controls.values() for run in column.runs(quick, repeated=False)]
        return self.column.runs(quick) + controls


@dataclass(frozen=True)
class ControlResult:
    """The value of a negative control."""

    label: str
    was_run: bool
    value: float | None
    is_inside: bool  # the band, which then does not discriminate


@dataclass(frozen=True)
class CheckResult:
    """The mean of the runs of a check, its standard error, the results of the controls, and the verdict."""

    check: Check
    verdict: Verdict
    value: float | None
    error: float | None
    runs: int
    at_rest: bool
    controls: list[ControlResult] = field(default_factory=list)
    first_run: CompletedRun | None = None  # shown in the chart


def evaluate_check(check: Check, completed: CompletedRuns, quick: bool) -> CheckResult:
    """Measure the runs of a check and of its controls."""
    planned = check.column.runs(quick)
    runs = [completed[run] for run in planned if run in completed]
    values = [value for run in runs if (value := check.measure(run)) is not None]
    complete = bool(values) and len(values) == len(runs)  # the mean of the runs with a value would be biased
    value = float(np.mean(values)) if complete else None
    error = float(sem(values)) if complete and len(values) > 1 else None
    controls = [_control(check, label, column, completed, quick) for label, column in check.controls.items()]
    at_rest = all(run.row["at_rest"] for run in runs)
    verdict, first = _verdict(check, len(runs) == len(planned), value, controls), completed.get(planned[0])
    return CheckResult(check, verdict, value, error, len(runs), at_rest, controls, first)


def _control(check: Check, label: str, column: Column, completed: CompletedRuns, quick: bool) -> ControlResult:
    (run,) = column.runs(quick, repeated=False)
    if run not in completed:
        return ControlResult(label, False, None, False)
    value = check.measure(completed[run])
    return ControlResult(label, True, value, value is not None and value in check.band)


def _verdict(check: Check, was_run: bool, value: float | None, controls: list[ControlResult]) -> Verdict:
    if not was_run or not all(control.was_run for control in controls):
        return "not run"
    if not check.band.verified:
        return "unverified"
    if value is None or value not in check.band:
        return "failed"
    return "inconclusive" if not controls or any(control.is_inside for control in controls) else "passed"
