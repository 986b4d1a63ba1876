"""mpmcol run: simulate a case from gravity to rest."""

from __future__ import annotations

import json
import os
import sys
from contextlib import ExitStack
from math import inf
from pathlib import Path
from typing import Any, Literal

import click
from click.core import ParameterSource

from mpmcol.cli.accuracy import ACCURACY, advised, certified
from mpmcol.cli.duration import DURATION, duration
from mpmcol.cli.option_types import THREADS
from mpmcol.errors import Interrupted, NumericalFailure

OF_ONE_RUN = ("fresh", "force_resume", "checkpoint", "max_wall", "on_instability", "requeue_code", "dry_run")


@click.command()
@click.argument("case")
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Replace a value, e.g. geometry.aspect=5.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the results; runs/NAME by default.")
@click.option("--accuracy", type=ACCURACY, help="Choose model and grid so that runout and height keep to it, e.g. 5%.")
@click.option("--certify", is_flag=True, help="With --accuracy: zeta and beta with an error bar, from two spacings.")
@click.option("--threads", type=THREADS, help="Number of threads; all cores by default.")
@click.option("--fresh", is_flag=True, help="Begin anew: replace a finished run, forget an unfinished one.")
@click.option("--force-resume", is_flag=True, help="Resume an unfinished run even if the case or the code has changed.")
@click.option("--checkpoint", type=DURATION, default="5min", show_default=True, help="Time between two checkpoints.")
@click.option("--max-wall", type=DURATION, help="Stop after this time, e.g. 2h; the same command goes on.")
@click.option(
    "--on-instability",
    type=click.Choice(["stop", "retry"]),
    default="stop",
    show_default=True,
    help="What to do where the run goes wrong: stop, or go on from the last good state with half the time step.",
)
@click.option("--requeue-code", type=click.IntRange(0, 255), help="Exit code of a run that was stopped, instead of 75.")
@click.option("--dry-run", is_flag=True, help="Check everything and say what the run will cost; write nothing.")
@click.option("--json", "as_json", is_flag=True, help="Print result.json as one line on stdout.")
@click.option("--quiet", is_flag=True, help="Print nothing but errors.")
def run(
    case: str,
    overrides: tuple[str, ...],
    out: Path | None,
    accuracy: float | None,
    certify: bool,
    threads: int | None,
    fresh: bool,
    force_resume: bool,
    checkpoint: float,
    max_wall: float | None,
    on_instability: Literal["stop", "retry"],
    requeue_code: int | None,
    dry_run: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Simulate CASE, a TOML file or a shipped case (`mpmcol cases`), and measure runout and height.

    Stages: equilibrate under gravity behind the gate, release, collapse, rest. Results go to a folder that
    `mpmcol measure`, `plot` and `render` read. With --accuracy 5% the setting is the cheapest that kept to it in
    `mpmcol pareto`, whose errors are those of discretisation, not of the model.

    A run that was stopped, or killed, goes on where it was when the same command is given again, and ends with equal
    bits. Ctrl-C, SIGTERM, SIGUSR1 and --max-wall stop it in good order (exit code 75), a second Ctrl-C at once.

    A run that goes wrong stops with cause, place and remedy (exit code 3) and keeps its last good state as a snapshot;
    with --on-instability retry it first goes back to a good state with half of time.cfl, at most four times.
    """
    if certify:
        _check_certify(accuracy)
    if threads is not None:
        os.environ.setdefault("NUMBA_NUM_THREADS", str(max(threads, os.cpu_count() or 1)))
    from mpmcol.case import case_hash, load_case

    if accuracy is not None:
        advice = advised(case, overrides, accuracy, silent=quiet or as_json)
        if certify:
            folder = out or Path("runs") / f"{Path(case).stem}-certified"
            certified(case, overrides, advice, folder, threads, as_json, quiet)
        overrides = (*overrides, *advice.overrides)
    loaded = load_case(case, overrides)
    if dry_run:
        _print_estimate(loaded, threads, as_json)
        return
    stem = Path(case).stem
    folder = out or Path("runs") / (f"{stem}-{case_hash(loaded)[:6]}" if overrides else stem)
    reporter = Reporter(quiet or as_json)
    from mpmcol.io.results import Results
    from mpmcol.simulation.run import run as simulate

    try:
        with reporter:
            results = simulate(
                loaded, folder, threads=threads, fresh=fresh, force_resume=force_resume, checkpoint_seconds=checkpoint,
                max_wall=inf if max_wall is None else max_wall, on_instability=on_instability,
                progress=reporter.progress, notify=reporter.say,
            )  # fmt: skip
    except Interrupted as end:
        if requeue_code is not None:
            end.exit_code = requeue_code
        raise
    except NumericalFailure:
        if as_json:
            click.echo(json.dumps(Results(folder).summary))
        raise
    if as_json:
        click.echo(json.dumps(results.summary))
    elif not quiet:
        from mpmcol.cli.report import closing_table

        click.echo(closing_table(results))
        click.echo(f"results in {folder}; next: mpmcol plot {folder}, mpmcol render {folder}")


def _check_certify(accuracy: float | None) -> None:
    """Refuse what makes no sense with --certify, which is a sweep of six runs."""
    if accuracy is None:
        raise click.UsageError("--certify goes with --accuracy, which chooses the grid")
    context = click.get_current_context()
    given = [name for name in OF_ONE_RUN if context.get_parameter_source(name) is ParameterSource.COMMANDLINE]
    if given:
        raise click.UsageError(f"--{given[0].replace('_', '-')} is of one run, and --certify makes six: leave one out")


class Reporter:
    """One line per stage on stdout, and a progress bar with the time left on stderr while a stage runs."""

    RESOLUTION = 1000

    def __init__(self, silent: bool) -> None:
        self.silent = silent
        self._stack = ExitStack()
        self._stage, self._done = "", 0
        self._bar: Any = None

    def __enter__(self) -> Reporter:
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.close()

    def say(self, line: str) -> None:
        """Print one line, after the bar of the stage that it closes."""
        self._stack.close()
        self._stage = ""
        if not self.silent:
            click.echo(line)

    def progress(self, stage: str, share: float) -> None:
        """Show how far a stage is."""
        if self.silent:
            return
        if stage != self._stage:
            self._start(stage)
        done = min(int(share * self.RESOLUTION), self.RESOLUTION)
        if done > self._done and self._bar is not None:
            self._bar.update(done - self._done)
            self._done = done

    def _start(self, stage: str) -> None:
        self._stack.close()
        self._stage, self._done = stage, 0
        bar: Any = click.progressbar(length=self.RESOLUTION, label=stage, file=sys.stderr, show_eta=True)
        self._bar = self._stack.enter_context(bar)


def _print_estimate(case: Any, threads: int | None, as_json: bool) -> None:
    from dataclasses import asdict

    from mpmcol.setup.cost import estimate

    click.echo("measuring the pace of this machine (about a second, more if kernels must be compiled) ...", err=True)
    cost = estimate(case, threads)
    if as_json:
        click.echo(json.dumps(asdict(cost)))
        return
    for warning in cost.warnings:
        click.echo(f"note: {warning}")
    tiles = cost.tiles_of_group
    rows = (
        ("material points", f"{cost.points:,} ({cost.column_points:,} in the column)"),
        ("grid nodes near material", f"{cost.nodes:,}"),
        ("parallel", f"{sum(tiles) / len(tiles):.0f} tiles at a time on average, in {len(tiles)} groups"),
        ("time step", f"{cost.dt:.4g} s"),
        ("steps", f"about {cost.steps:,}, at most {cost.most_steps:,}"),
        ("memory", f"{cost.memory_bytes / 1e6:,.0f} MB"),
        ("disk", f"{cost.disk_bytes / 1e6:,.0f} MB"),
        ("pace, measured now", f"{cost.ns_per_point_step:.0f} ns per point and step"),
        ("time", f"about {duration(cost.seconds)}, at most {duration(cost.most_seconds)}"),
    )
    for name, value in rows:
        click.echo(f"{name:26s} {value}")
    click.echo("nothing was run")
