"""`mpmcol plot`: charts of a run."""

from __future__ import annotations

from pathlib import Path

import click


def parse_times(context: click.Context, parameter: click.Parameter, text: str | None) -> tuple[float, ...] | None:
    """Seconds since release, separated by commas."""
    try:
        return None if text is None else tuple(float(part) for part in text.split(","))
    except ValueError as error:
        raise click.BadParameter(f"{text!r}: expected seconds, separated by commas, such as 0.1,0.2") from error


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option(
    "--times",
    metavar="T1,T2,...",
    callback=parse_times,
    help="Times of the profiles, s; the last state is always drawn too  [default: five, even]",
)
@click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help="Folder of the charts  [default: DIR].")
@click.option("--svg", is_flag=True, help="Also write each chart as SVG.")
def plot(folder: Path, times: tuple[float, ...] | None, out: Path | None, svg: bool) -> None:
    """Chart the results in DIR: profiles, front and height over time, energy ledger."""
    from mpmcol.io.results import Results
    from mpmcol.plotting.run_charts import chart_run

    for path in chart_run(Results(folder), times, svg, out, lambda note: click.echo(note, err=True)):
        click.echo(path)
