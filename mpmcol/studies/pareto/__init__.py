"""Cost against error: every choice of model and method on one chart, from a study in a TOML file.

Two errors are kept apart. *Discretisation*: how far a run is from the converged value of its scene, which two families
of settings that are refined independently agree on, with an uncertainty. *Model*: how far that value is from the
experiment, whose own scatter no work gets under.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.errors import MpmcolError, UsageError
from mpmcol.studies.pareto.configurations import Setting, settings_of
from mpmcol.studies.pareto.report import write_report
from mpmcol.studies.pareto.score import Scored, score_study
from mpmcol.studies.pareto.study import Study
from mpmcol.studies.runs import carry_out_members, find_members
from mpmcol.sweep.engine import Outcome, unsuccessful
from mpmcol.sweep.runner import SweepObserver

RUNS = "runs"


@dataclass(frozen=True)
class Studied:
    """What came of a study, and the files that were written."""

    outcomes: Sequence[Outcome]
    scored: Sequence[Scored]
    files: Sequence[Path]


def carry_out_study(
    study: Study, out: Path, jobs: int | None = None, observer: SweepObserver | None = None, report_only: bool = False
) -> Studied:
    """Run what the study needs into `out`/runs, completing what is there, and write its report into `out`.

    Every run has one thread. With `report_only` nothing is run: the report is on the runs that have ended. Raises
    UsageError if a setting makes no case that can be run, OutputError if no run ended well.
    """
    settings = list(settings_of(study))
    _check(settings, out)
    members = [member for setting in settings for member in setting.members]
    if report_only:
        outcomes, found = find_members(members, out / RUNS)
    else:
        outcomes, found = carry_out_members(members, out / RUNS, jobs, 1, observer)
    if not found and report_only:
        raise UsageError(f"no run of the study has ended in {out / RUNS}; leave --report-only out")
    if not found:
        raise unsuccessful(outcomes, f"no run of the study ended well; mpmcol status {out / RUNS} says why")
    ended = {outcome.run.folder: outcome for outcome in outcomes}
    failures = {
        member: outcome.result.message
        for member in members
        if (outcome := ended.get(member.plan(out / RUNS).folder)) and outcome.status != "done"
    }
    references, scored = score_study(study, settings, found, failures)
    return Studied(outcomes, scored, write_report(study, references, scored, out))


def _check(settings: Iterable[Setting], out: Path) -> None:
    for setting in settings:
        try:
            setting.members[0].plan(out)
        except MpmcolError as error:
            raise UsageError(f"{setting}:\n{error}") from None
