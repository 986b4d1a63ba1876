"""What a sweep replaces in its folder: runs that leave the table, and a report of an earlier table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from shlex import quote

from mpmcol.errors import OutputError
from mpmcol.io.names import REPORT_FILE
from mpmcol.sweep.runs import PlannedRun
from mpmcol.sweep.table import CSV_FILE, read_table

MOST_NAMED = 5


def runs_that_leave(folder: Path, runs: Sequence[PlannedRun]) -> Iterator[str]:
    """A note if the table in a folder has runs that are not among those of the sweep that will replace it."""
    try:
        rows = read_table(folder / CSV_FILE, ("folder",))
    except (OutputError, OSError):
        return  # no table, or none that can be read; a path that cannot be used is refused elsewhere
    planned = {run.folder.name for run in runs}
    if others := [row["folder"] for row in rows if row["folder"] not in planned]:
        names = ", ".join(others[:MOST_NAMED]) + (", ..." if len(others) > MOST_NAMED else "")
        which = f"{len(others)} of the {len(rows)} runs in {folder / CSV_FILE}"
        yield (
            f"{which} {'is' if len(others) == 1 else 'are'} not part of this sweep, which replaces table and charts "
            f"and keeps the folders of the runs: {names}; use --out for another folder"
        )


def outdated_report(folder: Path) -> Iterator[str]:
    """A note if the report in the folder of a sweep is older than its table."""
    report, table = folder / REPORT_FILE, folder / CSV_FILE
    if report.exists() and table.exists() and report.stat().st_mtime_ns < table.stat().st_mtime_ns:
        yield f"{report} is older than the table; `mpmcol report {quote(str(folder))}` writes it again"
