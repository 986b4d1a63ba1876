"""TOML texts: parsing, and the line numbers of the keys, which no parser in the standard library tells."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from typing import Any

KeyPath = tuple[str, ...]

NO_TOML = "not valid TOML: "

_SEARCH_BUDGET = 500_000  # characters that are parsed at most, well under a second
_DEEPEST = 20  # tables and arrays in one another: a case has 3
# tomllib takes memory with the square of a key's parts: gigabytes for one line of 100 kB
_NAME = r"""(?:"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+'|[\w-]++)"""
_DEEP_KEY = re.compile(rf"(?<![\w-]){_NAME}(?:[ \t]*+\.[ \t]*+{_NAME}){{{_DEEPEST}}}", re.ASCII)


class Unfit(ValueError):
    """A text that is no TOML, or not what a case can hold: why, in words, and the line from 1, None if unknown."""

    def __init__(self, reason: str, line: int | None = None) -> None:
        super().__init__(f"line {line}: {reason}" if line else reason)
        self.reason, self.line = reason, line


def parse(text: str) -> dict[str, Any]:
    """Parse a TOML text; raises Unfit.

    Integers must fit into 64 bits, as TOML demands (tomllib lets longer ones pass), and little may be nested.
    """
    deep = _DEEP_KEY.search(text)
    if deep:
        raise Unfit("keys have too many parts", text.count("\n", 0, deep.start()) + 1)
    try:
        return _fitting(text)
    except tomllib.TOMLDecodeError as failure:
        raise _syntax_error(text, str(failure)) from None
    except Unfit as unfit:
        raise Unfit(unfit.reason, _unfit_line(text)) from None


def _fitting(text: str) -> dict[str, Any]:
    """What tomllib makes of a text, if a case can hold it; TOMLDecodeError or Unfit without a line."""
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise Unfit("arrays or tables are nested too deeply") from None
    except ValueError:  # Python's own limit, 4300 digits
        raise Unfit("an integer of more than 64 bits") from None
    _refuse_misfits(tables, _DEEPEST)
    return tables


def _refuse_misfits(value: Any, levels: int) -> None:
    if isinstance(value, int) and not -(2**63) <= value < 2**63:
        raise Unfit("an integer of more than 64 bits")
    if isinstance(value, dict | list):
        if not levels:
            raise Unfit("arrays or tables are nested too deeply")
        for item in value.values() if isinstance(value, dict) else value:
            _refuse_misfits(item, levels - 1)


def _syntax_error(text: str, failure: str) -> Unfit:
    place = re.search(r"at line (\d+)", failure)
    return Unfit(NO_TOML + re.sub(r" \(at .*\)$", "", failure), int(place[1]) if place else text.count("\n") + 1)


def _unfit_line(text: str) -> int | None:
    return next((line for line, tables in _statements(text) if tables is None), None)


def locate(text: str) -> Iterator[tuple[KeyPath, int]]:
    """Find the line on which each key and table begins, in a text that parses as a whole.

    In a text that takes too long, the last keys are left out.
    """
    seen: set[KeyPath] = set()
    for line, tables in _statements(text):
        for path in _paths(tables or {}):
            if path not in seen:
                seen.add(path)
                yield path, line


def _statements(text: str) -> Iterator[tuple[int, dict[str, Any] | None]]:
    """The line on which each statement begins, and what it says behind the header of its table, None if unfit.

    A statement ends where it first parses.
    """
    header, start, spent = "", 0, 0
    lines = [line.rstrip("\r") for line in text.split("\n")]
    for end in range(1, len(lines) + 1):
        statement = "\n".join(lines[start:end])
        spent += len(header) + len(statement)
        if spent > _SEARCH_BUDGET:
            return
        is_header = statement.lstrip().startswith("[")
        try:
            yield start + 1, _fitting(statement if is_header else f"{header}\n{statement}")
        except tomllib.TOMLDecodeError:
            continue
        except Unfit:
            yield start + 1, None
        header, start = statement if is_header else header, end


def _paths(tables: dict[str, Any], prefix: KeyPath = ()) -> Iterator[KeyPath]:
    for name, value in tables.items():
        yield (*prefix, name)
        if isinstance(value, dict):
            yield from _paths(value, (*prefix, name))
