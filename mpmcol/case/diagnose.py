"""Turning what pydantic and the rules object to into messages with file, line, key and nearest key."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from mpmcol.case import words
from mpmcol.case.reference import field_at, fields_at, key_names
from mpmcol.case.rules import BrokenRule, broken_rules
from mpmcol.case.source import Given, KeyPath
from mpmcol.laws import LAWS

# errors that only follow from others, or that the rules report with their places
_ECHOES = ("rules", "default_factory_not_called")


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with a case: where (file and line, or override), what, how to mend it."""

    file: str
    line: int | None
    key: str
    message: str
    hint: str
    text: str = ""
    about: str = ""

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}" if self.line else self.file
        return "\n".join([f"{place}: {self.message}", *self._excerpt()])

    def _excerpt(self) -> Iterator[str]:
        if self.line:
            yield f"{self.line:5} | {words.shortened(self.text, 100)}"
        if self.line and self.hint:
            name = self.key.rpartition(".")[2]
            start = max(self.text.find(name), 0)
            marks = "^" * len(name) if name in self.text else "^"
            yield f"      | {' ' * start}{marks} {self.hint}"
        elif self.hint:
            yield f"      {self.hint}"


def report(problems: list[Problem]) -> str:
    """Write all problems, one below the other, and how to learn more."""
    count = "1 problem" if len(problems) == 1 else f"{len(problems)} problems"
    about = next((problem.about for problem in problems if problem.about), "")
    more = f"   (mpmcol explain {about})" if about else ""
    return "\n".join([*map(str, problems), f"{count}; nothing was run.{more}"])


def find_problems(given: Given, invalid: ValidationError) -> list[Problem]:
    """Give all problems of a case that did not validate, in the order of the file."""
    errors = [(_key_path(error), error) for error in invalid.errors() if error["type"] not in _ECHOES]
    law = _law(given.tables)
    meant = {key: _meant(key, law) for key, error in errors if error["type"] == "extra_forbidden"}
    wrong = {key for key, _ in errors} | {known for known in meant.values() if known}
    problems = [
        _unknown_key(given, key, meant[key], law) if key in meant else _bad_value(given, key, error, law)
        for key, error in errors
        if not (error["type"] == "missing" and key in meant.values())
    ]
    values = dict(_sound_values(given.tables, wrong, law))
    problems += [_broken_rule(given, broken) for broken in broken_rules(values)]
    return sorted(problems, key=lambda problem: (problem.line is None, problem.file, problem.line or 0))


def bad_override(argument: str, reason: str) -> Problem:
    """The problem of an override that cannot be split into a key and a value."""
    return Problem(_set_option(argument), None, "", reason, "")


def _set_option(argument: str) -> str:
    return f"--set {words.shortened(argument)}"


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
    near = words.nearest(name, fields_at(tuple(table), law))
    return (*table, near) if near else None


def _problem(given: Given, key: KeyPath, message: str, hint: str, about: KeyPath) -> Problem:
    source, line, text = given.place(key)
    file = source.name if source else _set_option(text)
    return Problem(file, line, ".".join(key), message, hint, text, ".".join(about))


def _titled(key: KeyPath) -> str:
    *table, name = key
    return f"[{'.'.join(table)}] {name}" if table else name


def _unknown_key(given: Given, key: KeyPath, meant: KeyPath | None, law: str) -> Problem:
    *table, name = key
    quoted = f"unknown key {words.shown(name)}"
    message = f"[{'.'.join(table)}] {quoted}" if table else quoted
    if meant:
        field = field_at(meant, law)
        hint = f'did you mean "{meant[-1]}"?   ({field.description}: {words.expected(field)})'
    else:
        hint = _elsewhere(key, law) or "known here: " + ", ".join(fields_at(tuple(table), law))
    return _problem(given, key, message, hint, meant or tuple(table))


def _elsewhere(key: KeyPath, law: str) -> str:
    """Say to which law or table a key belongs that is unknown where it stands."""
    *table, name = key
    laws = [other for other in LAWS if name in fields_at(("material",), other)]
    if table == ["material"] and laws:
        return f"law {law} has no such key, {' and '.join(laws)} has"
    tables = [path.rpartition(".")[0] for path in key_names() if path.rpartition(".")[2] == name]
    return f"this key belongs into [{tables[0]}]" if tables and tables[0] else ""


def _bad_value(given: Given, key: KeyPath, error: ErrorDetails, law: str) -> Problem:
    field = field_at(key, law)
    expected = words.expected(field)
    if error["type"] in ("missing", "union_tag_not_found"):
        return _problem(
            given, key, f"{_titled(key)} is missing: expected {expected}", str(field.description), key
        )
    value = _value_at(given.tables, key)
    own = error["type"] in ("quantity", "value_error")
    last = error["loc"][-1]
    item = f", item {last + 1}: {words.shown(error['input'])}" if isinstance(last, int) else ""
    message = (
        f"{_titled(key)} = {words.shown(value)}{item}: {error['msg'] if own else f'expected {expected}'}"
    )
    near = words.nearest(value, map(str, words.allowed(field))) if isinstance(value, str) else None
    return _problem(given, key, message, f'did you mean "{near}"?' if near else "", key)


def _value_at(tables: Any, key: KeyPath) -> Any:
    for name in key:
        tables = tables[name]
    return tables


def _sound_values(
    tables: dict[str, Any], wrong: set[KeyPath], law: str, at: KeyPath = ()
) -> Iterator[tuple[str, Any]]:
    """Give the converted values of all keys that are right by themselves, for the rules between keys."""
    for name, field in fields_at(at, law).items():
        key = (*at, name)
        if key in wrong or (name not in tables and field.is_required()):
            continue
        value = tables.get(name, field.default)
        if (key == ("material",) and law in LAWS) or words.subtable(field):
            yield from _sound_values(value if name in tables else {}, wrong, law, key)
        else:
            number = words.number_of(field)
            yield ".".join(key), number(value) if number else value


def _broken_rule(given: Given, broken: BrokenRule) -> Problem:
    keys = [tuple(key.split(".")) for key in broken.rule.keys]
    value = broken.values[0]
    stated = f" {broken.sentence}" if value is None else f" = {words.shown(value)}: {broken.sentence}"
    others = [_whereabouts(given, key) for key in keys[1:]]
    at = next((key for key in keys if given.has(key)), keys[0])
    return _problem(given, at, _titled(keys[0]) + stated, "; ".join(others), keys[0])


def _whereabouts(given: Given, key: KeyPath) -> str:
    name = ".".join(key)
    if not given.has(key):
        return f"{name}: not given"
    source, line, text = given.place(key)
    return f"{name}: {source.name}:{line}" if source else f"{name}: {_set_option(text)}"
