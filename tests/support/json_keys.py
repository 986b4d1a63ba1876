"""Keys of JSON output that no glossary explains."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from mpmcol.case import key_names
from mpmcol.io.columns import unit_of
from mpmcol.io.json_glossary import ALL_NAMES, CONTENTS, OUTPUTS


def unexplained_keys(words: Sequence[str], record: Any) -> set[str]:
    """Keys in the record that a command with these words printed which have no entry in the glossary."""
    command = output_name(words)
    contents = CONTENTS.get(command, {})
    return {name for name in names_in(record) if not _is_explained(command, contents, name)}


def output_name(words: Sequence[str]) -> str:
    """The name of the JSON output of a command in the glossary."""
    kinds = [kind for kind in ("--dry-run", "--map", "--scaling", "--uncertain") if kind in words]
    if "--dry-run" in kinds:  # the forecast of a sweep is that of any sweep
        kinds = ["--dry-run"]
    return " ".join([words[0], *kinds, "--json"])


def names_in(value: Any, prefix: str = "") -> Iterator[str]:
    """Names of all values in nested tables and in arrays of tables, and of the tables themselves."""
    if isinstance(value, dict):
        for name, entry in value.items():
            yield prefix + name
            yield from names_in(entry, f"{prefix}{name}.")
    elif isinstance(value, list):
        for entry in value:
            yield from names_in(entry, prefix)


def unexplained(where: str, names: Iterator[str]) -> set[str]:
    """Names that are not in this table of the glossary; a table whose keys are in it need not be."""
    return {name for name in names if not _is_in(where, name)}


def _is_in(where: str, name: str) -> bool:
    tables = {".".join(full.split(".")[:-1]) for full in ALL_NAMES[where]}
    return unit_of(where, name) is not None or name in tables


def _is_explained(command: str, contents: dict[str, str], name: str) -> bool:
    if command in OUTPUTS and _is_in(command, name):
        return True
    if name.partition(".")[2] in key_names():  # a key of a case in the rows of a table
        return True
    prefixes = {f"{key}." if key else "": where for key, where in contents.items()}
    return any(
        _is_in(where, name.removeprefix(prefix)) for prefix, where in prefixes.items() if name.startswith(prefix)
    )
