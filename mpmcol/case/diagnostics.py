"""Turning what pydantic and the rules object to into problems with file, line, key and nearest key."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from mpmcol.case import fields
from mpmcol.case.constraints import BrokenRule, broken_rules
from mpmcol.case.problem import MOST_COUNTED, Problem, set_option
from mpmcol.case.reference import field_at, fields_at, key_names
from mpmcol.case.source import Given
from mpmcol.case.toml_lines import KeyPath
from mpmcol.mpm.constitutive import LAWS

# errors that only follow from others, or that the rules report with their places
_ECHOES = ("rules", "default_factory_not_called")


def find_problems(given: Given, invalid: ValidationError) -> list[Problem]:
    """Give the problems of a case that did not validate, MOST_COUNTED at most, and those between keys.

    They come in the order of the file; overrides come last.
    """
    told = (error for error in invalid.errors(include_url=False) if error["type"] not in _ECHOES)
    located = [(_key_path(error), error) for error in told]
    errors = located[:MOST_COUNTED]
    law = _law(given.tables)
    meant = {key: _meant(key, law) for key, error in errors if error["type"] == "extra_forbidden"}
    wrong = {key for key, _ in located} | {known for known in meant.values() if known}
    problems = [
        _unknown_key(given, key, meant[key], law) if key in meant else _bad_value(given, key, error, law)
        for key, error in errors
        if not (error["type"] == "missing" and key in meant.values())
    ]
    values = dict(_sound_values(given.tables, wrong, law))
    problems += [_broken_rule(given, broken) for broken in broken_rules(values)]
    return sorted(problems, key=lambda problem: (problem.line is None, problem.file, problem.line or 0))


def _law(tables: dict[str, Any]) -> str:
    material = tables.get("material")
    law = material.get("law") if isinstance(material, dict) else None
    return law if isinstance(law, str) else ""


def _key_path(error: ErrorDetails) -> KeyPath:
    """The key of an error; pydantic adds the law to the keys of `material`."""
    location = tuple(str(part) for part in error["loc"] if not isinstance(part, int))
    if error["type"].startswith("union_tag"):
        return (*location, "law")
    return ("material", *location[2:]) if location[0] == "material" else location


def _meant(key: KeyPath, law: str) -> KeyPath | None:
    *table, name = key
    near = fields.nearest(name, fields_at(tuple(table), law))
    return (*table, near) if near else None


def _problem(given: Given, key: KeyPath, message: str, hint: str, about: KeyPath) -> Problem:
    override, source = given.override_of(key), given.source_of(key)
    line, text = source.place(key)
    if override:
        return Problem(set_option(override.argument), None, ".".join(key), message, hint, "", ".".join(about))
    return Problem(source.name, line, ".".join(key), message, hint, text, ".".join(about))


def _titled(key: KeyPath, field: FieldInfo | None = None) -> str:
    *table, name = key
    if field and fields.expected(field) == "a table":
        return f"[{'.'.join(key)}]"
    return f"[{'.'.join(table)}] {name}" if table else name


def _unknown_key(given: Given, key: KeyPath, meant: KeyPath | None, law: str) -> Problem:
    *table, name = key
    quoted = f"unknown key {fields.shown(name)}"
    message = f"[{'.'.join(table)}] {quoted}" if table else quoted
    if meant:
        field = field_at(meant, law)
        hint = f'did you mean "{meant[-1]}"?   ({field.description}: {fields.expected(field)})'
    else:
        hint = _elsewhere(key, law) or "known here: " + ", ".join(fields_at(tuple(table), law))
    return _problem(given, key, message, hint, meant or tuple(table))


def _elsewhere(key: KeyPath, law: str) -> str:
    """Say to which law or table a key belongs that is unknown where it stands."""
    *table, name = key
    laws = [other for other in LAWS if name in fields_at(("material",), other)]
    if table == ["material"] and laws:
        return f"law {law} has no such key; it belongs to {' and '.join(laws)}"
    tables = [path.rpartition(".")[0] for path in key_names() if path.rpartition(".")[2] == name]
    return f"this key belongs into [{tables[0]}]" if tables and tables[0] else ""


def _bad_value(given: Given, key: KeyPath, error: ErrorDetails, law: str) -> Problem:
    field = field_at(key, law)
    expected = fields.expected(field)
    if error["type"] in ("missing", "union_tag_not_found"):
        message = f"{_titled(key, field)} is missing: expected {expected}"
        return _problem(given, key, message, str(field.description), key)
    value, last = _value_at(given.tables, key), error["loc"][-1]
    item = f", item {last + 1}: {fields.shown(error['input'])}" if isinstance(last, int) else ""
    reason = error["msg"] if error["type"] in ("quantity", "value_error") else f"expected {expected}"
    near = fields.nearest(value, map(str, fields.allowed(field))) if isinstance(value, str) else None
    message = f"{_titled(key)} = {fields.shown(value)}{item}: {reason}"
    return _problem(given, key, message, f'did you mean "{near}"?' if near else "", key)


def _value_at(tables: Any, key: KeyPath) -> Any:
    for name in key:
        tables = tables[name]
    return tables


def _sound_values(tables: dict[str, Any], wrong: set[KeyPath], law: str, at: KeyPath = ()) -> Iterator[tuple[str, Any]]:
    """Give the converted values of all keys that are right by themselves, for the rules between keys."""
    for name, field in fields_at(at, law).items():
        key = (*at, name)
        if key in wrong or (name not in tables and field.is_required()):
            continue
        if key == ("material",) or fields.subtable(field):
            yield from _sound_values(tables.get(name, {}), wrong, law, key)
        else:
            value, number = tables.get(name, field.default), fields.number_of(field)
            yield ".".join(key), number(value) if number else value


def _broken_rule(given: Given, broken: BrokenRule) -> Problem:
    keys: list[KeyPath] = [tuple(key.split(".")) for key in broken.rule.keys]
    value = broken.values[0]
    stated = f" {broken.sentence}" if value is None else f" = {fields.shown(value)}: {broken.sentence}"
    at = next((key for key in keys if given.has(key)), keys[0])
    present = [key for key, value in zip(keys, broken.values, strict=True) if value is not None]
    others = [_whereabouts(given, key) for key in present if key != at]
    return _problem(given, at, _titled(keys[0]) + stated, "; ".join(others), keys[0])


def _whereabouts(given: Given, key: KeyPath) -> str:
    name, override, source = ".".join(key), given.override_of(key), given.source_of(key)
    if not given.has(key):
        return f"{name}: by default"
    return f"{name}: {set_option(override.argument) if override else f'{source.name}:{source.place(key)[0]}'}"
