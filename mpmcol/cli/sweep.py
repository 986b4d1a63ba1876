"""`mpmcol sweep`: runs for many values of some keys, with a table, fits and charts."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mpmcol.cli.options import (
    accuracy_option,
    aspect_option,
    corrected_option,
    dry_run_option,
    fresh_option,
    jobs_option,
    json_option,
    out_option,
    overrides_option,
    quiet_option,
    report_option,
    require_accuracy,
    threads_option,
)
from mpmcol.cli.report import report_at_end
from mpmcol.cli.sweep_plan import print_commands, print_forecast
from mpmcol.cli.uncertain import End, Ending, UncertainOptions, uncertain_options
from mpmcol.io.atomic import require_folder_path

if TYPE_CHECKING:
    from mpmcol.api.accuracy import Recommendations
    from mpmcol.sweep.engine import Outcome
    from mpmcol.sweep.report import SweepReport
    from mpmcol.sweep.runs import PlannedRun


@click.command()
@click.argument("case", required=False)
@aspect_option
@click.option(
    "--slope", metavar="VALUES", help="Slope of the base in degrees, for example 0:20:5, the same as "
    "--set geometry.slope_deg=VALUES.",
)  # fmt: skip
@overrides_option
@click.option("--zip", "zipped", is_flag=True, help="Combine the first values of all keys, then the second, and so on.")
@uncertain_options
@accuracy_option()
@corrected_option
@out_option("sweeps/CASE-KEYS")
@fresh_option
@jobs_option
@threads_option
@click.option(
    "--engine", type=click.Choice(["local", "dask", "commands"]), default="local", show_default=True,
    help="Where to run: this machine; a dask cluster; or nowhere: print shell commands and write a Slurm array job.",
)  # fmt: skip
@click.option("--scheduler", metavar="ADDRESS", help="Scheduler of the dask cluster, for example tcp://10.0.0.1:8786.")
@dry_run_option
@report_option
@json_option("table, fits and names of files")
@quiet_option
def sweep(
    case: str | None,
    aspect: str | None,
    slope: str | None,
    overrides: tuple[str, ...],
    zipped: bool,
    uncertain: UncertainOptions,
    accuracy: float | None,
    corrected: bool,
    out: Path | None,
    fresh: bool,
    jobs: int | None,
    threads: int | None,
    engine: str,
    scheduler: str | None,
    dry_run: bool,
    report: bool,
    to_json: bool,
    quiet: bool,
) -> None:
    """Run a case for many values of its keys.

    CASE is a TOML file or the name of a shipped case; by default cylinder, that of the paper with the stress
    filter, and with --slope inclined-channel. Writes a table, power-law fits and charts of runout and height.

    A VALUE is one or more single values and ranges, separated by commas: 0.5:7 (steps of 0.5), 0.5:7:0.25 (steps of
    0.25), 0.5:7/14 (14 values), 0.55,0.9,1.7:3:0.1, plane,axisymmetric. The values of several keys are combined in all
    ways, unless --zip is given.

    With --accuracy, each run gets the configuration that mpmcol run --accuracy chooses for its column; runs that are
    unlike those of the study, such as a higher column, are named. The table has the intervals of finer grids
    (zeta.finer_grids, beta.finer_grids); with --corrected these are as narrow as the accuracy.

    With --uncertain, keys have distributions instead of values: the runs are a sample, and statistics, probabilities
    and the shares of the inputs in the variance are written as well. All runs then have one configuration.

    Each run has its own results folder. Repeating the command completes missing runs. Ctrl-C and SIGTERM stop the runs
    with a checkpoint (exit code 75).
    """
    from mpmcol.sweep.replaced import outdated_report, runs_that_leave

    _check_engine(engine, scheduler, jobs, to_json, report)
    if dry_run and engine != "local":
        raise click.UsageError(f"--dry-run estimates runs on this machine; remove --engine {engine}")
    case = case or ("cylinder" if slope is None else "inclined-channel")
    require_accuracy(corrected, accuracy)
    end: End = _ending
    chosen = None
    if uncertain.inputs:
        plan, folder = uncertain.plan(case, aspect, overrides, slope, out=out, accuracy=accuracy, corrected=corrected)
        runs, notes, end = plan.runs, uncertain.notes(plan), partial(uncertain.ending, plan)
    else:
        runs, folder, notes, chosen = _planned(
            case, aspect, overrides, slope, zipped=zipped, out=out, accuracy=accuracy, corrected=corrected
        )
    notes += [f"note: {note}" for note in runs_that_leave(folder, runs)]
    if not quiet:
        click.echo("".join(f"{note}\n" for note in notes), err=True, nl=False)
    if dry_run:
        require_folder_path(folder)
        print_forecast(runs, jobs, threads, fresh=fresh, to_json=to_json, quiet=quiet)
    elif engine == "commands":
        print_commands(runs, folder, threads, fresh=fresh, quiet=quiet)
    else:
        code = _execute(
            runs, folder, chosen, end,
            jobs=jobs, threads=threads, scheduler=scheduler, fresh=fresh, to_json=to_json, quiet=quiet,
        )  # fmt: skip
        if report:
            report_at_end(folder, overwrite=fresh, quiet=quiet)
        elif not quiet:
            click.echo("".join(f"note: {note}\n" for note in outdated_report(folder)), err=True, nl=False)
        click.get_current_context().exit(code)


def _check_engine(engine: str, scheduler: str | None, jobs: int | None, to_json: bool, report: bool) -> None:
    """Refuse options that contradict the engine."""
    if (engine == "dask") != (scheduler is not None):
        raise click.UsageError("--engine dask requires --scheduler ADDRESS, and --scheduler requires --engine dask")
    if engine != "local" and jobs is not None:
        raise click.UsageError("--jobs requires --engine local; a cluster schedules its runs itself")
    if engine == "commands" and to_json:
        raise click.UsageError("--json prints results, and --engine commands runs nothing; omit one of them")
    if engine == "commands" and report:
        raise click.UsageError("--report reports results, and --engine commands runs nothing; omit one of them")


def _planned(
    case: str,
    aspect: str | None,
    overrides: Sequence[str],
    slope: str | None,
    *,
    zipped: bool,
    out: Path | None,
    accuracy: float | None,
    corrected: bool,
) -> tuple[list[PlannedRun], Path, list[str], Recommendations | None]:
    """The runs of given values, the folder of the sweep, notes, and the configurations that were chosen.

    Raises CaseError and UsageError.
    """
    from mpmcol.api.sweeps import planned_runs, recommendations
    from mpmcol.sweep.axes import parse_axes
    from mpmcol.sweep.names import sweep_name

    axes, problems = parse_axes(aspect, overrides, slope)
    folder = out or Path("sweeps") / sweep_name(Path(case).stem, axes, accuracy, corrected)
    notes: list[str] = []
    chosen = recommendations(case, accuracy, corrected)
    runs = planned_runs(case, axes, folder, chosen, zipped=zipped, problems=problems, notify=notes.append)
    return runs, folder, notes, chosen


def _ending(outcomes: Sequence[Outcome], report: SweepReport) -> Ending:
    """What is printed at the end: the record for JSON, and lines."""
    from mpmcol.cli.sweep_display import as_record, summary_lines

    return as_record(report), list(summary_lines(report))


def _execute(
    runs: list[PlannedRun],
    out: Path,
    chosen: Recommendations | None,
    end: End,
    *,
    jobs: int | None,
    threads: int | None,
    scheduler: str | None,
    fresh: bool,
    to_json: bool,
    quiet: bool,
) -> int:
    """Execute the runs, and print what came of them; returns the exit code."""
    from mpmcol.cli.sweep_display import SweepDisplay, failures
    from mpmcol.sweep.engine import exit_code
    from mpmcol.sweep.plan import as_json
    from mpmcol.sweep.report import write_report
    from mpmcol.sweep.runner import run_sweep

    with SweepDisplay(out, quiet) as display:
        outcomes = run_sweep(runs, out, jobs=jobs, threads=threads, scheduler=scheduler, fresh=fresh, observer=display)
    if chosen:
        chosen.state(outcomes)
    report = write_report(outcomes, out)
    record, lines = end(outcomes, report)
    if to_json:
        click.echo(as_json(record))
    elif quiet:
        for line in failures(report):
            click.echo(line, err=True)
    else:
        click.echo("\n".join(lines))
    return exit_code(outcomes)
