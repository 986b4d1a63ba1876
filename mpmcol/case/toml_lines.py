"""Parsing of TOML with limits, and line numbers of keys, which the parser of the standard library does not report."""

from __future__ import annotations

import re
import tomllib
from ast import literal_eval
from collections.abc import Iterator
from typing import Any

from mpmcol.case.fields import shortened

KeyPath = tuple[str, ...]

SYNTAX_ERROR = "not valid TOML: "
GIVEN_TWICE = "is given twice"

_SEARCH_BUDGET = 500_000  # maximum number of characters that are parsed, well under a second
_MAX_DEPTH = 20  # of nested tables and arrays; a case has 3
# what the parser reports about a table that is given twice
_REPEATED = re.compile(r"Cannot (?:declare|mutate immutable namespace|redefine namespace) (\(.*\))(?: twice)?")
# the memory of tomllib grows with the square of the number of parts of a key: gigabytes for a line of 100 kB
_NAME = r"""(?:"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+'|[\w-]++)"""
_DEEP_KEY = re.compile(rf"(?<![\w-]){_NAME}(?:[ \t]*+\.[ \t]*+{_NAME}){{{_MAX_DEPTH}}}", re.ASCII)


class TomlError(ValueError):
    """A text that is not valid TOML or exceeds the limits of a case; `line` counts from 1, None if unknown."""

    def __init__(self, reason: str, line: int | None = None) -> None:
        super().__init__(f"line {line}: {reason}" if line else reason)
        self.reason, self.line = reason, line


def parse(text: str) -> dict[str, Any]:
    """Parse a TOML text; raises TomlError.

    Integers must fit into 64 bits, as TOML requires (tomllib accepts longer ones), and nesting is limited.
    """
    deep = _DEEP_KEY.search(text)
    if deep:
        raise TomlError("a key has too many parts", text.count("\n", 0, deep.start()) + 1)
    try:
        return _parse_limited(text)
    except tomllib.TOMLDecodeError as failure:
        raise _syntax_error(text, str(failure)) from None
    except TomlError as error:
        raise TomlError(error.reason, _error_line(text)) from None


def _parse_limited(text: str) -> dict[str, Any]:
    """Parse a text within the limits of a case; raises TOMLDecodeError, or TomlError without a line."""
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise TomlError("arrays or tables are nested too deeply") from None
    except ValueError:  # Python's own limit, 4300 digits
        raise TomlError("integer with more than 64 bits") from None
    _check_limits(tables, _MAX_DEPTH)
    return tables


def _check_limits(value: Any, levels: int) -> None:
    if isinstance(value, int) and not -(2**63) <= value < 2**63:
        raise TomlError("integer with more than 64 bits")
    if isinstance(value, dict | list):
        if not levels:
            raise TomlError("arrays or tables are nested too deeply")
        for item in value.values() if isinstance(value, dict) else value:
            _check_limits(item, levels - 1)


def _syntax_error(text: str, failure: str) -> TomlError:
    position = re.search(r"at line (\d+)", failure)
    reason = SYNTAX_ERROR + _in_words(re.sub(r" \(at .*\)$", "", failure))
    return TomlError(reason, int(position[1]) if position else text.count("\n") + 1)


def _in_words(failure: str) -> str:
    """A message of the parser about a table that is given twice, which names it as Python does; others as they are."""
    if repeated := _REPEATED.fullmatch(failure):
        return f"[{shortened('.'.join(literal_eval(repeated[1])))}] {GIVEN_TWICE}"
    return failure


def _error_line(text: str) -> int | None:
    return next((line for line, tables in _statements(text) if tables is None), None)


def locate(text: str) -> Iterator[tuple[KeyPath, int]]:
    """Line on which each key and table begins, for a text that is valid as a whole.

    The path of an item of an array contains its index: ("layers", "0", "from"). In a text that takes too long to
    search, the last keys are omitted.
    """
    seen: set[KeyPath] = set()
    headers: dict[KeyPath, int] = {}  # number of [[headers]] of each array so far
    lines = text.split("\n")
    for line, tables in _statements(text):
        if lines[line - 1].lstrip().startswith("[[") and tables:
            (path,) = (path for path in _array_paths(tables))
            headers[path] = headers.get(path, 0) + 1
        for path in _paths(tables or {}, headers):
            if path not in seen:
                seen.add(path)
                yield path, line


def _statements(text: str) -> Iterator[tuple[int, dict[str, Any] | None]]:
    """First line of each statement, and its content within its table; None if it exceeds the limits.

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
            yield start + 1, _parse_limited(statement if is_header else f"{header}\n{statement}")
        except tomllib.TOMLDecodeError:
            continue
        except TomlError:
            yield start + 1, None
        header, start = statement if is_header else header, end


def _array_paths(tables: dict[str, Any], prefix: KeyPath = ()) -> Iterator[KeyPath]:
    """Paths of arrays, which contain nothing else, as a [[header]] gives them."""
    for name, value in tables.items():
        if isinstance(value, dict):
            yield from _array_paths(value, (*prefix, name))
        else:
            yield (*prefix, name)


def _paths(tables: dict[str, Any], headers: dict[KeyPath, int], prefix: KeyPath = ()) -> Iterator[KeyPath]:
    for name, value in tables.items():
        path = (*prefix, name)
        yield path
        if isinstance(value, dict) and path not in headers:
            yield from _paths(value, headers, path)
            continue
        # a statement below a [[header]] belongs to the last item
        items = value if isinstance(value, list) else [value]
        for k, item in enumerate(items, headers.get(path, 1) - 1):
            if isinstance(item, dict):
                yield (*path, str(k))
                yield from _paths(item, headers, (*path, str(k)))


def value_at(tables: Any, key: KeyPath) -> Any:
    """The value of a key, whose parts are names or indices. Raises KeyError."""
    for name in key:
        if isinstance(tables, dict) and name in tables:
            tables = tables[name]
        elif isinstance(tables, list) and name.isdecimal() and int(name) < len(tables):
            tables = tables[int(name)]
        else:
            raise KeyError(name)
    return tables
