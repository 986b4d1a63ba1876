"""Errors for the user; the command line prints their message and exits with their code."""

from __future__ import annotations

from typing import Any


class MpmcolError(Exception):
    """Base class of all errors of mpmcol; the message states what happened, where, and how to fix it."""

    exit_code = 1


class UsageError(MpmcolError):
    """Invalid arguments of a command or function."""

    exit_code = 2


class CaseError(MpmcolError):
    """Invalid case file or override; `problems` lists all problems."""

    exit_code = 2

    def __init__(self, message: str, problems: tuple[Any, ...] = ()) -> None:
        super().__init__(message)
        self.problems = problems


class NumericalFailure(MpmcolError):
    """A simulation failed; `failure` holds cause, stage, step, time, point, position, value and remedy."""

    exit_code = 3

    def __init__(self, message: str, failure: dict[str, Any]) -> None:
        super().__init__(message)
        self.failure = failure


class Interrupted(MpmcolError):
    """A run was stopped by a signal or a time limit and wrote a checkpoint; the same command resumes it."""

    exit_code = 75


class OutputError(MpmcolError):
    """A file could not be written or read, or is damaged."""

    exit_code = 5
