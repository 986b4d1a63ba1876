"""Runs of shipped cases with some values replaced: what reports on several runs are made of."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpmcol.case import load_case
from mpmcol.io.results import Results
from mpmcol.io.run_status import read_status
from mpmcol.sweep.engine import Outcome, execute_runs
from mpmcol.sweep.runner import SweepObserver, run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run
from mpmcol.sweep.table import Row, make_rows

# The front is chaotic: runs whose time steps differ by a hundredth are as good as independent.
CFL_STEP = 0.03
SNAPSHOTS = "output.snapshots"
FEW = {SNAPSHOTS: "1"}


@dataclass(frozen=True)
class Member:
    """One run: a shipped case with some of its values replaced. Reports that share a run share its folder."""

    case: str
    a: float
    h: float  # node spacing asked for, m
    settings: tuple[tuple[str, str], ...] = tuple(FEW.items())  # key of the case, value

    def plan(self, out: Path) -> PlannedRun:
        """The run in a folder of `out`."""
        inputs: dict[str, Any] = {
            "case": self.case, "geometry.aspect": self.a, "grid.spacing": self.h, **dict(self.settings)
        }  # fmt: skip
        overrides = [f"{key}={value}" for key, value in list(inputs.items())[1:]]
        words = [f"{key.rpartition('.')[2]}-{value}" for key, value in self.settings if key != SNAPSHOTS]
        name = "-".join((self.case, f"a{self.a:g}", f"h{self.h * 1e3:g}mm", *words))
        return plan_run(load_case(self.case, overrides), out, inputs, name)


@dataclass(frozen=True)
class Finished:
    """A run that has ended well: its row in the table of a sweep, and its folder."""

    row: Row
    folder: Path

    @property
    def results(self) -> Results:
        """Everything that the run has written."""
        return Results(self.folder)


Found = Mapping[Member, Finished]  # members that failed are missing


def with_settings(case: str, a: float, h: float, **settings: str) -> Member:
    """A member with values replaced; two underscores in a key stand for its dot."""
    return Member(
        case, a, h, tuple({**FEW, **{key.replace("__", "."): value for key, value in settings.items()}}.items())
    )


def carry_out_members(
    members: Iterable[Member],
    out: Path,
    jobs: int | None = None,
    threads: int | None = None,
    observer: SweepObserver | None = None,
) -> tuple[list[Outcome], Found]:
    """Run each member once, completing what the folder `out` holds; how the runs ended, and those that ended well."""
    needed = list(dict.fromkeys(members))
    outcomes = run_sweep([member.plan(out) for member in needed], out, jobs, threads, observer=observer)
    return outcomes, _finished(needed, outcomes)


def find_members(members: Iterable[Member], out: Path) -> tuple[list[Outcome], Found]:
    """As `carry_out_members`, but nothing is run: those that have ended in the folder `out`."""
    points = {member: member.plan(out) for member in members}
    ended = {member: point for member, point in points.items() if read_status(point.folder).has_ended}
    outcomes = list(execute_runs(list(ended.values())))
    return outcomes, _finished(list(ended), outcomes)


def _finished(members: Sequence[Member], outcomes: Sequence[Outcome]) -> Found:
    return {
        member: Finished(row, outcome.run.folder)
        for member, outcome, row in zip(members, outcomes, make_rows(outcomes), strict=True)
        if outcome.status == "done"
    }
