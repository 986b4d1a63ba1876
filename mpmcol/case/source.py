"""Finding and reading of case files, inheritance by `extends`, overrides."""

from __future__ import annotations

import codecs
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from mpmcol.case.fields import nearest, shortened, shown
from mpmcol.case.outline import read_outline
from mpmcol.case.overrides import Override, apply_overrides, merge_cases
from mpmcol.case.problem import Problem, case_error, set_option
from mpmcol.case.small_file import read_small
from mpmcol.case.toml_lines import GIVEN_TWICE, SYNTAX_ERROR, KeyPath, TomlError, locate, parse, value_at
from mpmcol.errors import CaseError

MAX_FILE_SIZE = 200_000  # bytes
UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)  # what `>` of Windows PowerShell writes
OUTLINE: KeyPath = ("geometry", "outline")
_LONGEST_LINE = 200  # characters that are searched for a hint
_MOST_NAMED = 3  # files of a folder in a hint
_LIST_HINT = "(mpmcol cases lists the shipped cases)"

_YAML = (".yaml", ".yml", ".json")
_PATH_HINT = "write paths with / or in single quotes"
_OTHER_FORMAT = "a case file is TOML: [table], then key = value"
# what the line of a syntax error is likely to mean, before the hints by the parser's message
_LINE_HINTS = {
    r"[^=]*=\s*[-+]?\d+,\d": "the decimal separator is a point",
    r"[^=]*=\s*[-+]?\.\d": "write a digit before the decimal point",
    r"[^=]*=\s*[-+]?\d+\.(?!\d)": "write a digit after the decimal point",
    r'\s*(- |---|\{|(- )?"?[\w-]+"?\s*:(\s|$))': _OTHER_FORMAT,
    r'[^=]*=\s*"[^"]*\\': _PATH_HINT,
    r'[^="]*=\s*"[^"]*$': "close the quotes at the end of the value",
    r"(?i)[^=]*=\s*(yes|no|on|off|true|false)\b": "write true or false, in small letters",
}
_SYNTAX_HINTS = {
    "Invalid value": "put strings in quotes",
    "Expected newline or end of document after a statement": "put strings and numbers with a unit in quotes",
    """Expected "'\"""": "close the single quotes at the end of a value",
    "Cannot overwrite a value": "remove one of the two: this key is given twice",
}


@dataclass(frozen=True)
class Source:
    """The content of a case file; `name` is its name in messages."""

    name: str
    path: Path
    text: str
    tables: dict[str, Any]

    @cached_property
    def lines(self) -> dict[KeyPath, int]:
        """First line of each key and table."""
        return dict(locate(self.text))

    def location(self, key: KeyPath) -> tuple[int | None, str]:
        """Number and content of the line of a key; if it is absent, of its table."""
        prefixes = (key[:length] for length in range(len(key), 0, -1))
        line = next((self.lines[prefix] for prefix in prefixes if prefix in self.lines), None)
        return line, self._rows[line - 1].rstrip("\r") if line else ""

    @cached_property
    def _rows(self) -> list[str]:
        return self.text.split("\n")


@dataclass(frozen=True)
class CaseInput:
    """The input of a case: merged tables, and the files and overrides that they were given by."""

    tables: dict[str, Any]
    chain: Sequence[Source]  # the case file, then the cases that it extends
    overrides: Mapping[KeyPath, Override]

    @property
    def main(self) -> Source:
        """The case file."""
        return self.chain[0]

    def override_of(self, key: KeyPath) -> Override | None:
        """Override that set a key or a part of it."""
        touching = (o for path, o in self.overrides.items() if key[: len(path)] == path[: len(key)])
        return next(touching, None)

    def source_of(self, key: KeyPath) -> Source:
        """File that gives a key its value; if the key is absent, that of its table."""
        given = [key[:length] for length in range(len(key), 0, -1) if self.has(key[:length])]
        return next((link for part in given for link in self.chain if _has(link.tables, part)), self.main)

    def has(self, key: KeyPath) -> bool:
        """Whether a key was given."""
        return _has(self.tables, key)


def shipped_cases() -> dict[str, Path]:
    """Shipped cases by name, from the installed package or from the repository."""
    package = Path(__file__).parents[1]
    candidates = (package / "cases", package.parent / "cases")
    folder = next((path for path in candidates if path.is_dir()), package)
    return {path.stem: path for path in sorted(folder.glob("*.toml"), key=lambda path: path.stem)}


def read_case(source: str | Path, overrides: Mapping[KeyPath, Override]) -> CaseInput:
    """Read a case file or a shipped case with the cases that it extends and its outline, and apply the overrides.

    Raises CaseError if a file cannot be read.
    """
    chain = read_chain(source)
    tables: dict[str, Any] = {}
    for link in reversed(chain):
        tables = merge_cases(tables, {name: value for name, value in link.tables.items() if name != "extends"})
    apply_overrides(tables, overrides)
    given = CaseInput(tables, chain, overrides)
    _read_outline(given)
    return given


def read_chain(source: str | Path) -> list[Source]:
    """Read a case file and the cases that it extends, directly or not; the case itself comes first."""
    chain = [read_source(*_find(source))]
    while "extends" in (last := chain[-1]).tables:
        parent = read_source(*_find_parent(last))
        if parent.path in (link.path for link in chain):
            raise _extends_error(last, "the case extends itself, directly or through another case")
        chain.append(parent)
    return chain


def _read_outline(given: CaseInput) -> None:
    """Replace the path of an outline by the points in the file, in place."""
    geometry = given.tables.get("geometry")
    name = geometry.get("outline") if isinstance(geometry, dict) else None
    if not isinstance(name, str):
        return
    override, source = given.override_of(OUTLINE), given.source_of(OUTLINE)
    path = Path(name) if override else source.path.parent / name
    try:
        given.tables["geometry"]["outline"] = read_outline(path)
    except ValueError as wrong:
        message, hint = f"[geometry] outline = {shown(name)}: {wrong}", _escape_hint(name)
        if override:
            raise _error(set_option(override.argument), message, hint=hint, key="geometry.outline") from None
        raise _error(source.name, message, *source.location(OUTLINE), hint, "geometry.outline") from None


def _has(tables: dict[str, Any], key: KeyPath) -> bool:
    try:
        value_at(tables, key)
    except KeyError:
        return False
    return True


def _find(source: str | Path) -> tuple[str, Path]:
    shipped = shipped_cases()
    if isinstance(source, str) and source in shipped:
        return source + ".toml", shipped[source]
    if not str(source).strip():
        raise _error('""', "expected the path of a case file or the name of a shipped case", hint=_LIST_HINT)
    path, name = Path(source), shortened(str(source), 200)
    if not os.path.exists(path):  # unlike Path.exists, accepts names that cannot exist
        raise _error(name, "no such case file", hint=_suggestion(path, Path(), shipped))
    return name, path


def _suggestion(path: Path, folder: Path, shipped: dict[str, Path]) -> str:
    """Hint for the path of a file that does not exist, relative to `folder`."""
    stem = str(path).removesuffix(path.suffix) if path.suffix.lower() in _YAML else str(path)
    for other in (f"{stem}.toml", str(path).replace("\\", "/")):
        if os.path.isfile(folder / other):
            return f'did you mean "{other}"?'
    near = nearest(path.name.removesuffix(".toml"), shipped)
    return f'did you mean the shipped case "{near}"?   {_LIST_HINT}' if near else _LIST_HINT


def _find_parent(child: Source) -> tuple[str, Path]:
    parent = child.tables["extends"]
    if not isinstance(parent, str):
        raise _extends_error(child, "expected the name of a shipped case or a path, in quotes")
    beside = child.path.parent / parent
    if os.path.isfile(beside):
        return str(Path(child.name).parent / parent), beside
    shipped = shipped_cases()
    if parent in shipped:
        return parent + ".toml", shipped[parent]
    hint = _escape_hint(parent) or _suggestion(Path(parent), child.path.parent, shipped)
    raise _extends_error(child, "no such case file", hint)


def _escape_hint(path: str) -> str:
    r"""Hint for a path with a line break, a tab and the like: in double quotes, TOML reads "data\new.csv" so."""
    return _PATH_HINT if any(letter < " " for letter in path) else ""


def _extends_error(child: Source, message: str, hint: str = "") -> CaseError:
    line, text = child.location(("extends",))
    return _error(child.name, f"extends: {message}", line, text, hint, "extends")


def _error(
    name: str, message: str, line: int | None = None, text: str = "", hint: str = "", key: str = ""
) -> CaseError:
    return case_error([Problem(name, line, key, message, hint, text, key)])


def read_source(name: str, path: Path) -> Source:
    """Read a TOML file; `name` is its name in messages. Raises CaseError if it cannot be read."""
    try:
        content = read_small(path, MAX_FILE_SIZE, "a case or study")
    except ValueError as too_large:
        raise _error(name, str(too_large)) from None
    except OSError as failure:
        if path.is_dir():  # Windows reports a lack of permission
            raise _error(name, "is a folder; expected a case file", hint=_file_in(path)) from failure
        raise _error(name, f"cannot be read: {failure.strerror}") from failure
    try:
        text = content.decode("utf-16" if content.startswith(UTF_16) else "utf-8-sig")
    except UnicodeDecodeError as failure:
        line = content[: failure.start].count(b"\n") + 1
        excerpt = content.split(b"\n")[line - 1].decode(errors="replace")
        raise _error(name, "not valid UTF-8", line, excerpt) from None
    try:
        return Source(name, path.resolve(), text, parse(text))
    except TomlError as error:
        excerpt = text.split("\n")[error.line - 1].rstrip("\r") if error.line else ""
        raise _error(name, error.reason, error.line, excerpt, _syntax_hint(path, excerpt, error.reason)) from None


def _file_in(folder: Path) -> str:
    """Hint at the case file in a folder; at the first few if there are several."""
    found = [f'"{path}"' for path in sorted(folder.glob("*.toml"))[: _MOST_NAMED + 1]]
    more = " ..." if len(found) > _MOST_NAMED else ""
    return f"did you mean {' or '.join(found[:_MOST_NAMED])}{more}?" if found else ""


def _syntax_hint(path: Path, line: str, reason: str) -> str:
    if path.suffix.lower() in _YAML:
        return _OTHER_FORMAT
    likely = (hint for pattern, hint in _LINE_HINTS.items() if re.match(pattern, line[:_LONGEST_LINE]))
    repeated = "give all keys of a table below one header" if reason.endswith(GIVEN_TWICE) else ""
    return next(likely, _SYNTAX_HINTS.get(reason.removeprefix(SYNTAX_ERROR), repeated))
