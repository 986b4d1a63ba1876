"""mpmcol verify: whether the files of runs are as they were written."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mpmcol.errors import OutputError

if TYPE_CHECKING:
    from mpmcol.integrity import Report

VERIFY_SCHEMA = 1
STATES = {
    "failed": ", of a run that diverged",
    "stopped": ", of a run that was stopped; the same command goes on with it",
    "unfinished": ", of an unfinished run; the same command goes on with it",
    "missing": ", no run was begun",
}


@click.command()
@click.argument("folders", metavar="DIR...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print one line of JSON.")
@click.pass_context
def verify(context: click.Context, folders: tuple[Path, ...], as_json: bool) -> None:
    """Check every file of the runs in DIR and below: a line for each folder, and for all that is wrong in it.

    Every file of a run that has ended is compared with its digest in SHA256SUMS, so that no changed byte goes unseen.
    DIR may be the folder of a run, a sweep or a study. The exit code is 5 if a file is damaged or missing.
    """
    import json

    from mpmcol.integrity import verify as check

    reports = [report for folder in folders for report in check(folder)]
    is_sound = all(report.is_sound for report in reports)
    if as_json:
        found = [report.as_dict() for report in reports]
        click.echo(json.dumps({"schema": VERIFY_SCHEMA, "sound": is_sound, "folders": found}))
    else:
        for report in reports:
            click.echo("\n".join(_lines(report)))
    if not is_sound:
        context.exit(OutputError.exit_code)


def _lines(report: Report) -> list[str]:
    damaged = len({finding.file for finding in report.findings if finding.is_damage})
    files = f"{report.files} file{'' if report.files == 1 else 's'}"
    if report.state == "running":
        told = "not checked"
    else:
        told = f"sound, {files}" if report.is_sound else f"DAMAGED, {damaged} of {files}"
    return [f"{report.folder}: {told}{STATES.get(report.state, '')}", *(f"  {finding}" for finding in report.findings)]
