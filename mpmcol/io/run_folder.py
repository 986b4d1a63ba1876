"""The results folder of a run: prepare it, reopen it to resume, write history.csv and result.json."""

from __future__ import annotations

import csv
import hashlib
import io
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from mpmcol.case import Case, case_hash
from mpmcol.errors import OutputError, UsageError
from mpmcol.io.atomic import atomic_write, is_temporary, make_folder, read_bytes, remove
from mpmcol.io.checksums import checksum_of, write_checksums
from mpmcol.io.columns import header
from mpmcol.io.lock import locked
from mpmcol.io.names import (
    CASE_FILE,
    CHECKSUM_FILE,
    GIVEN_CASE_FILE,
    HISTORY_FILE,
    INDEX_FILES,
    LOCK_FILE,
    LOG_FILE,
    OWN_FILES,
    PRESSURE_FILE,
    RESULT_FILE,
)
from mpmcol.io.results import HISTORY, Results
from mpmcol.io.values import to_json


def prepare_folder(folder: Path, case: Case, fresh: bool, notify: Callable[[str], None]) -> None:
    """Remove the files of an earlier run: a failed or stopped one, or any if `fresh`.

    notify: receives a line if the removed run was of another case.

    Raises UsageError if the folder holds a finished run or files that are not a run's, OutputError if it cannot be
    emptied.
    """
    if (folder / RESULT_FILE).exists() and not fresh:
        if _is_finished(folder):
            raise UsageError(f"{folder} holds a finished run; use --fresh to replace it, or --out for another folder")
        if Results(folder).summary.get("case_hash") != case_hash(case):
            notify(f"note: an incomplete run of another case in {folder} is replaced")
    require_no_foreign_files(folder)
    if (folder / CASE_FILE).exists():
        _remove_run(folder)


def require_no_foreign_files(folder: Path) -> None:
    """Raise UsageError if the folder has files, but no run."""
    found = {path.name for path in folder.iterdir() if not is_temporary(path)} if folder.is_dir() else set()
    if found - {LOCK_FILE, GIVEN_CASE_FILE, LOG_FILE} and CASE_FILE not in found:
        raise UsageError(f"{folder} is not empty and holds no run; use --out for another folder")


def discard_run(folder: Path) -> None:
    """Remove the files of a run, finished or not, except its input case; nothing if there is no such folder.

    Raises OutputError, also if a run is writing there.
    """
    if folder.is_dir():
        with locked(folder):
            _remove_run(folder)


def _remove_run(folder: Path) -> None:
    """Remove all files of a run except its input case."""
    for pattern in (LOG_FILE, *OWN_FILES):
        for path in folder.glob(pattern):
            remove(path)


def replace_run(source: Path, folder: Path) -> None:
    """Replace the run in `folder` by the finished run in `source`; the files are linked or, where links fail, copied.

    Raises OutputError.
    """
    with locked(folder):
        _remove_run(folder)
        for pattern in (LOG_FILE, GIVEN_CASE_FILE, *reversed(OWN_FILES)):  # the result last
            for path in sorted(source.glob(pattern)):
                for file in sorted(path.iterdir()) if path.is_dir() else [path]:
                    _link(file, folder / file.relative_to(source))


def _link(source: Path, target: Path) -> None:
    make_folder(target.parent)
    try:
        target.unlink(missing_ok=True)
        os.link(source, target)
    except OSError:
        atomic_write(target, read_bytes(source))


def reopen_folder(folder: Path) -> None:
    """Remove the result of a stopped run, which is resumed. Raises OutputError."""
    for name in (RESULT_FILE, CHECKSUM_FILE):
        remove(folder / name)


def _is_finished(folder: Path) -> bool:
    if not (folder / CASE_FILE).exists():
        return True
    return Results(folder).status == "done"


def write_history(folder: Path, rows: Sequence[Mapping[str, Any]], model: str = "") -> None:
    """Write history.csv. Raises OutputError.

    model: geometry.model, on which the unit of energies depends; without it the unit is J.
    """
    names = [*HISTORY, *(name for name in (rows[0] if rows else {}) if name not in HISTORY)]
    _write_table(folder / HISTORY_FILE, names, rows, model)


def write_pressure(folder: Path, rows: Sequence[Mapping[str, Any]], model: str) -> None:
    """Write wall_pressure.csv; nothing without rows. Raises OutputError."""
    if rows:
        _write_table(folder / PRESSURE_FILE, list(rows[0]), rows, model)


def _write_table(path: Path, names: Sequence[str], rows: Sequence[Mapping[str, Any]], model: str) -> None:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(header(names, path.name, model))
    csv.DictWriter(text, names, lineterminator="\n").writerows(rows)
    atomic_write(path, text.getvalue().encode())


def write_result(folder: Path, result: Mapping[str, Any], snapshots: Mapping[str, str] | None = None) -> None:
    """Write result.json, and before it the checksums of all files of the run, including result.json.

    snapshots: checksums of the snapshots at the time of writing, by file name. Raises OutputError, also if one of these
    files is missing.
    """
    content = (to_json(result, indent=1) + "\n").encode()
    for name in snapshots or ():
        if not (folder / name).is_file():
            raise OutputError(f"{folder / name} was removed during the run; run the case again with --fresh")
    names = (GIVEN_CASE_FILE, CASE_FILE, HISTORY_FILE, PRESSURE_FILE, *INDEX_FILES)
    others = [name for name in names if (folder / name).exists()]
    checksums = {name: checksum_of(folder / name) for name in others} | dict(snapshots or {})
    write_checksums(folder, checksums | {RESULT_FILE: hashlib.sha256(content).hexdigest()})
    atomic_write(folder / RESULT_FILE, content)
