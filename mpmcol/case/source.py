"""Case files: finding and reading them, following `extends`, laying overrides over them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from mpmcol.case.fields import nearest, shortened
from mpmcol.case.overrides import Override, apply_overrides
from mpmcol.case.problem import Problem, case_error
from mpmcol.case.toml_lines import NO_TOML, KeyPath, Unfit, locate, parse
from mpmcol.errors import CaseError

LARGEST_FILE = 200_000  # bytes
LIST = "(mpmcol cases lists the shipped cases)"

_SYNTAX_HINTS = {
    "Invalid value": "texts need quotes",
    "Expected newline or end of document after a statement": "texts and numbers with a unit need quotes",
    "Cannot overwrite a value": "this key was already given",
}


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
        return dict(locate(self.text))

    def place(self, key: KeyPath) -> tuple[int | None, str]:
        """Line number and text of the line of a key; if it is not there, of its table."""
        prefixes = (key[:length] for length in range(len(key), 0, -1))
        line = next((self.lines[prefix] for prefix in prefixes if prefix in self.lines), None)
        return line, self._rows[line - 1].rstrip("\r") if line else ""

    @cached_property
    def _rows(self) -> list[str]:
        return self.text.split("\n")


@dataclass(frozen=True)
class Given:
    """Everything that was given for a case: the merged tables, and what each of them came from."""

    tables: dict[str, Any]
    sources: dict[str, Source]
    main: Source
    overrides: Mapping[KeyPath, Override]

    def override_of(self, key: KeyPath) -> Override | None:
        """The override that gave a key, or a part of it."""
        touching = (o for path, o in self.overrides.items() if key[: len(path)] == path[: len(key)])
        return next(touching, None)

    def source_of(self, key: KeyPath) -> Source:
        """The file that gave a key's table."""
        return self.sources.get(key[0], self.main)

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
    return {path.stem: path for path in sorted(folder.glob("*.toml"), key=lambda path: path.stem)}


def read_case(source: str | Path, overrides: Mapping[KeyPath, Override]) -> Given:
    """Read a case file or a shipped case with all that it extends, and lay the overrides over it.

    Raises CaseError if a file cannot be read.
    """
    chain = read_chain(source)
    tables: dict[str, Any] = {}
    sources: dict[str, Source] = {}
    for link in reversed(chain):
        own = {name: value for name, value in link.tables.items() if name != "extends"}
        tables |= own
        sources |= dict.fromkeys(own, link)
    apply_overrides(tables, overrides)
    return Given(tables, sources, chain[0], overrides)


def read_chain(source: str | Path) -> list[Source]:
    """Read a case file, then the file that it extends, and so on; the case itself comes first."""
    chain = [read_source(*_find(source))]
    while "extends" in (last := chain[-1]).tables:
        parent = read_source(*_find_parent(last))
        if parent.path in (link.path for link in chain):
            raise _extends_error(last, "this case extends itself")
        chain.append(parent)
    return chain


def _find(source: str | Path) -> tuple[str, Path]:
    shipped = shipped_cases()
    if isinstance(source, str) and source in shipped:
        return source + ".toml", shipped[source]
    if not str(source).strip():
        raise _error('""', "expected the path of a case file or the name of a shipped case", hint=LIST)
    path, name = Path(source), shortened(str(source), 200)
    if not os.path.exists(path):  # unlike Path.exists it is never upset by an impossible name
        raise _error(name, "no such case file", hint=_suggestion(path, path.parent, shipped))
    return name, path


def _suggestion(path: Path, folder: Path, shipped: dict[str, Path]) -> str:
    """What may have been meant by the path of a file that `folder` does not hold."""
    if os.path.isfile(folder / f"{path.name}.toml"):
        return f'did you mean "{path}.toml"?'
    near = nearest(path.name.removesuffix(".toml"), shipped)
    return f'did you mean the shipped case "{near}"?   {LIST}' if near else LIST


def _find_parent(child: Source) -> tuple[str, Path]:
    parent = child.tables["extends"]
    if not isinstance(parent, str):
        raise _extends_error(child, "expected the name of a case or a path, in quotes")
    beside = child.path.parent / parent
    if os.path.isfile(beside):
        return str(Path(child.name).parent / parent), beside
    shipped = shipped_cases()
    if parent in shipped:
        return parent + ".toml", shipped[parent]
    raise _extends_error(child, "no such case file", _suggestion(Path(parent), beside.parent, shipped))


def _extends_error(child: Source, message: str, hint: str = "") -> CaseError:
    line, text = child.place(("extends",))
    return _error(child.name, f"extends: {message}", line, text, hint, "extends")


def _error(
    name: str, message: str, line: int | None = None, text: str = "", hint: str = "", key: str = ""
) -> CaseError:
    return case_error([Problem(name, line, key, message, hint, text, key)])


def read_source(name: str, path: Path) -> Source:
    """Read one TOML file, which messages call `name`; CaseError if it cannot be read."""
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except OSError as failure:
        raise _error(name, f"cannot be read: {failure.strerror}") from failure
    if len(content) > LARGEST_FILE:
        raise _error(name, f"larger than {LARGEST_FILE // 1000} kB: no case or study is")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as failure:
        line = content[: failure.start].count(b"\n") + 1
        excerpt = content.split(b"\n")[line - 1].decode(errors="replace")
        raise _error(name, "this line is not UTF-8 text", line, excerpt) from None
    try:
        return Source(name, path.resolve(), text, parse(text))
    except Unfit as unfit:
        excerpt = text.split("\n")[unfit.line - 1].rstrip("\r") if unfit.line else ""
        hint = _SYNTAX_HINTS.get(unfit.reason.removeprefix(NO_TOML), "")
        raise _error(name, unfit.reason, unfit.line, excerpt, hint) from None
