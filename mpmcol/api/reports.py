"""Reports of runs, sweeps and studies."""

from __future__ import annotations

from pathlib import Path

from mpmcol.io.results import Results
from mpmcol.report import write_report


def report(*runs: Results | Path | str, out: Path | str | None = None, overwrite: bool = False) -> Path:
    """Write a report as one HTML file, as `mpmcol report` does; return its path.

    Args:
        runs: results of a finished run, or the folder of a run, a sweep or a study; several runs are compared with the
            first.
        out: the HTML file (default: report.html in the only folder, or in the current folder).
        overwrite: replace the file even if it is not an earlier report.

    Raises:
        UsageError: no such report can be made of these folders, or the file is not a report.
        OutputError: a file of a folder is missing or damaged, or the report cannot be written.
    """
    folders = [Path(run.folder if isinstance(run, Results) else run) for run in runs]
    return write_report(folders, out=None if out is None else Path(out), overwrite=overwrite)
