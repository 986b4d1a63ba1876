"""Integrity of results: every run in or below a folder, and the tables and charts made from runs."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from mpmcol.errors import OutputError
from mpmcol.integrity.readable import read_error
from mpmcol.integrity.report import Finding, FolderReport
from mpmcol.integrity.run import check_run
from mpmcol.io.names import (
    CASE_FILE,
    CHECKPOINT_FILES,
    CHECKSUM_FILE,
    ENVIRONMENT_FILE,
    GIVEN_CASE_FILE,
    HISTORY_FILE,
    RESULT_FILE,
    SNAPSHOT_FOLDER,
)
from mpmcol.sweep.plan import PLAN_FILE

__all__ = ["Finding", "FolderReport", "verify"]

RUN_FILES = {
    RESULT_FILE, CHECKSUM_FILE, HISTORY_FILE, CASE_FILE, GIVEN_CASE_FILE, SNAPSHOT_FOLDER, *CHECKPOINT_FILES
}  # fmt: skip
DERIVING_FILES = {PLAN_FILE, ENVIRONMENT_FILE}  # of a sweep or study, which has tables and charts beside them


def verify(folder: Path) -> list[FolderReport]:
    """Check the run in a folder, or all runs in the folders below with the tables and charts made from them.

    Raises OutputError if there is no run.
    """
    reports: list[FolderReport] = []
    for path, names in _folders(folder):
        if RUN_FILES & set(names):
            reports.append(check_run(path))
        elif DERIVING_FILES & set(names):
            reports.append(_check_derived(path, names))
    if not any(report.status for report in reports):
        raise OutputError(f"{folder}: no run found; expected the folder of a run, or a folder above such folders")
    return reports


def _folders(top: Path) -> Iterator[tuple[Path, list[str]]]:
    """A folder and those below it, each with the names in it; folders inside that of a run are left out."""
    for root, folders, files in os.walk(top):
        names = sorted(folders + files)
        folders[:] = [] if RUN_FILES & set(names) - {GIVEN_CASE_FILE} else sorted(folders)
        yield Path(root), names


def _check_derived(folder: Path, names: list[str]) -> FolderReport:
    """Check tables and charts of a sweep or a study, which can be written again from its runs."""
    paths = [folder / name for name in names if (folder / name).is_file()]
    remedy = "delete it, and repeat the command that wrote it; the runs are kept"
    findings = [Finding(path.name, what, remedy) for path in paths if (what := read_error(path))]
    return FolderReport(folder, "", len(paths), tuple(findings))
