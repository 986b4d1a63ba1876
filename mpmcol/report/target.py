"""The file of a report: where it is, and when it may be replaced."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.atomic import atomic_write
from mpmcol.io.names import REPORT_FILE

GENERATOR = '<meta name="generator" content="mpmcol'  # in the first bytes of a report
HEAD = 1024  # bytes


def default_target(folders: Sequence[Path]) -> Path:
    """report.html in the only folder; for several folders, in the current folder."""
    return folders[0] / REPORT_FILE if len(folders) == 1 else Path(REPORT_FILE)


def write_page(path: Path, make: Callable[[], str], overwrite: bool) -> None:
    """Write the page that `make` returns; an earlier report is replaced, another file only if `overwrite`.

    Raises UsageError, OutputError.
    """
    if path.is_dir():
        raise UsageError(f"{path} is a folder; give the HTML file to write, for example --out {path / REPORT_FILE}")
    if path.exists() and not overwrite and not _is_report(path):
        raise UsageError(
            f"{path} exists and is not a report of mpmcol; use --overwrite to replace it, or --out for another file"
        )
    page = make()  # after the check, before the folder is needed: most errors are in the results
    if not path.parent.is_dir():
        raise OutputError(f"{path}: the folder {path.parent} does not exist; create it or choose another one")
    atomic_write(path, page.encode())


def _is_report(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return GENERATOR.encode() in file.read(HEAD)
    except OSError:
        return False
