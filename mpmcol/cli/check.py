"""`mpmcol check`: find all problems of a case without running it."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcol.cli.options import aspect_option, overrides_option, with_aspect


@click.command()
@click.argument("case")
@aspect_option
@overrides_option
@click.option("--resolved", is_flag=True, help="Print the case with all defaults filled in.")
def check(case: str, aspect: str | None, overrides: tuple[str, ...], resolved: bool) -> None:
    """Check a case without running it.

    CASE is a TOML file or the name of a shipped case (mpmcol cases). Prints a summary of the case, and a note for each
    value that is rounded to fit the grid and for each setting that is known to be unfit. If the case is invalid, all
    problems are printed with file, line and key, and the exit code is 2.
    """
    from mpmcol.case import case_hash, load_case, located, resolved_toml
    from mpmcol.case.title import title_of
    from mpmcol.setup.discretization import discretize, require_thick_outline
    from mpmcol.setup.memory import require_memory_for
    from mpmcol.setup.unfit_settings import require_stiff_column
    from mpmcol.sweep.runs import PlannedRun
    from mpmcol.units import counted

    overrides = with_aspect(overrides, aspect)
    loaded = load_case(case, overrides)
    with located(case, overrides):
        discretization = discretize(loaded)
        require_memory_for(discretization)
        require_thick_outline(discretization)
        require_stiff_column(loaded)
    column = loaded.geometry
    kind = column.model if column.dimension == 2 else f"{column.model} {column.section}"
    kind += f", outline of {len(column.outline)} points" if column.outline else ""
    slope = f"slope {column.slope_deg:g} deg, " if column.slope_deg else ""
    slope += "vertical sides, " if column.lean else ""
    floor = "rigid floor" if column.base == "rigid" else f"{column.base} base of {discretization.base:.4g} m"
    found = f", {counted(len(discretization.warnings), 'note')}" if discretization.warnings else ""
    title, aspect_text = title_of(loaded), f"a = {column.a:g}, "
    click.echo(
        f"{case}: no problems{found}. {title}: {kind}, {loaded.material.law}, r_i = {column.r_i:g} m, "
        f"h_i = {column.h_i:g} m, {'' if aspect_text[:-2] in title else aspect_text}{slope}{floor}, "
        f"h = {discretization.h:g} m, case_hash {case_hash(loaded)}",
        err=resolved,
    )
    planned = PlannedRun({}, loaded, Path())
    click.echo(
        f"about {planned.steps:,} steps of {discretization.most_points:,} material points; the time is estimated by "
        "mpmcol run --dry-run",
        err=resolved,
    )
    for warning in discretization.warnings:
        click.echo(f"note: {warning}", err=resolved)
    if resolved:
        click.echo(resolved_toml(loaded), nl=False)
