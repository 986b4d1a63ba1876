"""TOML texts: parsing, and the line numbers of the keys, which no parser in the standard library tells."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from typing import Any

KeyPath = tuple[str, ...]

_SEARCH_BUDGET = 500_000  # characters that are parsed at most, well under a second


def parse(text: str) -> dict[str, Any]:
    """Parse a TOML text. ValueError (of which TOMLDecodeError is one) or RecursionError if it is none.

    Integers must fit into 64 bits, as TOML demands; tomllib lets longer ones pass.
    """
    tables = tomllib.loads(text)
    if _has_long_integer(tables):
        raise ValueError("an integer of more than 64 bits")
    return tables


def _has_long_integer(value: Any) -> bool:
    if isinstance(value, dict | list):
        return any(map(_has_long_integer, value.values() if isinstance(value, dict) else value))
    return isinstance(value, int) and not -(2**63) <= value < 2**63


def locate(text: str) -> Iterator[tuple[KeyPath, int]]:
    """Find the line on which each key and table begins, in a text that parses as a whole.

    Statement after statement is parsed behind the header of its table; it ends where it first parses.
    In a text that takes too long, the last keys are left out.
    """
    header, start, spent = "", 0, 0
    seen: set[KeyPath] = set()
    lines = [line.rstrip("\r") for line in text.split("\n")]
    for end in range(1, len(lines) + 1):
        statement = "\n".join(lines[start:end])
        spent += len(header) + len(statement)
        if spent > _SEARCH_BUDGET:
            return
        is_header = statement.lstrip().startswith("[")
        try:
            parsed = tomllib.loads(statement if is_header else f"{header}\n{statement}")
        except (ValueError, RecursionError):
            continue
        for path in _paths(parsed):
            if path not in seen:
                seen.add(path)
                yield path, start + 1
        header, start = statement if is_header else header, end


def _paths(tables: dict[str, Any], prefix: KeyPath = ()) -> Iterator[KeyPath]:
    for name, value in tables.items():
        yield (*prefix, name)
        if isinstance(value, dict):
            yield from _paths(value, (*prefix, name))
