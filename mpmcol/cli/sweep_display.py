"""What a person sees of a sweep: one bar with the time left, or a line for each point, and the table at the end."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from types import FrameType
from typing import Any

import click

from mpmcol.cli.duration import duration
from mpmcol.errors import Interrupted
from mpmcol.measure import FRONTS
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.plan import Plan
from mpmcol.sweep.progress import Part, Progress, share_done, time_left
from mpmcol.sweep.report import SweepReport
from mpmcol.sweep.runner import SweepObserver
from mpmcol.sweep.table import Row

RECORD_SCHEMA = 1
LOOK_SECONDS = 1.0  # between two looks at the files of the runs
RESOLUTION = 1000  # of the bar
MOST_ROWS = 60
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGHUP)  # a lost terminal is a wish to end, too
AT_ONCE = 2  # wishes


class Display(SweepObserver):
    """Messages on stderr: a bar if that is a terminal, otherwise a line for each point that ends."""

    def __init__(self, out: Path, quiet: bool) -> None:
        self.out, self.quiet = out, quiet
        self.has_bar = sys.stderr.isatty() and not quiet
        self._stack = ExitStack()
        self._bar: Any = None
        self._progress: Progress | None = None
        self._jobs = 1
        self._ended_before: set[str] = set()
        self._looked = 0.0
        self._wishes = 0  # to end

    def __enter__(self) -> Display:
        for number in SIGNALS:
            if signal.getsignal(number) is not signal.SIG_IGN:  # as for a sweep that was started with nohup
                signal.signal(number, self._note)
        return self

    def __exit__(self, kind: type[BaseException] | None, *error: object) -> None:
        """Where the runs were ended in good order, say how to go on, as of a run."""
        self._stack.close()
        if kind is KeyboardInterrupt and self._wishes < AT_ONCE:
            raise Interrupted("stopped in good order; the same command again completes the sweep") from None

    def say(self, line: str) -> None:
        """One line, where the bar was."""
        self._stack.close()
        self._bar = None
        if not self.quiet:
            click.echo(line, err=True)

    def begin(self, plan: Plan) -> None:
        """From now on there are runs to look at."""
        self._progress, self._jobs = Progress(self.out, plan), plan.jobs
        self._ended_before = {part.point.folder for part in self._parts() if part.state.has_ended}

    def ended(self, outcome: Outcome) -> None:
        """Tell of a point that has ended now; above a bar only if it went wrong."""
        ending, parts = outcome.result, self._parts()
        if outcome.run.folder.name not in self._ended_before and (ending.status != "done" or not self.has_bar):
            why = f": {ending.message}" if ending.message else ""
            self.say(f"{outcome.run.name} {ending.status}{why} ({how_far(parts, self._jobs)})")

    def tick(self) -> None:
        """Look at the runs once a second and move the bar."""
        if not self.has_bar or time.monotonic() - self._looked < LOOK_SECONDS:
            return
        self._looked = time.monotonic()
        parts = self._parts()
        if self._bar is None:
            bar: Any = click.progressbar(length=RESOLUTION, file=sys.stderr, show_eta=False)
            self._bar = self._stack.enter_context(bar)
        self._bar.label = how_far(parts, self._jobs)
        self._bar.update(int(share_done(parts) * RESOLUTION) - self._bar.pos)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self._wishes += 1
        raise KeyboardInterrupt

    def _parts(self) -> list[Part]:
        return self._progress.parts() if self._progress else []


def how_far(parts: list[Part], jobs: int) -> str:
    """Points that have ended, and the time left where it can be told."""
    ended, left = sum(part.state.has_ended for part in parts), time_left(parts, jobs)
    return f"{ended} of {len(parts)} points" + (f", about {duration(left)} left" if left else "")


def as_record(published: SweepReport) -> dict[str, Any]:
    """The sweep for JSON."""
    return {
        "schema": RECORD_SCHEMA,
        "folder": str(published.folder),
        "points": published.rows,
        "slopes": [asdict(slope) for slope in published.slopes],
        "files": [str(path) for path in published.files],
    }


def closing_lines(published: SweepReport) -> Iterator[str]:
    """Runout and height of every point beside the law, fitted slopes, what went wrong, and the files."""
    rows = published.rows
    names = [row["folder"].rpartition("-")[0] for row in rows]
    width = max(map(len, names))
    yield f"{'':{width}}  zeta: max  connected   height      law     beta      law     time"
    for name, row in list(zip(names, rows, strict=True))[:MOST_ROWS]:
        yield f"{name:{width}}  {_numbers(row)}"
    if len(rows) > MOST_ROWS:
        yield f"... and {len(rows) - MOST_ROWS} more"
    yield from (f"{slope.series + ': ' if slope.series else ''}{slope}" for slope in published.slopes)
    yield from failures(published)
    yield f"in {published.folder}: " + ", ".join(path.name for path in published.files)


def failures(published: SweepReport) -> Iterator[str]:
    """A line for each point that is not done."""
    for row in published.rows:
        if row["status"] != "done":
            yield f"{row['folder']} {row['status']}: {row['message']}"


def _numbers(row: Row) -> str:
    if row["status"] != "done":
        return str(row["status"])
    columns = [*(f"zeta.{front}" for front in FRONTS), "law.zeta", "beta", "law.beta"]
    cells = "".join(f"{'none':>9}" if row[name] is None else f"{row[name]:9.3f}" for name in columns)
    return f"{cells}{duration(row['seconds']):>9}" + ("" if row["at_rest"] else "  not at rest")
