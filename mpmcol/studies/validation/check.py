"""A check: what is run, what number is measured, which band it must lie in, and what must lie outside of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np

from mpmcol.studies.runs import Finished, Found, Member, with_settings

# Fronts are chaotic: runs that differ in the time step alone scatter by some per cent, so that each is repeated.
TIME_STEPS = ("0.46", "0.48", "0.5", "0.52")
ALONE = ("0.5",)

Verdict = Literal["passed", "failed", "proves nothing", "not run", "unverified"]
Measure = Callable[[Finished], float | None]  # None: there is no such number, as of a front that never stops


@dataclass(frozen=True)
class Column:
    """A shipped case at an aspect ratio, some of its values replaced, and its two spacings."""

    case: str
    a: float
    h: float  # node spacing, m
    quick_h: float
    settings: tuple[tuple[str, str], ...] = ()

    def members(self, quick: bool, repeated: bool = True) -> list[Member]:
        """Its runs: one, or one for each time step."""
        steps = TIME_STEPS if repeated and not quick else ALONE
        h = self.quick_h if quick else self.h
        return [with_settings(self.case, self.a, h, **dict(self.settings), time__cfl=step) for step in steps]

    def but(self, **settings: str) -> Column:
        """This column with other values; two underscores in a key stand for its dot."""
        return replace(self, settings=(*self.settings, *settings.items()))


@dataclass(frozen=True)
class Band:
    """Where a number must lie, ends included, and who says so: never our own results.

    A check neither passes nor fails by a band whose source is unverified.
    """

    lo: float
    hi: float
    source: str
    verified: bool = True

    def __contains__(self, value: float) -> bool:
        return self.lo <= value <= self.hi


@dataclass(frozen=True)
class Check:
    """One number of one experiment."""

    name: str
    experiment: str  # name in mpmcol.experiments
    number: str  # what is measured, in words
    unit: str
    column: Column
    measure: Measure
    band: Band
    controls: Mapping[str, Column]  # what is wrong with them -> columns whose number must lie outside the band
    draw: Callable[[Path, Finished, float], object] | None = None  # of the first run, to a file, with the band's width

    def members(self, quick: bool) -> list[Member]:
        """All runs; a control is run once, since it is to be far off."""
        controls = [member for column in self.controls.values() for member in column.members(quick, repeated=False)]
        return self.column.members(quick) + controls


@dataclass(frozen=True)
class Control:
    """A run that is wrong on purpose."""

    label: str
    ran: bool
    value: float | None
    accepted: bool  # by the band, which has then shown nothing


@dataclass(frozen=True)
class Judgement:
    """A check and what came of it: the mean of its runs, that mean's standard error, and its controls."""

    check: Check
    verdict: Verdict
    value: float | None
    error: float | None
    runs: int
    at_rest: bool
    controls: list[Control] = field(default_factory=list)


def judge(check: Check, found: Found, quick: bool) -> Judgement:
    """Measure the runs of a check and of its controls."""
    runs = [found[member] for member in check.column.members(quick) if member in found]
    values = [value for run in runs if (value := check.measure(run)) is not None]
    complete = bool(values) and len(values) == len(runs)  # a mean without a front that never stopped would flatter
    value = float(np.mean(values)) if complete else None
    error = float(np.std(values, ddof=1) / np.sqrt(len(values))) if complete and len(values) > 1 else None
    controls = [_control(check, label, column, found, quick) for label, column in check.controls.items()]
    at_rest = all(run.row["at_rest"] for run in runs)
    return Judgement(check, _verdict(check, len(runs), value, controls), value, error, len(runs), at_rest, controls)


def _control(check: Check, label: str, column: Column, found: Found, quick: bool) -> Control:
    (member,) = column.members(quick, repeated=False)
    if member not in found:
        return Control(label, False, None, False)
    value = check.measure(found[member])
    return Control(label, True, value, value is not None and value in check.band)


def _verdict(check: Check, runs: int, value: float | None, controls: list[Control]) -> Verdict:
    if not runs or not all(control.ran for control in controls):
        return "not run"
    if not check.band.verified:
        return "unverified"
    if value is None or value not in check.band:
        return "failed"
    return "proves nothing" if not controls or any(control.accepted for control in controls) else "passed"
