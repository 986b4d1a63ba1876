"""Terminal output of a sweep: a progress bar or one line per run, and the table at the end."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import asdict
from pathlib import Path
from types import FrameType
from typing import Any

import click

from mpmcol.cli.streams import report
from mpmcol.errors import Interrupted
from mpmcol.simulation.interrupt import REPEATED, SIGNALS
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.plan import Plan
from mpmcol.sweep.progress import ProgressTracker, TrackedRun, time_left, total_progress
from mpmcol.sweep.report import SweepReport
from mpmcol.sweep.runner import SweepObserver
from mpmcol.sweep.table import FINER_GRIDS, Row
from mpmcol.units import duration_text

RECORD_SCHEMA = 2
UPDATE_SECONDS = 1.0  # between two readings of the files of the runs
RESOLUTION = 1000  # of the bar
MOST_ROWS = 60
CELL = 11  # width of a column
COLUMNS = {  # of the table of a sweep -> heading; finer grids: of runs with an accuracy
    "zeta.front_max": "zeta: max", "zeta.front_connected": "connected", "zeta.front_height": "height",
    f"zeta.{FINER_GRIDS}": "finer grid", "law.zeta": "law", "beta": "beta", f"beta.{FINER_GRIDS}": "finer grid",
    "law.beta": "law",
}  # fmt: skip
ABORTING = 2  # number of signals that abort the runs instead of stopping them


class SweepDisplay(SweepObserver):
    """Messages on stderr: a progress bar if it is a terminal, otherwise a line for each run that ends.

    As a context it also handles signals, which stop the sweep. A sweep continues without messages if the reader of a
    pipe or the terminal is gone, or the disk of a log is full.
    """

    def __init__(self, out: Path, quiet: bool) -> None:
        self.out, self.quiet = out, quiet
        self.has_bar = sys.stderr.isatty() and not quiet
        self._stack = ExitStack()
        self._bar: Any = None
        self._tracker: ProgressTracker | None = None
        self._jobs = 1
        self._ended_before: set[str] = set()
        self._updated = 0.0
        self._signals = 0
        self._previous: dict[signal.Signals, Any] = {}  # handlers of the caller

    def __enter__(self) -> SweepDisplay:
        for number in SIGNALS:
            # Ignored signals stay ignored, for example under nohup; handlers in C cannot be restored.
            if signal.getsignal(number) not in (signal.SIG_IGN, None):
                self._previous[number] = signal.signal(number, self._interrupt)
        return self

    def __exit__(self, kind: type[BaseException] | None, *error: object) -> None:
        """Convert an interruption after which all runs wrote a checkpoint into an Interrupted error."""
        self._close_bar()
        for number, handler in self._previous.items():
            signal.signal(number, handler)
        if kind is KeyboardInterrupt and self._signals < ABORTING:
            raise Interrupted("stopped with checkpoints; repeat the command to complete the runs") from None

    def notify(self, line: str) -> None:
        """Print one line, in the place of the bar."""
        self._close_bar()
        if not self.quiet:
            report(line)

    def started(self, plan: Plan) -> None:
        """Start to track the runs."""
        self._tracker, self._jobs = ProgressTracker(self.out, plan), plan.jobs
        self._ended_before = {run.entry.folder for run in self._runs() if run.status.has_ended}

    def run_ended(self, outcome: Outcome) -> None:
        """Report a run that ended now; with a bar, only if it is not done."""
        result = outcome.result
        if outcome.run.folder.name in self._ended_before or (self.has_bar and result.status == "done"):
            return
        reason = f": {result.message}" if result.message else ""
        self.notify(f"{outcome.run.name} {result.status}{reason} ({progress_text(self._runs(), self._jobs)})")

    def tick(self) -> None:
        """Update the bar once a second."""
        if not self.has_bar or time.monotonic() - self._updated < UPDATE_SECONDS:
            return
        self._updated = time.monotonic()
        with suppress(OSError):
            self._update_bar(self._runs())

    def _update_bar(self, runs: list[TrackedRun]) -> None:
        if self._bar is None:
            bar: Any = click.progressbar(length=RESOLUTION, file=sys.stderr, show_eta=False)
            self._bar = self._stack.enter_context(bar)
        self._bar.label = progress_text(runs, self._jobs)
        self._bar.update(int(total_progress(runs) * RESOLUTION) - self._bar.pos)

    def _close_bar(self) -> None:
        with suppress(OSError):
            self._stack.close()
        self._bar = None

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if self._signals and number in REPEATED:
            return
        self._signals += 1
        raise KeyboardInterrupt

    def _runs(self) -> list[TrackedRun]:
        return self._tracker.runs() if self._tracker else []


def progress_text(runs: list[TrackedRun], jobs: int) -> str:
    """Number of runs that have ended, and the remaining time if it is known."""
    ended, left = sum(run.status.has_ended for run in runs), time_left(runs, jobs)
    return f"{ended} of {len(runs)} runs" + (f", about {duration_text(left)} left" if left else "")


def as_record(report: SweepReport) -> dict[str, Any]:
    """The report for JSON."""
    return {
        "schema": RECORD_SCHEMA,
        "folder": str(report.folder),
        "runs": report.rows,
        "slopes": [asdict(slope) for slope in report.slopes],
        "files": [str(path) for path in report.files],
        "notes": report.notes,
    }


def summary_lines(report: SweepReport) -> Iterator[str]:
    """Runout and height of every run and by the law, fitted slopes, failures, and the files."""
    rows = report.rows
    names = [row["folder"].rpartition("-")[0] for row in rows]
    width = max(map(len, names))
    columns = {name: heading for name, heading in COLUMNS.items() if name in rows[0]}
    yield f"{'':{width}}" + "".join(f"{heading:>{CELL}}" for heading in (*columns.values(), "time"))
    for name, row in list(zip(names, rows, strict=True))[:MOST_ROWS]:
        yield f"{name:{width}}{_numbers(row, list(columns))}"
    if len(rows) > MOST_ROWS:
        yield f"... and {len(rows) - MOST_ROWS} more"
    yield from (f"{slope.series + ': ' if slope.series else ''}{slope}" for slope in report.slopes)
    yield from failures(report)
    yield from (f"note: {note}" for note in report.notes)
    yield f"in {report.folder}: " + ", ".join(path.name for path in report.files)


def failures(report: SweepReport) -> Iterator[str]:
    """A line for each run that is not done."""
    for row in report.rows:
        if row["status"] != "done":
            yield f"{row['folder']} {row['status']}: {row['message']}"


def _numbers(row: Row, columns: Sequence[str]) -> str:
    if row["status"] != "done":
        return f"  {row['status']}"
    cells = "".join(f"{'none':>{CELL}}" if row[name] is None else f"{row[name]:{CELL}.3f}" for name in columns)
    return f"{cells}{duration_text(row['seconds']):>{CELL}}" + _remarks(row)


def _remarks(row: Row) -> str:
    rest = "" if row["at_rest"] else "  not at rest"
    return rest + (f"  law of {row['law.unverified']} unverified" if row["law.unverified"] else "")
