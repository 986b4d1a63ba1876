"""Case files: finding and reading them, following `extends`, laying overrides over them."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from mpmcol.case.words import nearest, shortened
from mpmcol.errors import CaseError

KeyPath = tuple[str, ...]

LARGEST_FILE = 1_000_000  # bytes
_SEARCH_BUDGET = 2_000_000  # characters parsed to find line numbers, well under a second
# one of these replaces the other when it is given by an override
_ALTERNATIVES: dict[KeyPath, str] = {("geometry", "height"): "aspect", ("geometry", "aspect"): "height"}


@dataclass(frozen=True)
class Source:
    """One case file as it was read; `name` is what messages call it."""

    name: str
    path: Path
    text: str
    tables: dict[str, Any]

    @cached_property
    def lines(self) -> dict[KeyPath, int]:
        """The line on which each key and table begins."""
        return dict(_locate(self.text))


@dataclass(frozen=True)
class Given:
    """Everything that was given for a case: the merged tables, and what each of them came from."""

    tables: dict[str, Any]
    sources: dict[str, Source]
    main: Source
    overrides: dict[KeyPath, str]

    def place(self, key: KeyPath) -> tuple[Source | None, int | None, str]:
        """Say where a key was given: file, line, text of the line; for an override only its text."""
        for path, argument in self.overrides.items():
            if key[: len(path)] == path or path[: len(key)] == key:
                return None, None, argument
        source = self.sources.get(key[0], self.main)
        prefixes = (key[:length] for length in range(len(key), 0, -1))
        line = next((source.lines[prefix] for prefix in prefixes if prefix in source.lines), None)
        return source, line, source.text.split("\n")[line - 1].rstrip("\r") if line else ""

    def has(self, key: KeyPath) -> bool:
        """Tell whether a key was given at all."""
        table: Any = self.tables
        for name in key:
            if not isinstance(table, dict) or name not in table:
                return False
            table = table[name]
        return True


def shipped_cases() -> dict[str, Path]:
    """Give the cases that come with mpmcol, by name: from the installed package or from the checkout."""
    package = Path(__file__).parents[1]
    places = (package / "cases", package.parent / "cases")
    folder = next((place for place in places if place.is_dir()), package)
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def read_case(source: str | Path, overrides: Mapping[KeyPath, tuple[str, Any]]) -> Given:
    """Read a case file or a shipped case with all that it extends, and lay the overrides over it.

    overrides: from key to the argument as it was written and its value. CaseError if a file cannot be read.
    """
    chain = read_chain(source)
    tables: dict[str, Any] = {}
    sources: dict[str, Source] = {}
    for link in reversed(chain):
        own = {name: value for name, value in link.tables.items() if name != "extends"}
        tables |= own
        sources |= dict.fromkeys(own, link)
    tables = _copied(tables)
    for key, (_, value) in overrides.items():
        _override(tables, key, value, overrides)
    return Given(tables, sources, chain[0], {key: argument for key, (argument, _) in overrides.items()})


def read_chain(source: str | Path) -> list[Source]:
    """Read a case file, then the file that it extends, and so on; the case itself comes first."""
    chain = [_read(*_find(source))]
    while "extends" in (last := chain[-1]).tables:
        parent = _read(*_find_parent(last))
        if parent.path in (link.path for link in chain):
            raise CaseError(f"{_extends_place(last)}: this case extends itself; nothing was run.")
        chain.append(parent)
    return chain


def parse_override(argument: str) -> tuple[KeyPath, Any]:
    """Split "geometry.aspect=3" into key and value; a bare word is a text. ValueError says what is wrong."""
    name, equals, text = argument.partition("=")
    key = tuple(part.strip() for part in name.split("."))
    if key == ("extends",):
        raise ValueError("only a case file can extend another; name that one instead of this case")
    if not equals or not all(key):
        raise ValueError('expected key=value, for example "geometry.aspect=3"')
    text = text.strip()
    if not text:
        raise ValueError("expected a value after =")
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        if text[0] in "\"'[{" or "\n" in text:
            raise ValueError("this value is not valid TOML") from None
        return key, text
    if len(parsed) > 1:
        raise ValueError("expected one value")
    return key, parsed["value"]


def _override(tables: dict[str, Any], key: KeyPath, value: Any, overrides: Mapping[KeyPath, Any]) -> None:
    *path, name = key
    table = tables
    for part in path:
        if not isinstance(table.get(part), dict):
            table[part] = {}
        table = table[part]
    table[name] = value
    other = _ALTERNATIVES.get(key)
    if other and (*path, other) not in overrides:
        table.pop(other, None)


def _copied(value: Any) -> Any:
    return {name: _copied(item) for name, item in value.items()} if isinstance(value, dict) else value


def _find(source: str | Path) -> tuple[str, Path]:
    shipped = shipped_cases()
    if isinstance(source, str) and source in shipped:
        return source + ".toml", shipped[source]
    path, name = Path(source), shortened(str(source), 200)
    try:
        path.stat()
    except (OSError, ValueError):  # ValueError: a null character
        suggestion = _suggestion(path, shipped)
        raise CaseError(f"{name}: no such case file.{suggestion}\nNothing was run.") from None
    return name, path


def _suggestion(path: Path, shipped: dict[str, Path]) -> str:
    name = path.name.removesuffix(".toml")
    near = name if name in shipped else nearest(name, shipped)
    meant = f' Did you mean the shipped case "{near}"?' if near else ""
    return f"{meant}   (mpmcol cases lists the shipped cases)"


def _find_parent(child: Source) -> tuple[str, Path]:
    parent = child.tables["extends"]
    if not isinstance(parent, str):
        raise CaseError(f"{_extends_place(child)}: expected the name of a case or a path, in quotes.")
    beside = child.path.parent / parent
    try:
        return (str(beside), beside) if beside.is_file() else _find(parent)
    except CaseError as missing:
        raise CaseError(f"{_extends_place(child)}: {missing}") from None


def _extends_place(source: Source) -> str:
    return f"{source.name}:{source.lines.get(('extends',), 1)}: extends"


def _read(name: str, path: Path) -> Source:
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except OSError as failure:
        raise CaseError(f"{name}: cannot be read: {failure.strerror}. Nothing was run.") from failure
    if len(content) > LARGEST_FILE:
        raise CaseError(f"{name}: larger than 1 MB, so this is no case file. Nothing was run.")
    try:
        text = content.decode("utf-8-sig")
        return Source(name, path.resolve(), text, tomllib.loads(text))
    except UnicodeDecodeError as failure:
        line = content[: failure.start].count(b"\n") + 1
        raise CaseError(f"{name}:{line}: this line is not UTF-8 text. Nothing was run.") from None
    except RecursionError:
        raise CaseError(f"{name}: arrays or tables are nested too deeply. Nothing was run.") from None
    except ValueError as failure:  # TOMLDecodeError, and plain ValueError for integers of thousands of digits
        raise CaseError(_syntax_message(name, text, str(failure))) from None


def _syntax_message(name: str, text: str, failure: str) -> str:
    lines = text.split("\n")
    match = re.search(r"line (\d+), column (\d+)", failure)
    number = int(match[1]) if match else len(lines) if "end of document" in failure else 0
    what = re.sub(r" \(at .*\)$", "", failure) if match or number else "a number with too many digits"
    hint = " (texts need quotes)" if what == "Invalid value" else ""
    if not number:
        return f"{name}: not valid TOML: {what}.\nNothing was run."
    excerpt = f"{number:5} | {shortened(lines[number - 1], 100)}"
    return f"{name}:{number}: not valid TOML: {what}{hint}\n{excerpt}\nNothing was run."


def _locate(text: str) -> Iterator[tuple[KeyPath, int]]:
    """Find the line of each key by parsing statement after statement, each behind its table's header.

    No TOML parser in the standard library tells positions. A statement ends where it first parses.
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
