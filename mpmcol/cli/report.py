"""`mpmcol report`: a run, several runs, a sweep or a study as one HTML file."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcol.cli.options import PATH, results_argument


@click.command()
@results_argument(several=True)
@click.option(
    "--out", metavar="FILE", type=PATH,
    help="HTML file to write  [default: report.html in DIR; for several, in the current folder]",
)  # fmt: skip
@click.option("--overwrite", is_flag=True, help="Replace a file that is not a report.")
def report(folders: tuple[Path, ...], out: Path | None, overwrite: bool) -> None:
    """Write a report as one HTML file that can be sent.

    DIR is the folder of a finished run, of a sweep or of a study. Several runs are compared with the first. The file
    holds its pictures, needs no network, and can be printed. An earlier report is replaced.
    """
    from mpmcol.report import write_report

    click.echo(write_report(folders, out=out, overwrite=overwrite))


def report_at_end(folder: Path, *, overwrite: bool, quiet: bool) -> None:
    """Write the report of a run or a sweep that this command has completed."""
    from mpmcol.report import write_report

    path = write_report([folder], overwrite=overwrite)
    if not quiet:
        click.echo(f"report in {path}", err=True)
