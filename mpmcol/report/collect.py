"""What the folders hold, and the content of their report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.names import CASE_FILE
from mpmcol.io.results import kind_of
from mpmcol.report.finished import finished_run
from mpmcol.report.model import Page
from mpmcol.report.runs import comparison_page, run_page
from mpmcol.sweep.plan import PLAN_FILE


def collect(folders: Sequence[Path]) -> Page:
    """Content of the report of one run, sweep or study, or of several runs.

    Raises:
        UsageError: a run has not ended, or one of several folders is not a run.
        OutputError: a folder holds nothing to report, or a file in it is missing or damaged.
    """
    if len(folders) == 1:
        return _page(folders[0])
    from mpmcol.report.study import is_study

    for folder in folders:
        if not _is_run(folder) and (_is_sweep(folder) or is_study(folder)):
            raise UsageError(f"{folder} is not a single run; only runs are compared with each other: give it alone")
    repeated = [folder for folder in folders if [one.resolve() for one in folders].count(folder.resolve()) > 1]
    if repeated:
        raise UsageError(f"{repeated[0]} is given twice; give each run once")
    return comparison_page([finished_run(folder) for folder in folders])


def _page(folder: Path) -> Page:
    if _is_run(folder):
        return run_page(finished_run(folder))
    from mpmcol.report.study import is_study, study_page  # here: the report of a run does not wait for them
    from mpmcol.report.sweep import sweep_page

    if _is_sweep(folder):
        return sweep_page(folder)
    if is_study(folder):
        return study_page(folder)
    problem = f"{folder}: nothing to report here" if folder.is_dir() else kind_of(folder)
    raise OutputError(
        f"{problem}; expected the folder of a finished run (with {CASE_FILE}), of a sweep (with "
        f"{PLAN_FILE}) or of a study"
    )


def _is_run(folder: Path) -> bool:
    return (folder / CASE_FILE).is_file()


def _is_sweep(folder: Path) -> bool:
    return (folder / PLAN_FILE).is_file()
