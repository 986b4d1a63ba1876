"""mpmcol sweep: many runs that differ in some values, as one."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.duration import duration
from mpmcol.cli.option_types import JOBS, THREADS

if TYPE_CHECKING:
    from mpmcol.sweep.runs import PlannedRun


@click.command()
@click.argument("case", default="lube-cylinder")
@click.option("--aspect", metavar="VALUES", help="Aspect ratios, e.g. 0.5:7, the same as --set geometry.aspect=0.5:7.")
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUES", help="Vary or replace a value of the case.")
@click.option("--zip", "zipped", is_flag=True, help="First values of all axes, second of all, ...; not all with all.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the sweep; sweeps/NAME by default.")
@click.option("--jobs", type=JOBS, help="Points at a time; chosen from their sizes by default.")
@click.option("--threads", type=THREADS, help="Threads of each point; chosen from their sizes by default.")
@click.option(
    "--engine", type=click.Choice(["local", "dask", "commands"]), default="local", show_default=True,
    help="This machine, a dask cluster, or only print the shell lines and write a Slurm array script.",
)  # fmt: skip
@click.option("--scheduler", metavar="ADDRESS", help="Of the dask cluster, e.g. tcp://10.0.0.1:8786.")
@click.option("--dry-run", is_flag=True, help="Check everything and say what the sweep will cost; write nothing.")
@click.option("--json", "to_json", is_flag=True, help="Print table, slopes and files as one line on stdout.")
@click.option("--quiet", is_flag=True, help="Print nothing but errors.")
def sweep(
    case: str,
    aspect: str | None,
    settings: tuple[str, ...],
    zipped: bool,
    out: Path | None,
    jobs: int | None,
    threads: int | None,
    engine: str,
    scheduler: str | None,
    dry_run: bool,
    to_json: bool,
    quiet: bool,
) -> None:
    """Run CASE (default: the paper's cylinder) for many values, and table and chart runout and height.

    VALUES are single ones and ranges, separated by commas: 0.5:7 (steps of 0.5), 0.5:7:0.25, 0.5:7/14 (14 values),
    0.55,0.9,1.7:3:0.1, plane,axisymmetric. Several axes: all with all.

    The same command again completes what is missing. Every point is the folder of a run.
    """
    if (engine == "dask") != (scheduler is not None):
        raise click.UsageError("--engine dask and --scheduler ADDRESS go together")
    if engine != "local" and jobs is not None:
        raise click.UsageError("--jobs is for --engine local; a cluster chooses the points at a time itself")
    if engine == "commands" and to_json:
        raise click.UsageError("--json tells what the points became, and --engine commands runs none; leave one out")
    from mpmcol.sweep.axes import parse_axes
    from mpmcol.sweep.runs import plan_runs

    axes, problems = parse_axes(aspect, settings)
    folder = out or _default_folder(case, settings, zipped)
    points = plan_runs(case, axes, folder, zipped, problems)
    if dry_run:
        _print_forecast(points, jobs, threads, to_json)
    elif engine == "commands":
        _print_commands(points, folder, threads, quiet)
    else:
        _run(points, folder, jobs, threads, scheduler, to_json, quiet)


def _default_folder(case: str, settings: tuple[str, ...], zipped: bool) -> Path:
    """One for each case and, as of a run, one for each set of other values."""
    digest = sha256(repr((sorted(settings), zipped)).encode()).hexdigest()[:6]
    return Path("sweeps") / (f"{Path(case).stem}-{digest}" if settings else Path(case).stem)


def _run(
    points: list[PlannedRun],
    out: Path,
    jobs: int | None,
    threads: int | None,
    scheduler: str | None,
    to_json: bool,
    quiet: bool,
) -> None:
    from mpmcol.cli.sweep_display import Display, as_record, closing_lines, failures
    from mpmcol.sweep.engine import exit_code
    from mpmcol.sweep.plan import as_json
    from mpmcol.sweep.report import write_report
    from mpmcol.sweep.runner import run_sweep
    from mpmcol.sweep.runs import notes

    with Display(out, quiet) as display:
        for note in notes(points):
            display.say(f"note: {note}")
        outcomes = run_sweep(points, out, jobs, threads, scheduler, display)
    published = write_report(outcomes, out)
    if to_json:
        click.echo(as_json(as_record(published)))
    elif quiet:
        for line in failures(published):
            click.echo(line, err=True)
    else:
        click.echo("\n".join(closing_lines(published)))
    click.get_current_context().exit(exit_code(outcomes))


def _print_forecast(points: list[PlannedRun], jobs: int | None, threads: int | None, to_json: bool) -> None:
    from mpmcol.sweep.forecast import forecast
    from mpmcol.sweep.plan import as_json
    from mpmcol.sweep.runner import introduce, todo
    from mpmcol.sweep.runs import notes
    from mpmcol.sweep.scheduling import allocate, finish

    click.echo("measuring the pace of this machine (about a second, more if kernels must be compiled) ...", err=True)
    left = todo(points)
    shares = allocate(left or points, jobs, threads)
    seconds = dict(zip((point.folder for point in left), forecast(left, shares.threads), strict=True))
    total = finish(list(seconds.values()), shares.jobs)
    rows: list[dict[str, Any]] = [
        {"folder": point.folder.name, "inputs": point.inputs, "points": point.discretization.most_points,
         "steps": point.steps, "seconds": seconds.get(point.folder)}
        for point in points
    ]  # fmt: skip
    if to_json:
        click.echo(as_json({"jobs": shares.jobs, "threads": shares.threads, "seconds": total, "points": rows}))
        return
    width = max(len(point.name) for point in points)
    for point, row in zip(points, rows, strict=True):
        cost = "has ended" if row["seconds"] is None else f"about {duration(row['seconds'])}"
        click.echo(f"{point.name:{width}}  {row['points']:10,} points  {row['steps']:9,} steps  {cost}")
    for note in notes(points):
        click.echo(f"note: {note}")
    click.echo(introduce(points, left, shares))
    click.echo(f"about {duration(total)} in all; nothing was run" if left else "nothing was run")


def _print_commands(points: list[PlannedRun], out: Path, threads: int | None, quiet: bool) -> None:
    """The lines on stdout; all else on stderr, so that they can be piped."""
    from mpmcol.sweep.commands import SLURM_FILE, write_commands
    from mpmcol.sweep.plan import prepare_out, write_plan
    from mpmcol.sweep.runner import make_plan, todo
    from mpmcol.sweep.scheduling import Allocation

    left = todo(points)
    if not left:
        click.echo("all points have ended; the same command without --engine makes table and charts", err=True)
        return
    shares = Allocation(len(left), threads or 1)
    write_plan(prepare_out(out), make_plan(points, shares))
    click.echo("\n".join(write_commands(left, shares.threads, out)))
    if not quiet:
        click.echo(f"{len(left)} points to run; on Slurm: sbatch {out / SLURM_FILE}", err=True)
        click.echo("afterwards the same command without --engine makes table and charts", err=True)
