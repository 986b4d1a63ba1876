"""`mpmcol verify`: check that the files of runs are unchanged."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mpmcol.cli.options import json_option, results_argument
from mpmcol.errors import OutputError

if TYPE_CHECKING:
    from mpmcol.integrity import FolderReport

VERIFY_SCHEMA = 2
STATUS_TEXTS = {
    "failed": ", of a run that diverged",
    "stopped": ", of a run that was stopped; repeat its command to resume",
    "unfinished": ", of an unfinished run; repeat its command to resume",
    "missing": ", of a run that was not started",
}


@click.command()
@results_argument(several=True)
@json_option("the report")
@click.pass_context
def verify(context: click.Context, folders: tuple[Path, ...], to_json: bool) -> None:
    """Check the files of runs for damage.

    DIR is the folder of a run, of a sweep or of a study. Every file of a completed run is compared with its checksum in
    SHA256SUMS, which reveals any changed byte. Prints one line for each folder and for each problem. The exit code is 5
    if a file is damaged or missing.
    """
    from mpmcol.integrity import verify as check
    from mpmcol.io.values import to_json as as_json

    reports = [report for folder in folders for report in check(folder)]
    is_intact = all(report.is_intact for report in reports)
    if to_json:
        found = [report.as_dict() for report in reports]
        click.echo(as_json({"schema": VERIFY_SCHEMA, "intact": is_intact, "folders": found}))
    else:
        for report in reports:
            click.echo("\n".join(_lines(report)))
    if not is_intact:
        context.exit(OutputError.exit_code)


def _lines(report: FolderReport) -> list[str]:
    damaged = len({finding.file for finding in report.findings if finding.is_damage})
    files = f"{report.files} file{'' if report.files == 1 else 's'}"
    if report.status == "running":
        verdict = "not checked"
    else:
        verdict = f"intact, {files}" if report.is_intact else f"DAMAGED, {damaged} of {files}"
    heading = f"{report.folder}: {verdict}{STATUS_TEXTS.get(report.status, '')}"
    return [heading, *(f"  {finding}" for finding in report.findings)]
