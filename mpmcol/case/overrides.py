"""Values that replace others: of a case that extends another one, and overrides as given by `--set key=value`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import tomli_w

from mpmcol.case.fields import shortened
from mpmcol.case.problem import Problem, case_error, set_option
from mpmcol.case.toml_lines import KeyPath, TomlError, parse
from mpmcol.errors import CaseError

Overrides = Sequence[str] | str | Mapping[str, Any]  # see `assignments`
# a key of `geometry` that is given -> keys that are removed, since it replaces them
_ALTERNATIVES: dict[KeyPath, tuple[str, ...]] = {
    ("geometry", "height"): ("aspect",),
    ("geometry", "aspect"): ("height",),
    ("geometry", "radius"): ("outline",),
    ("geometry", "outline"): ("radius", "height", "aspect"),
}


@dataclass(frozen=True)
class Override:
    """A key, its new value, and the argument as given."""

    key: KeyPath
    value: Any
    argument: str


def assignments(overrides: Overrides) -> list[str]:
    """Overrides as "key=value": a sequence of such assignments, a single one, or a mapping from keys to values.

    Raises TypeError for a value that TOML does not have.
    """
    if isinstance(overrides, str):
        return [overrides]
    if isinstance(overrides, Mapping):
        return [text for key, value in overrides.items() for text in _assignments(key, value)]
    return list(overrides)


def _assignments(key: str, value: Any) -> Iterator[str]:
    """Assignments of a value of Python or NumPy; of a mapping, those of its keys."""
    plain = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(plain, Mapping):
        for name, inner in plain.items():
            yield from _assignments(f"{key}.{name}", inner)
        return
    try:
        yield f"{key}={tomli_w.dumps({'value': plain}).removeprefix('value = ').strip()}"
    except TypeError:
        raise TypeError(f"{key}: expected a number, a text, true or false, or a list of them, not {value!r}") from None


def parse_override(argument: str) -> Override:
    """Parse "geometry.aspect=3"; the value is TOML or a bare string. Raises ValueError with the reason."""
    name, equals, text = argument.partition("=")
    key, text = tuple(part.strip() for part in name.split(".")), text.strip()
    for is_missing, part in (
        (not equals, "there is no equals sign"),
        (key == ("",), "the key is missing"),
        (not all(key), "a part of the key is empty"),
        (not text, "the value is missing"),
    ):
        if is_missing:
            raise ValueError(f'{part}: expected key=value, for example "geometry.aspect=3"')
    if any("\ud800" <= character <= "\udfff" for character in argument):
        raise ValueError("not valid UTF-8")
    if key == ("extends",):
        raise ValueError("extends can only be set in a case file; run the other case instead")
    return Override(key, _parsed(text), argument)


def _parsed(text: str) -> Any:
    try:
        parsed = parse(f"value = {text}")
    except TomlError:
        parsed = {} if text[0] in "\"'[{" or "\n" in text else {"value": text}
    if len(parsed) != 1:
        raise ValueError("the value is not valid TOML")
    return parsed["value"]


def split_setting(argument: str) -> tuple[str, str]:
    """Key and value, both as text, of "grid.spacing = 0.005"."""
    name, _, text = argument.partition("=")
    return ".".join(part.strip() for part in name.split(".")), text.strip()


def refuse_repeated(arguments: Sequence[str]) -> None:
    """Raise CaseError if a key has two different values among the arguments that a user gave.

    `load_case` itself takes the last value: studies append theirs to those of the user.
    """
    given: dict[str, tuple[str, str]] = {}  # key -> its first value and that argument
    problems = []
    for argument in arguments:
        key, value = split_setting(argument)
        first, earlier = given.setdefault(key, (value, argument))
        if value != first:
            message = f"{shortened(key)} is given twice; the other one is {set_option(earlier)}"
            problems.append(Problem(set_option(argument), None, shortened(key), message, "remove one of the two"))
    if problems:
        raise case_error(problems)


def apply_overrides(tables: dict[str, Any], overrides: Mapping[KeyPath, Override]) -> None:
    """Set the new values in `tables`, in place. Raises CaseError for an item that an array of tables does not have."""
    for key, override in overrides.items():
        *path, name = key
        table: Any = tables
        for part in path:
            table = _inside(table, part, override)
        if isinstance(table, list):
            table = _inside(table, name, override)
        table[name] = override.value
        for other in _ALTERNATIVES.get(key, ()):
            if (*path, other) not in overrides:
                table.pop(other, None)


def _inside(table: Any, part: str, override: Override) -> Any:
    """The table or array of tables at a part of the key; a new table where there is neither."""
    if not isinstance(table, list):
        if not isinstance(table.get(part), (dict, list)):
            if override.key[0] == part and override.key[1].isdecimal():
                raise _refused(
                    override, f"the case has no {part} whose keys could be set", f"write [[{part}]] in its file"
                )
            table[part] = {}
        return table[part]
    if part.isdecimal() and int(part) < len(table) and isinstance(table[int(part)], dict) and part != override.key[-1]:
        return table[int(part)]
    items = f"items 0 to {len(table) - 1}" if table else "no items"
    raise _refused(override, f'"{part}" is no item of {override.key[0]} whose key can be set; it has {items}', "")


def _refused(override: Override, message: str, hint: str) -> CaseError:
    return case_error([Problem(set_option(override.argument), None, ".".join(override.key), message, hint)])


def merge_cases(parent: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    """Tables of a case that extends `parent`: its own keys replace those of the parent.

    A material with another law replaces the whole table, since the keys depend on the law. As in an override, the
    height removes the aspect ratio, and vice versa, and so do an outline and the radius.
    """
    merged = _merge(parent, own)
    for name in ("material", "base_material"):
        old, new = parent.get(name), own.get(name)
        if isinstance(old, dict) and isinstance(new, dict) and new.get("law", old.get("law")) != old.get("law"):
            merged[name] = new
    for (table, key), others in _ALTERNATIVES.items():
        given = own.get(table)
        if isinstance(given, dict) and key in given and isinstance(merged[table], dict):
            for other in set(others) - given.keys():
                merged[table].pop(other, None)
    return merged


def _merge(old: dict[str, Any], new: dict[str, Any]) -> dict[str, Any]:
    merged = dict(old)
    for name, value in new.items():
        both = isinstance(value, dict) and isinstance(old.get(name), dict)
        merged[name] = _merge(old[name], value) if both else value
    return merged
