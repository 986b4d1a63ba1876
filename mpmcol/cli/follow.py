"""`mpmcol status --follow`: progress of runs that other processes execute, until they have ended."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from typing import Any

import click

from mpmcol.cli.sweep_display import RESOLUTION, progress_text
from mpmcol.errors import Interrupted, NumericalFailure, OutputError
from mpmcol.sweep.progress import ProgressTracker, TrackedRun, total_progress

INTERVAL = 1.0  # s between two readings of the files of the runs
PATIENCE = 30.0  # s without a run that is executed: a sweep compiles kernels and starts processes in between
CODES = {  # status of a run -> exit code, the first that applies
    "stopped": Interrupted.exit_code, "damaged": OutputError.exit_code, "failed": NumericalFailure.exit_code,
    "running": 1, "unfinished": 1, "missing": 1,
}  # fmt: skip


def follow_runs(tracker: ProgressTracker) -> None:
    """Show progress on stderr until all runs have ended, or until none is being executed any more.

    A terminal gets a bar; otherwise a line is printed for each ten per cent.
    """
    patience = PATIENCE if len(tracker.plan.runs) > 1 else 0.0
    show = _show_bar if sys.stderr.isatty() else _show_lines
    show(tracker, patience)


def state_code(runs: list[TrackedRun]) -> int:
    """The exit code for the state of runs; 0 if all are done."""
    found = {run.status.name for run in runs}
    return next((code for name, code in CODES.items() if name in found), 0)


def _active(tracker: ProgressTracker, patience: float) -> Iterator[list[TrackedRun]]:
    """The runs at each reading, as long as they are executed."""
    seen = time.monotonic()
    while True:
        runs = tracker.runs()
        yield runs
        if any(run.status.name == "running" for run in runs):
            seen = time.monotonic()
        elif all(run.status.has_ended for run in runs) or time.monotonic() - seen >= patience:
            return
        time.sleep(INTERVAL)


def _show_bar(tracker: ProgressTracker, patience: float) -> None:
    bar: Any = click.progressbar(length=RESOLUTION, file=sys.stderr, show_eta=False)
    with bar:
        for runs in _active(tracker, patience):
            bar.label = progress_text(runs, tracker.plan.jobs)
            bar.update(int(total_progress(runs) * RESOLUTION) - bar.pos)


def _show_lines(tracker: ProgressTracker, patience: float) -> None:
    shown = ""
    for runs in _active(tracker, patience):
        ended, tenths = sum(run.status.has_ended for run in runs), int(10.0 * total_progress(runs))
        if (key := f"{ended} {tenths}") != shown:
            shown = key
            click.echo(f"{10 * tenths} %: {progress_text(runs, tracker.plan.jobs)}", err=True)
