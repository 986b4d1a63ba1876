"""Whether the files of runs are as they were written: every run in or below a folder, and the tables made of them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from mpmcol.errors import OutputError
from mpmcol.integrity.finding import Finding, Report
from mpmcol.integrity.readable import READERS, unreadable
from mpmcol.integrity.run import check_run
from mpmcol.io.names import CASE_FILE, CHECKPOINT_FILES, CHECKSUM_FILE, GIVEN_CASE_FILE, HISTORY_FILE, RESULT_FILE

__all__ = ["Finding", "Report", "verify"]

OF_A_RUN = {RESULT_FILE, CHECKSUM_FILE, HISTORY_FILE, CASE_FILE, GIVEN_CASE_FILE, "snapshots", *CHECKPOINT_FILES}


def verify(folder: Path) -> list[Report]:
    """Check the run in a folder, or all runs in the folders below it with the tables and charts made of them.

    Raises OutputError if there is no run.
    """
    reports: list[Report] = []
    for path, names in _folders(folder):
        if OF_A_RUN & set(names):
            reports.append(check_run(path))
        elif any(Path(name).suffix in READERS for name in names):
            reports.append(_check_others(path, names))
    if not any(report.state for report in reports):
        raise OutputError(f"{folder}: no run in it; expected the folder of a run, or one above such folders")
    return reports


def _folders(top: Path) -> Iterator[tuple[Path, list[str]]]:
    """A folder and those below it, with the names in them; those inside of a run's folder are its own business."""
    for root, folders, files in os.walk(top):
        names = sorted(folders + files)
        folders[:] = [] if OF_A_RUN & set(names) - {GIVEN_CASE_FILE} else sorted(folders)
        yield Path(root), names


def _check_others(folder: Path, names: list[str]) -> Report:
    """Tables and charts of a sweep or a study, which are made anew from its runs."""
    paths = [folder / name for name in names if (folder / name).is_file()]
    remedy = "delete it; the command that made it makes it anew from the runs"
    findings = [Finding(path.name, why, remedy) for path in paths if (why := unreadable(path))]
    return Report(folder, "", len(paths), tuple(findings))
