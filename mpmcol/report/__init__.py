"""Reports: a run, several runs side by side, a sweep or a study as one self-contained HTML file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mpmcol.errors import UsageError
from mpmcol.report.collect import collect
from mpmcol.report.page import render_page
from mpmcol.report.target import default_target, write_page


def write_report(folders: Sequence[Path], *, out: Path | None = None, overwrite: bool = False) -> Path:
    """Write the report of a run, of several runs, of a sweep or of a study; return its path.

    Args:
        folders: of one run, sweep or study, or of several runs, which are compared with the first.
        out: HTML file to write (default: report.html in the only folder, or in the current folder).
        overwrite: replace the file even if it is not an earlier report.

    Raises:
        UsageError: no such report can be made of these folders, or the file is not a report.
        OutputError: a file of a folder is missing or damaged, or the report cannot be written.
    """
    if not folders:
        raise UsageError("no folder given; expected that of a run, a sweep or a study")
    target = out or default_target(folders)
    write_page(target, lambda: render_page(collect(folders)), overwrite)
    return target
