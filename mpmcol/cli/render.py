"""`mpmcol render`: images and animations of a run."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import click

from mpmcol.cli.options import PATH, positive_integer, results_argument
from mpmcol.plotting.limits import COLORS, LEAST_PIXELS, MOST_PIXELS


def parse_size(context: click.Context, parameter: click.Parameter, text: str | None) -> tuple[int, int] | None:
    """WIDTHxHEIGHT in pixels; None if it is not given."""
    if text is None:
        return None
    width, _, height = text.partition("x")
    sizes = [positive_integer(part) for part in (width, height)]
    if not all(LEAST_PIXELS <= pixels <= MOST_PIXELS for pixels in sizes):
        bounds = f"each {LEAST_PIXELS} to {MOST_PIXELS}"
        raise click.BadParameter(f"{text[:50]!r}: expected WIDTHxHEIGHT in pixels, {bounds}, for example 1280x720")
    return sizes[0], sizes[1]


@click.command()
@results_argument(of="a run")
@click.option("--gif", is_flag=True, help="Also write an animation of all snapshots.")
@click.option("--mp4", is_flag=True, help="Also write an animation as MP4 (needs imageio-ffmpeg).")
@click.option("--view", type=click.Choice(["side", "3d", "top"]), help="Camera view  [default: side, in 3D 3d]")
@click.option("--color", type=click.Choice(COLORS), default=COLORS[0], show_default=True, help="Colour of the points.")
@click.option("--snapshot", metavar="N", default=-1, show_default=True, help="Snapshot index (-1: last).")
@click.option("--out", metavar="FILE", type=PATH, help="PNG file to write  [default: in DIR]")
@click.option(
    "--size", metavar="WIDTHxHEIGHT", callback=parse_size,
    help=f"Size in pixels, each {LEAST_PIXELS} to {MOST_PIXELS}  [default: 1280 wide, as high as the flow requires]",
)  # fmt: skip
def render(
    folder: Path,
    gif: bool,
    mp4: bool,
    view: str | None,
    color: str,
    snapshot: int,
    out: Path | None,
    size: tuple[int, int] | None,
) -> None:
    """Draw the material points of a run.

    DIR is a results folder. Pressure and shear stress are those of the mean stress of a cell. In the top view of a
    cylinder (--view top), points that moved by r_i/100 or more since the release are red.
    """
    from mpmcol.plotting.render import render as draw

    bar: Any = None
    with ExitStack() as stack:

        def progress(done: int, total: int) -> None:
            nonlocal bar
            if bar is None:
                bar = stack.enter_context(
                    click.progressbar(length=total, label="images", file=sys.stderr, hidden=not sys.stderr.isatty())
                )
            bar.update(1)

        rendered = draw(
            folder, gif=gif, mp4=mp4, view=view, color=color, snapshot=snapshot, size=size, out=out, progress=progress
        )
    for path in rendered.paths:
        click.echo(path)
    if rendered.note:
        click.echo(rendered.note, err=True)
