"""One constraint between keys of a case, and conditions that several of them share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

SMALLER = "must be smaller than {1}"
LARGER = "must be larger than {1}"
AT_MOST = "must not exceed {1}"
NOT_BOTH = "must not be given together with {1}: remove one of them"


@dataclass(frozen=True)
class Constraint:
    """A condition on the values of `keys`; the message is about the first key, {1} in it is replaced by the second."""

    keys: tuple[str, ...]
    holds: Callable[..., bool]
    message: str


def less(smaller: float | None, larger: float | None) -> bool:
    return smaller is None or larger is None or smaller < larger


def at_most(smaller: float | None, larger: float | None) -> bool:
    return smaller is None or larger is None or smaller <= larger


def not_both(one: Any, other: Any) -> bool:
    return one is None or other is None
