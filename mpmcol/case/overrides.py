"""Overrides of a case's keys, as given by `--set key=value`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from mpmcol.case.toml_lines import KeyPath, Unfit, parse

# one of these replaces the other when it is given by an override
_ALTERNATIVES: dict[KeyPath, str] = {("geometry", "height"): "aspect", ("geometry", "aspect"): "height"}


@dataclass(frozen=True)
class Override:
    """A key, its new value, and the argument as it was written."""

    key: KeyPath
    value: Any
    argument: str


def parse_override(argument: str) -> Override:
    """Split "geometry.aspect=3" into key and value (TOML, or a bare word); ValueError says what is wrong."""
    name, equals, text = argument.partition("=")
    key, text = tuple(part.strip() for part in name.split(".")), text.strip()
    if not (equals and all(key) and text):
        raise ValueError('expected key=value, for example "geometry.aspect=3"')
    if any("\ud800" <= character <= "\udfff" for character in argument):
        raise ValueError("this is not UTF-8 text")
    if key == ("extends",):
        raise ValueError("only a case file can extend another; name that one instead of this case")
    return Override(key, _parsed(text), argument)


def _parsed(text: str) -> Any:
    try:
        parsed = parse(f"value = {text}")
    except Unfit:
        parsed = {} if text[0] in "\"'[{" or "\n" in text else {"value": text}
    if len(parsed) != 1:
        raise ValueError("this value is not valid TOML")
    return parsed["value"]


def apply_overrides(tables: dict[str, Any], overrides: Mapping[KeyPath, Override]) -> None:
    """Put the new values into the tables, which are changed."""
    for key, override in overrides.items():
        *path, name = key
        table = tables
        for part in path:
            if not isinstance(table.get(part), dict):
                table[part] = {}
            table = table[part]
        table[name] = override.value
        other = _ALTERNATIVES.get(key)
        if other and (*path, other) not in overrides:
            table.pop(other, None)
