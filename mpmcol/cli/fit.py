"""`mpmcol fit`: values of a case from measurements of a deposit."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcol.cli.options import (
    PATH,
    accuracy_option,
    aspect_option,
    dry_run_option,
    fresh_option,
    jobs_option,
    json_option,
    out_option,
    overrides_option,
    quiet_option,
    report_option,
    threads_option,
    with_aspect,
)
from mpmcol.cli.report import report_at_end
from mpmcol.cli.sweep_plan import print_forecast


@click.command()
@click.argument("case")
@click.option(
    "--to", "measured", multiple=True, metavar="NAME=VALUE[+-ERROR],...",
    help="Measured values with their standard errors: zeta, beta, repose (deg), undisturbed_radius (m), "
    "and in time zeta_at_1, zeta_at_2, beta_at_1, beta_at_2 (at 1 and 2 sqrt(h_i/g)), stop_time (sqrt(h_i/g)), for "
    "example zeta=1.37+-0.05,beta=0.55. Without an error 2 % are assumed.",
)  # fmt: skip
@click.option(
    "--profile", metavar="FILE", type=PATH,
    help='Measured profile of the deposit: a CSV file with the columns "r" and "z" (or "x" and "y"), in m or with a '
    'unit, for example "r [mm],z [mm]". The standard error of its heights is assumed: 2 % of the largest.',
)  # fmt: skip
@click.option(
    "--vary", multiple=True, metavar="KEY=LOW:HIGH",
    help="Unknown key of the case and the range of its value, for example material.friction_deg=20:45. One to three.",
)  # fmt: skip
@click.option(
    "--repeats", metavar="N", type=click.IntRange(2, 20), default=2, show_default=True,
    help="Runs for each set of values, which differ in time step and spacing by a few per cent.",
)  # fmt: skip
@aspect_option
@overrides_option
@accuracy_option()
@out_option("fits/CASE-KEYS")
@fresh_option
@jobs_option
@threads_option
@dry_run_option
@report_option
@json_option("values with their standard errors, and the differences from the measurements")
@quiet_option
def fit(
    case: str,
    measured: tuple[str, ...],
    profile: Path | None,
    vary: tuple[str, ...],
    repeats: int,
    aspect: str | None,
    overrides: tuple[str, ...],
    accuracy: float | None,
    out: Path | None,
    fresh: bool,
    jobs: int | None,
    threads: int | None,
    dry_run: bool,
    report: bool,
    to_json: bool,
    quiet: bool,
) -> None:
    """Find values of a case from a measured deposit.

    CASE is a TOML file or the name of a shipped case. The answer has a standard error, with the parts of it that come
    from the measurement, the grid and the scatter of the runs. Where no values in the ranges reproduce the
    measurements, that is stated. Runouts are those of front_height. With --accuracy the search runs on a coarse grid of
    the study, and only the answer on an accurate one; without, on the grid of the case.

    Writes fit.json, fit.md, evaluations.csv, the fitted case fitted.toml and charts. Repeating the command resumes a
    fit that was stopped.
    """
    from mpmcol.api.fits import default_folder, parse_measured
    from mpmcol.cli.sweep_display import SweepDisplay
    from mpmcol.io.atomic import require_folder_path
    from mpmcol.io.values import to_json as as_json
    from mpmcol.studies.fit import RUNS, carry_out_fit, plan_fit
    from mpmcol.studies.fit.report import lines, record, write_report
    from mpmcol.studies.fit.unknowns import parse_unknowns

    overrides = with_aspect(overrides, aspect)
    targets = parse_measured(",".join(measured), profile)
    unknowns = parse_unknowns(vary, case, overrides)
    folder = out or default_folder(Path(case).stem, unknowns, overrides, accuracy)
    require_folder_path(folder)
    if dry_run:
        levels, runs = plan_fit(case, overrides, unknowns, targets, folder, accuracy=accuracy, repeats=repeats)
        if not quiet:
            click.echo("\n".join(f"{level.name}: {level.text}" for level in levels), err=True)
            click.echo("first runs, on the first grid; then two or more for each step of the search:", err=True)
        print_forecast(runs, jobs, threads, fresh=fresh, to_json=to_json, quiet=quiet)
        return
    with SweepDisplay(folder / RUNS, quiet) as display:
        found = carry_out_fit(
            case, overrides, unknowns, targets, folder, accuracy=accuracy, repeats=repeats,
            jobs=jobs, threads=threads, fresh=fresh, observer=display, notify=display.notify,
        )  # fmt: skip
    files = write_report(found)
    if to_json:
        click.echo(as_json(record(found)))
    elif not quiet:
        click.echo("\n".join(lines(found)))
        click.echo(f"in {folder}: {', '.join(path.name for path in files)}")
    if report:
        report_at_end(folder, overwrite=fresh, quiet=quiet)
