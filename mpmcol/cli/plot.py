"""`mpmcol plot`: charts of a run."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from mpmcol.cli.options import PATH


def parse_times(context: click.Context, parameter: click.Parameter, text: str | None) -> tuple[float, ...] | None:
    """Seconds since release, separated by commas."""
    try:
        return None if text is None else tuple(float(part) for part in text.split(","))
    except ValueError as error:
        message = f"{text!r}: expected seconds since release, separated by commas, for example 0.1,0.2"
        raise click.BadParameter(message) from error


@click.command()
@click.argument("folder", metavar="DIR", type=PATH)
@click.option(
    "--times",
    metavar="T,...",
    callback=parse_times,
    help="Times of the profiles, s since release; the last state is always drawn  [default: five, equally spaced]",
)
@click.option("--out", metavar="DIR", type=PATH, help="Folder of the charts  [default: the results folder]")
@click.option("--svg", is_flag=True, help="Also write each chart as SVG.")
def plot(folder: Path, times: tuple[float, ...] | None, out: Path | None, svg: bool) -> None:
    """Draw charts of a run.

    DIR is a results folder. Writes profile.png (profiles of the deposit), front.png (front and height over time) and
    energy.png (energy balance over time).
    """
    from mpmcol.io.results import Results
    from mpmcol.plotting.run_charts import chart_run

    for path in chart_run(Results(folder), times=times, svg=svg, out=out, notify=partial(click.echo, err=True)):
        click.echo(path)
