"""The frame of all studies: carry out runs, evaluate them, write a report."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from shlex import quote
from typing import Generic, Protocol, TypeVar

from mpmcol.errors import UsageError
from mpmcol.io.atomic import atomic_write
from mpmcol.io.names import ENVIRONMENT_FILE
from mpmcol.provenance import environment
from mpmcol.studies.runs import EndedRuns, StudyRun, carry_out, find_ended
from mpmcol.sweep.engine import Outcome, unsuccessful
from mpmcol.sweep.runner import SweepObserver

RUNS = "runs"  # folder of the runs within that of the study

Evaluation = TypeVar("Evaluation")


class Study(Protocol[Evaluation]):
    """What a study declares: its runs, their evaluation, and its report."""

    def runs(self) -> Iterable[StudyRun]:
        """Return the runs that the study needs; equal ones are carried out once."""

    def evaluate(self, ended: EndedRuns) -> Evaluation:
        """Evaluate the runs that have ended, of which at least one is done."""

    def write_report(self, evaluation: Evaluation, heading: str, out: Path) -> Sequence[Path]:
        """Write tables, text and charts into the folder `out` and return the files.

        Args:
            heading: version of the code and name of the processor, for the first line of the text.
        """


@dataclass(frozen=True)
class StudyResult(Generic[Evaluation]):
    """How the runs of a study ended, their evaluation, and the files of the report."""

    outcomes: Sequence[Outcome]
    evaluation: Evaluation
    files: Sequence[Path]


def carry_out_study(
    study: Study[Evaluation],
    out: Path,
    *,
    jobs: int | None = None,
    threads: int | None = None,
    fresh: bool = False,
    observer: SweepObserver | None = None,
    report_only: bool = False,
) -> StudyResult[Evaluation]:
    """Carry out the runs of a study in `out`/runs, evaluate them and write the report into `out`.

    Runs that have already ended are not repeated unless `fresh`. With `report_only` nothing is run, and the report
    covers the runs that have ended.

    Raises:
        UsageError: `report_only` with `fresh`, or no run has ended.
        MpmcolError: no run was successful; the error has the exit code of the runs.
    """
    folder = out / RUNS
    if report_only and fresh:
        raise UsageError("--report-only runs nothing, and --fresh repeats all runs; give one of them")
    if report_only:
        ended = find_ended(study.runs(), folder)
    else:
        ended = carry_out(study.runs(), folder, jobs=jobs, threads=threads, fresh=fresh, observer=observer)
    outcomes = list(ended.outcomes.values())
    if report_only and not outcomes:
        raise UsageError(f"no run of the study has ended in {folder}; leave out --report-only to carry out the runs")
    if not ended.completed:
        raise unsuccessful(
            outcomes, f"no run of the study was successful; `mpmcol status {quote(str(folder))}` lists the causes"
        )
    evaluation, system = study.evaluate(ended), environment()
    files = study.write_report(evaluation, f"mpmcol {system['mpmcol']}; {system['cpu']}", out)
    atomic_write(out / ENVIRONMENT_FILE, (json.dumps(system, indent=1) + "\n").encode())
    return StudyResult(outcomes, evaluation, [*files, out / ENVIRONMENT_FILE])
