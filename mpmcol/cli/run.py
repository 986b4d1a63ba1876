"""`mpmcol run`: simulate a case."""

from __future__ import annotations

import os
from collections.abc import Sequence
from math import inf
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Literal

import click
from click.core import ParameterSource

from mpmcol.cli.accuracy import certify as run_certified
from mpmcol.cli.accuracy import recommend, state_accuracy
from mpmcol.cli.options import (
    DEFAULT_FOLDER,
    DURATION,
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
    with_aspect,
)
from mpmcol.cli.report import report_at_end
from mpmcol.errors import Interrupted, NumericalFailure
from mpmcol.io.values import to_json as as_json

if TYPE_CHECKING:
    from mpmcol.case import Case
    from mpmcol.io.results import Results

OTHER_CODES = (0, 1, 2, 3, 4, 5, 130, 141)
SINGLE_RUN_OPTIONS = (
    "force_resume", "checkpoint", "max_wall", "on_instability", "requeue_code", "report",
)  # fmt: skip


def _free_code(context: click.Context, parameter: click.Parameter, code: int | None) -> int | None:
    """Refuse the exit codes of other endings, by which a job script would take a stopped run for one of them."""
    if code in OTHER_CODES:
        raise click.BadParameter(f"{code} has another meaning; not one of {OTHER_CODES}")
    return code


@click.command()
@click.argument("case")
@aspect_option
@overrides_option
@accuracy_option()
@corrected_option
@click.option("--certify", is_flag=True, help="With --accuracy: error bars of zeta and beta, from several runs.")
@out_option("runs/CASE-VALUES")
@fresh_option
@jobs_option
@threads_option
@click.option("--force-resume", is_flag=True, help="Resume an unfinished run even if the case or the code has changed.")
@click.option("--checkpoint", type=DURATION, default="5min", show_default=True, help="Time between two checkpoints.")
@click.option("--max-wall", type=DURATION, help="Stop with a checkpoint after this wall-clock time, for example 2h.")
@click.option(
    "--on-instability",
    type=click.Choice(["stop", "retry"]),
    default="stop",
    show_default=True,
    help="After a numerical failure stop, or return to the last valid state with half the time step.",
)
@click.option(
    "--requeue-code",
    metavar="N",
    type=click.IntRange(0, 255),
    callback=_free_code,
    help="Exit code of a stopped run  [default: 75]",
)
@dry_run_option
@report_option
@json_option("result.json")
@quiet_option
def run(
    case: str,
    aspect: str | None,
    overrides: tuple[str, ...],
    accuracy: float | None,
    corrected: bool,
    certify: bool,
    out: Path | None,
    fresh: bool,
    jobs: int | None,
    threads: int | None,
    force_resume: bool,
    checkpoint: float,
    max_wall: float | None,
    on_instability: Literal["stop", "retry"],
    requeue_code: int | None,
    dry_run: bool,
    report: bool,
    to_json: bool,
    quiet: bool,
) -> None:
    """Simulate a case and measure runout and height.

    CASE is a TOML file or the name of a shipped case (mpmcol cases). The column is equilibrated under gravity behind
    the gate, released, and simulated until it is at rest. mpmcol measure, plot and render read the results folder.

    With --accuracy, the cheapest configuration that was within this error in mpmcol pareto is used. These are
    discretisation errors, without the error of the model. The run ends with a statement, also in accuracy.json:
    intervals of runout and height for finer grids and for experiments, and what they hold. With --corrected the
    interval for finer grids is as narrow as the accuracy, and the values of the run may differ from it by twice the
    accuracy. With --certify the case is run on this grid and two coarser ones, on each also with one cell fewer in the
    radius, and on a finer grid too if an error bar is wider than the accuracy; runout and height are extrapolated to
    zero spacing.

    Ctrl-C, the signals of schedulers and --max-wall stop the run with a checkpoint (exit code 75); a second Ctrl-C
    aborts it. Repeating the command resumes a stopped or killed run, with results that are identical to those of an
    uninterrupted run. A finished run is not repeated; its result is printed again.

    A numerical failure stops the run with its cause, location and remedy (exit code 3); the last valid state is kept as
    a snapshot. With --on-instability retry, time.cfl is halved instead, at most four times.
    """
    require_accuracy(corrected, accuracy)
    if certify:
        _check_certify(accuracy, corrected)
    elif jobs is not None:
        raise click.UsageError("--jobs applies to several runs: give --accuracy and --certify, or mpmcol sweep")
    if fresh and force_resume:
        raise click.UsageError("--fresh discards an unfinished run, and --force-resume resumes it; give one of them")
    if threads is not None:
        os.environ.setdefault("NUMBA_NUM_THREADS", str(max(threads, os.cpu_count() or 1)))
    from mpmcol.case import load_case, located
    from mpmcol.cli.run_display import RunDisplay, print_estimate
    from mpmcol.sweep.names import run_name

    given = with_aspect(overrides, aspect)
    loaded = load_case(case, given)
    name = run_name(Path(case).stem, loaded, given, accuracy, corrected)
    folder = out or DEFAULT_FOLDER / f"{name}{'-certified' * certify}"
    if accuracy is not None:
        advice = recommend(case, given, accuracy, corrected=corrected, silent=quiet)
        if certify:
            run_certified(
                case, given, advice, accuracy, folder,
                jobs=jobs, threads=threads, fresh=fresh, dry_run=dry_run, to_json=to_json, quiet=quiet,
            )  # fmt: skip
        given = (*given, *advice.overrides)
        loaded = load_case(case, given)
    if dry_run:
        _check_folder(loaded, folder, fresh, quiet)
        _note_threads(threads, quiet)
        with located(case, given):
            print_estimate(loaded, folder, threads, to_json=to_json, quiet=quiet)
        return
    from mpmcol.io.results import Results
    from mpmcol.simulation.run import run as simulate

    try:
        with RunDisplay(quiet) as display, located(case, given):
            results = simulate(
                loaded, folder, threads=threads, fresh=fresh, force_resume=force_resume, checkpoint_seconds=checkpoint,
                max_wall=inf if max_wall is None else max_wall, on_instability=on_instability,
                progress=display.progress, notify=display.notify,
            )  # fmt: skip
    except Interrupted as interruption:
        if requeue_code is not None:
            interruption.exit_code = requeue_code
        raise
    except NumericalFailure:
        if to_json:
            click.echo(as_json(Results(folder).summary))
        raise
    statement, lines = ({}, []) if accuracy is None else state_accuracy(results, advice, accuracy, corrected=corrected)
    if to_json:
        click.echo(as_json(results.summary | ({"accuracy": statement} if statement else {})))
    elif not quiet:
        _print_summary(results, lines)
    if report:
        report_at_end(folder, overwrite=fresh, quiet=quiet)


def _print_summary(results: Results, lines: Sequence[str]) -> None:
    """The table of a run, with the lines of its statement of accuracy, and what to do next."""
    from mpmcol.cli.run_summary import summary_table

    shown = quote(str(results.folder))
    click.echo(summary_table(results, lines))
    click.echo(f"results in {shown}; next: mpmcol plot {shown}, mpmcol render {shown}")


def _check_certify(accuracy: float | None, corrected: bool) -> None:
    """Refuse options that --certify, a sweep over spacings, cannot have."""
    if accuracy is None:
        raise click.UsageError("--certify requires --accuracy, which chooses the grid")
    if corrected:
        raise click.UsageError("--corrected uses the error of the study, and --certify that of several runs; omit one")
    context = click.get_current_context()
    given = [name for name in SINGLE_RUN_OPTIONS if context.get_parameter_source(name) is ParameterSource.COMMANDLINE]
    if given:
        option = f"--{given[0].replace('_', '-')}"
        raise click.UsageError(f"{option} applies to a single run, and --certify makes several; omit one of them")


def _check_folder(case: Case, folder: Path, fresh: bool, quiet: bool) -> None:
    """Refuse what the run would refuse about its folder."""
    from mpmcol.io.atomic import require_folder_path
    from mpmcol.io.run_folder import require_no_foreign_files
    from mpmcol.simulation.restart import find_finished_run

    require_folder_path(folder)
    require_no_foreign_files(folder)
    if not fresh:
        find_finished_run(case, folder, lambda line: None if quiet else click.echo(line, err=True))


def _note_threads(threads: int | None, quiet: bool) -> None:
    """The note of a run with more threads than cores, on stderr."""
    from mpmcol.setup.cores import thread_note

    if threads is not None and not quiet and (note := thread_note(threads)):
        click.echo(f"note: {note}", err=True)
