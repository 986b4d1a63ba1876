"""`mpmcol plot`: charts of a run."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from mpmcol.cli.options import PATH, results_argument


def parse_times(context: click.Context, parameter: click.Parameter, text: str | None) -> tuple[float, ...] | None:
    """Seconds since release, separated by commas."""
    try:
        return None if text is None else tuple(float(part) for part in text.split(","))
    except ValueError as error:
        message = f"{text!r}: expected seconds since release, separated by commas, for example 0.1,0.2"
        raise click.BadParameter(message) from error


@click.command()
@results_argument(several=True, of="a run")
@click.option(
    "--times",
    metavar="T,...",
    callback=parse_times,
    help="Times of the profiles of one run, s since release; the last state is always drawn  [default: four, equally "
    "spaced]",
)
@click.option(
    "--points",
    metavar="FILE.csv",
    type=PATH,
    help='Measurements to draw in profile.png: columns "r" and "z" in m, or with a unit such as "r [mm]", and possibly '
    '"series" or "t".',
)
@click.option(
    "--out", metavar="DIR", type=PATH, help="Folder of the charts  [default: DIR; of several runs, the current folder]"
)
@click.option("--svg", is_flag=True, help="Also write each chart as SVG.")
def plot(
    folders: tuple[Path, ...], times: tuple[float, ...] | None, points: Path | None, out: Path | None, svg: bool
) -> None:
    """Draw charts of a run, or compare several runs.

    DIR is a results folder. Writes profile.png (profiles of the deposit), front.png (front and height over time) and
    energy.png (energy balance over time), and of a run with recorded forces walls.png (forces on walls over time, and
    pressures over the height). With several folders, each chart has a line for each run.
    """
    from mpmcol.io.results import Results
    from mpmcol.plotting.comparison import chart_comparison
    from mpmcol.plotting.measured_series import read_points
    from mpmcol.plotting.run_charts import chart_run

    measured = read_points(points) if points else []
    runs = [Results(folder) for folder in folders]
    if len(runs) == 1:
        notify = partial(click.echo, err=True)
        paths = chart_run(runs[0], times=times, svg=svg, points=measured, out=out, notify=notify)
    elif times is not None:
        raise click.UsageError(
            "--times chooses profiles of one run; charts of several runs show the last state of each"
        )
    else:
        paths = chart_comparison(runs, points=measured, svg=svg, out=out or Path())
    for path in paths:
        click.echo(path)
