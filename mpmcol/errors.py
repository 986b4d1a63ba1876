"""Errors that are meant to be read by a person; the command line prints them and exits with their code."""

from __future__ import annotations

from typing import Any


class MpmcolError(Exception):
    """Any failure whose message says what happened, where, and how to mend it."""

    exit_code = 1


class UsageError(MpmcolError):
    """The command or call cannot be carried out as it was asked for."""

    exit_code = 2


class CaseError(MpmcolError):
    """A case file or an override is wrong; `problems` lists everything that was found."""

    exit_code = 2

    def __init__(self, message: str, problems: tuple[Any, ...] = ()) -> None:
        super().__init__(message)
        self.problems = problems


class NumericalFailure(MpmcolError):
    """The simulation diverged; `failure` holds cause, stage, step, time, point, position, value and remedy."""

    exit_code = 3

    def __init__(self, message: str, failure: dict[str, Any]) -> None:
        super().__init__(message)
        self.failure = failure


class Interrupted(MpmcolError):
    """A run was asked to end and has kept its state; the same command goes on with it."""

    exit_code = 75


class OutputError(MpmcolError):
    """A file could not be written or read."""

    exit_code = 5
