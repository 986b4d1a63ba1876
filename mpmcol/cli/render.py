"""`mpmcol render`: pictures and animations of a run."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcol.cli.option_types import whole


def parse_size(context: click.Context, parameter: click.Parameter, text: str) -> tuple[int, int]:
    """WIDTHxHEIGHT in pixels, each from 200 to 8000."""
    width, _, height = text.partition("x")
    sizes = [whole(part) for part in (width, height)]
    if not all(200 <= pixels <= 8000 for pixels in sizes):
        raise click.BadParameter(f"{text[:50]!r}: expected WIDTHxHEIGHT in pixels, each 200 to 8000, such as 1280x720")
    return sizes[0], sizes[1]


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--gif", is_flag=True, help="Also make an animation of all snapshots.")
@click.option("--view", type=click.Choice(["side", "3d", "top"]), help="From where [default: side; in 3D: 3d].")
@click.option("--snapshot", metavar="N", default=-1, show_default=True, help="Which snapshot; -1 is the last.")
@click.option("--out", metavar="FILE", type=click.Path(path_type=Path), help="The PNG [default: in DIR].")
@click.option("--size", default="1280x720", show_default=True, callback=parse_size, help="Size in pixels.")
def render(folder: Path, gif: bool, view: str | None, snapshot: int, out: Path | None, size: tuple[int, int]) -> None:
    """Draw the material points of the results in DIR, coloured by displacement.

    From above (`--view top`, of a cylinder), in red what moved by 1 mm or more since the release.
    """
    from mpmcol.plotting.render import render as draw

    rendered = draw(folder, gif=gif, view=view, snapshot=snapshot, size=size, out=out)
    for path in rendered.paths:
        click.echo(path)
    if rendered.note:
        click.echo(rendered.note, err=True)
