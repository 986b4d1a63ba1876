"""Terminal output of a run: its progress, and the estimate of its cost."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.io.atomic import free_bytes
from mpmcol.io.run_log import ProgressLines, TimeLeft
from mpmcol.io.values import to_json as as_json
from mpmcol.units import duration_text

if TYPE_CHECKING:
    from mpmcol.case import Case
    from mpmcol.setup.cost import Estimate

ESTIMATE_SCHEMA = 1
MEASURING_SPEED = "measuring the speed of this machine (half a second, more if kernels must be compiled) ..."


class RunDisplay:
    """Messages and progress on stderr: a bar with the remaining time if it is a terminal, otherwise lines of text.

    A run continues without them if the reader of a pipe or the terminal is gone, or the disk of a log is full.
    """

    RESOLUTION = 1000  # of the bar

    def __init__(self, quiet: bool) -> None:
        self.quiet = quiet
        self._stack = ExitStack()
        self._stage, self._done = "", 0
        self._bar: Any = None
        self._left = TimeLeft(0.0)
        self._lines = None if sys.stderr.isatty() else ProgressLines(self.notify)

    def __enter__(self) -> RunDisplay:
        return self

    def __exit__(self, *error: object) -> None:
        self._close_bar()

    def notify(self, line: str) -> None:
        """Print one line, and end the bar of the present stage."""
        self._close_bar()
        self._stage = ""
        if not self.quiet:
            with suppress(OSError):
                click.echo(line, err=True)

    def progress(self, stage: str, fraction: float) -> None:
        """Show the fraction of a stage that is done."""
        if self._lines:
            self._lines(stage, fraction)
        elif not self.quiet:
            with suppress(OSError):
                self._update_bar(stage, fraction)

    def _close_bar(self) -> None:
        with suppress(OSError):
            self._stack.close()
        self._bar = None

    def _update_bar(self, stage: str, fraction: float) -> None:
        if stage != self._stage:
            self._close_bar()
            self._stage, self._done, self._left = stage, 0, TimeLeft(fraction)
            bar: Any = click.progressbar(length=self.RESOLUTION, label=stage, file=sys.stderr, show_eta=False)
            self._bar = self._stack.enter_context(bar)
        done = min(int(fraction * self.RESOLUTION), self.RESOLUTION)
        if done > self._done:
            self._bar.label = ", ".join(filter(None, (stage, self._left.text(fraction))))
            self._bar.update(done - self._done)
            self._done = done


def print_estimate(case: Case, folder: Path, threads: int | None, *, to_json: bool, quiet: bool) -> None:
    """Print what a run of the case in this folder would cost."""
    from mpmcol.setup.cost import estimate

    if not quiet:
        click.echo(MEASURING_SPEED, err=True)
    cost = estimate(case, threads)
    if to_json:
        click.echo(as_json({"schema": ESTIMATE_SCHEMA, **asdict(cost)}))
        return
    for warning in cost.warnings:
        click.echo(f"note: {warning}")
    free = free_bytes(folder)
    if cost.disk_bytes > free:
        click.echo(
            f"note: the results need about {cost.disk_bytes / 1e6:,.0f} MB, and {free / 1e6:,.0f} MB are free; set "
            "fewer output.snapshots, or choose another folder with --out"
        )
    for name, value in _estimate_rows(cost):
        click.echo(f"{name:26s} {value}")
    click.echo("nothing was run")


def _estimate_rows(cost: Estimate) -> Iterator[tuple[str, str]]:
    tiles = cost.tiles_of_group
    yield "material points", f"{cost.points:,} ({cost.column_points:,} in the column)"
    yield "active grid nodes", f"{cost.nodes:,}"
    yield "useful threads", f"at most {max(sum(tiles) // len(tiles), 1)}"
    yield "time step", f"{cost.dt:.4g} s"
    yield "steps", f"about {cost.steps:,}, at most {cost.most_steps:,}"
    yield "memory", f"{cost.memory_bytes / 1e6:,.0f} MB"
    yield "disk", f"{cost.disk_bytes / 1e6:,.0f} MB"
    yield "speed, measured now", f"{cost.ns_per_point_step:.0f} ns per point and step"
    yield "time", f"about {duration_text(cost.seconds)}, at most {duration_text(cost.most_seconds)}"
