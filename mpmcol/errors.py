"""Errors for the user, whose message and exit code the command line uses; selection of items by name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Protocol, TypeVar


class MpmcolError(Exception):
    """Base class of all errors of mpmcol; the message states what happened, where, and how to fix it."""

    exit_code = 1


class UsageError(MpmcolError):
    """Invalid arguments of a command or function."""

    exit_code = 2


class UnfitCase(UsageError):
    """A valid case that cannot be run: the key to change, what is wrong with its value, and the remedy."""

    def __init__(self, key: str, message: str, remedy: str) -> None:
        super().__init__(f"{message}; {remedy}")
        self.key = key
        self.message = message
        self.remedy = remedy


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


class Named(Protocol):
    """An item with a name such as "group-item"."""

    @property
    def name(self) -> str: ...


Item = TypeVar("Item", bound=Named)


def suggestion(name: str, known: Iterable[str]) -> str:
    """Hint for an unknown name: the most similar known name, or all known names."""
    from difflib import get_close_matches  # imported here, because every command imports this module

    known = list(known)
    near = get_close_matches(name, known, n=1)
    return f"did you mean {near[0]!r}?" if near else f"known: {', '.join(known)}"


def matches(item: Named, name: str) -> bool:
    """Whether the item has this name or belongs to the group of this name ("group" matches "group-item")."""
    return item.name == name or item.name.startswith(f"{name}-")


def select(items: Sequence[Item], names: Sequence[str], kind: str) -> list[Item]:
    """The items that match any of the names, in their own order; all items if no names are given.

    Raises UsageError for a name that matches no item; `kind` names the items in the message.
    """
    for name in names:
        if not any(matches(item, name) for item in items):
            raise UsageError(f"no {kind} is called {name!r}; {suggestion(name, (item.name for item in items))}")
    return [item for item in items if not names or any(matches(item, name) for name in names)]
