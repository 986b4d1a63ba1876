"""Terminal output of a run: its progress, and the estimate of its cost."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import format_duration

if TYPE_CHECKING:
    from mpmcol.case import Case
    from mpmcol.setup.cost import Estimate

MEASURING_SPEED = "measuring the speed of this machine (half a second, more if kernels must be compiled) ..."


class RunDisplay:
    """One line per stage on stdout, and a progress bar with the remaining time on stderr.

    A run continues without them if the reader of a pipe or the terminal is gone, or the disk of a log is full.
    """

    RESOLUTION = 1000  # of the bar

    def __init__(self, silent: bool) -> None:
        self.silent = silent
        self._stack = ExitStack()
        self._stage, self._done = "", 0
        self._bar: Any = None

    def __enter__(self) -> RunDisplay:
        return self

    def __exit__(self, *error: object) -> None:
        self._close_bar()

    def notify(self, line: str) -> None:
        """Print one line, and end the bar of the present stage."""
        self._close_bar()
        self._stage = ""
        if not self.silent:
            with suppress(OSError):
                click.echo(line)

    def progress(self, stage: str, fraction: float) -> None:
        """Show the fraction of a stage that is done."""
        if self.silent:
            return
        with suppress(OSError):
            if stage != self._stage:
                self._start(stage)
            done = min(int(fraction * self.RESOLUTION), self.RESOLUTION)
            if done > self._done and self._bar is not None:
                self._bar.update(done - self._done)
                self._done = done

    def _close_bar(self) -> None:
        with suppress(OSError):
            self._stack.close()
        self._bar = None

    def _start(self, stage: str) -> None:
        self._close_bar()
        self._stage, self._done = stage, 0
        bar: Any = click.progressbar(length=self.RESOLUTION, label=stage, file=sys.stderr, show_eta=True)
        self._bar = self._stack.enter_context(bar)


def print_estimate(case: Case, threads: int | None, to_json: bool) -> None:
    """Print what a run of the case would cost."""
    from mpmcol.setup.cost import estimate

    click.echo(MEASURING_SPEED, err=True)
    cost = estimate(case, threads)
    if to_json:
        click.echo(json.dumps(asdict(cost)))
        return
    for warning in cost.warnings:
        click.echo(f"note: {warning}")
    for name, value in _estimate_rows(cost):
        click.echo(f"{name:26s} {value}")
    click.echo("nothing was run")


def _estimate_rows(cost: Estimate) -> Iterator[tuple[str, str]]:
    tiles = cost.tiles_of_group
    yield "material points", f"{cost.points:,} ({cost.column_points:,} in the column)"
    yield "active grid nodes", f"{cost.nodes:,}"
    yield "parallelism", f"{sum(tiles) / len(tiles):.0f} tiles at a time on average, in {len(tiles)} groups"
    yield "time step", f"{cost.dt:.4g} s"
    yield "steps", f"about {cost.steps:,}, at most {cost.most_steps:,}"
    yield "memory", f"{cost.memory_bytes / 1e6:,.0f} MB"
    yield "disk", f"{cost.disk_bytes / 1e6:,.0f} MB"
    yield "speed, measured now", f"{cost.ns_per_point_step:.0f} ns per point and step"
    yield "time", f"about {format_duration(cost.seconds)}, at most {format_duration(cost.most_seconds)}"
