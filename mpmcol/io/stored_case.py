"""The case in a results folder, as the run has written it."""

from __future__ import annotations

from pathlib import Path

from mpmcol.case import Case, case_hash, load_case
from mpmcol.errors import CaseError, OutputError
from mpmcol.io.checksums import has_checksum, listed_checksums


def read_stored_case(path: Path) -> Case:
    """The case in a file that a run or a sweep has written. Raises OutputError if it is damaged."""
    try:
        return load_case(path)
    except CaseError as error:
        problem = error.problems[0]
        location = f"{path}:{problem.line}" if problem.line else str(path)
        raise OutputError(
            f"{location}: {problem.message}; this file was changed after it was written, or another version of mpmcol "
            "wrote it: restore it from a copy, or run the case again with --fresh"
        ) from None


def require_unchanged(path: Path, case: Case, simulated: str | None) -> None:
    """Raise OutputError if the case in a file is not the one that was simulated.

    simulated: hash of the simulated case; nothing is checked without it. The hash of an unchanged file can differ if
    another version of mpmcol has written it, whose keys and defaults were others.
    """
    found = case_hash(case)
    if simulated in (None, found):
        return
    checksum = listed_checksums(path.parent).get(path.name)
    if checksum is None or not has_checksum(path, checksum):
        raise OutputError(
            f"{path}: this is not the case that was simulated: its case_hash is {found}, expected {simulated} as in "
            "result.json; restore the file from a copy, or run the case again with --fresh"
        )
