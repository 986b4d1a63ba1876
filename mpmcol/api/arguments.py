"""Arguments that the functions of the interface share."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

from mpmcol.io.results import Results

NOTE = "note: "
Notify = Callable[[str], None]  # one line for the user


def as_results(run: Results | Path | str) -> Results:
    """The results of a run, given by themselves or by their folder. Raises OutputError."""
    return run if isinstance(run, Results) else Results(run)


def warn(line: str) -> None:
    """Issue a note as a warning of Python; other messages are not shown."""
    if line.startswith(NOTE):
        warnings.warn(line.removeprefix(NOTE), stacklevel=3)
