"""Selection of items by the names that a user gives."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import Protocol, TypeVar

from mpmcol.errors import UsageError


class Named(Protocol):
    """An item with a name such as "group-item"."""

    @property
    def name(self) -> str: ...


Item = TypeVar("Item", bound=Named)


def suggestion(name: str, known: Iterable[str]) -> str:
    """Hint for an unknown name: the most similar known name, or all known names."""
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
