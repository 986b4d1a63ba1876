"""Checks of arguments that sweeps and studies share."""

from __future__ import annotations

from mpmcol.errors import UsageError

MOST_CONCURRENT = 1024  # far more than the cores of a machine; the system could not start them


def require_accuracy(accuracy: float | None, corrected: bool = False) -> None:
    """Raise UsageError for an accuracy out of range, and for corrected values without one."""
    if accuracy is not None and not 0.0 < accuracy < 1.0:
        raise UsageError(f"accuracy = {accuracy!r}: expected a relative error between 0 and 1, for example 0.05")
    if corrected and accuracy is None:
        raise UsageError("corrected values require an accuracy, which chooses the grid")


def require_count(name: str, value: int | None, least: int = 1, most: int = MOST_CONCURRENT) -> None:
    """Raise UsageError for a number of runs, threads or repetitions out of range; None is a default."""
    if value is not None and not least <= value <= most:
        raise UsageError(f"{name} = {value}: expected an integer from {least} to {most}")
