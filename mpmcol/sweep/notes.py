"""Notes on the runs of a sweep: warnings about settings and results, each once, with the number of its runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from mpmcol.errors import OutputError
from mpmcol.io.names import RESULT_FILE
from mpmcol.io.run_status import read_result
from mpmcol.setup.unfit_settings import kind_of
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.runs import PlannedRun
from mpmcol.sweep.table import AGAIN


def notes_on_plan(runs: Sequence[PlannedRun]) -> list[str]:
    """Warnings about planned runs, as `counted_warnings`."""
    return counted_warnings([run.discretization.warnings for run in runs])


def notes_on_results(outcomes: Sequence[Outcome]) -> list[str]:
    """Warnings about the results of the runs that are done, without those about the plan, as `counted_warnings`."""
    return counted_warnings([list(_beyond_plan(outcome)) for outcome in outcomes])


def _beyond_plan(outcome: Outcome) -> Iterator[str]:
    if outcome.status == "done":
        planned = outcome.run.discretization.warnings
        yield from (warning for warning in stored_warnings(outcome.run.folder) if warning not in planned)


def stored_warnings(run: Path) -> list[str]:
    """The warnings in the result of a run; none if it has no result. Raises OutputError if that is damaged."""
    result, problem = read_result(run / RESULT_FILE)
    if problem:
        raise OutputError(f"{run / RESULT_FILE}: {problem}; {AGAIN}")
    return list((result or {}).get("warnings", ()))


def counted_warnings(by_run: Sequence[Sequence[str]]) -> list[str]:
    """The warnings of several runs with the number of runs that they apply to; of those of one kind, the first."""
    kinds: dict[str, dict[int, str]] = {}
    for run, warnings in enumerate(by_run):
        for warning in warnings:
            kinds.setdefault(kind_of(warning), {}).setdefault(run, warning)
    return [_counted(list(alike.values()), len(by_run)) for alike in kinds.values()]


def _counted(alike: Sequence[str], count: int) -> str:
    """The first of some warnings, with the number of runs unless it is the same for all."""
    if len(alike) == count and len(set(alike)) == 1:
        return alike[0]
    others = "" if len(set(alike)) == 1 else ", with the numbers of the first"
    return f"{alike[0]} ({len(alike)} of {count} runs{others})"
