"""Problems of an invalid case, from the errors of pydantic and the constraints, with file, line and key."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import lru_cache, partial
from typing import Any

from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails, PydanticCustomError

from mpmcol.case import fields
from mpmcol.case.constraints import ViolatedConstraint, violations
from mpmcol.case.materials import default_base_law, with_inherited_keys
from mpmcol.case.not_modelled import answer_to
from mpmcol.case.problem import MOST_COUNTED, Problem, set_option
from mpmcol.case.reference import MATERIALS, field_at, fields_at, heading, key_names, without_indices
from mpmcol.case.source import CaseInput
from mpmcol.case.toml_lines import KeyPath, value_at
from mpmcol.mpm.constitutive import LAWS

_WITH_LAW = {table[-1] for table in MATERIALS}
LEAST_LENGTH, MOST_RATIO = 1.0, 10.0  # from which a length is likely to be in mm: m, and over one it is compared with
# errors that follow from others, or that are reported as violations with their locations
_DERIVED_ERRORS = ("constraints", "derived")


def find_problems(given: CaseInput, tables: dict[str, Any], found: Sequence[ErrorDetails]) -> list[Problem]:
    """Problems of a case that did not validate: at most MOST_COUNTED of single keys, and violated constraints.

    Sorted by file and line; those of overrides come last. tables: those of `given`, with laws that exist.
    """
    primary = (error for error in found if error["type"] not in _DERIVED_ERRORS)
    located = _without_derived(given, [(_key_path(error), error) for error in primary])
    errors = located[:MOST_COUNTED]
    law = partial(_law, tables)
    intended = {key: _nearest_key(key, law(key)) for key, error in errors if error["type"] == "extra_forbidden"}
    invalid_keys = {key for key, _ in located} | {known for known in intended.values() if known}
    problems = [
        _unknown_key(given, key, intended[key], law(key))
        if key in intended
        else _bad_value(given, key, error, law(key))
        for key, error in errors
        if not (error["type"] == "missing" and key in intended.values())
    ]
    values = dict(_valid_values(_complete(tables, invalid_keys), invalid_keys, law))
    problems += [_violated(given, violation) for violation in violations(values)]
    return sorted(problems, key=lambda problem: (problem.line is None, problem.file, problem.line or 0))


def _without_derived(
    given: CaseInput, located: list[tuple[KeyPath, ErrorDetails]]
) -> list[tuple[KeyPath, ErrorDetails]]:
    """Without keys of base and layers that are missing because what they follow from is invalid.

    A layer without a material of its own has that of the column, whose constraints are reported there.
    """
    located = [(key, error) for key, error in located if not _is_that_of_column(key) or given.has(key)]
    if not any(key[0] in ("geometry", "material") for key, _ in located):
        return located
    return [(key, error) for key, error in located if not _is_inherited(key) or error["type"] != "missing"]


def _is_that_of_column(key: KeyPath) -> bool:
    """Whether a key is the material of a layer as a whole."""
    return key[:1] == ("layers",) and key[2:] == ("material",)


def _is_inherited(key: KeyPath) -> bool:
    """Whether a key that is not given is that of the column's material: of the base, or of the material of a layer."""
    return key[0] == "base_material" or (key[0] == "layers" and "material" in key[2:-1])


def _complete(tables: dict[str, Any], invalid_keys: set[KeyPath]) -> dict[str, Any]:
    """The tables with the keys of the base that follow from valid keys of the material of the column."""
    material, base_material = tables.get("material"), tables.get("base_material", {})
    if not (isinstance(material, dict) and isinstance(base_material, dict)):
        return tables
    valid = {name: value for name, value in material.items() if ("material", name) not in invalid_keys}
    return tables | {"base_material": with_inherited_keys(base_material, valid, _value(tables, "geometry", "base"))}


def _law(tables: dict[str, Any], key: KeyPath = ()) -> str:
    """Law of the material that a key belongs to, by default that of the column; "" if there is none."""
    table = key[0] if key[:1] in MATERIALS else "material"
    law = _value(tables, table, "law")
    if law is None and table == "base_material":
        law = default_base_law(_value(tables, "geometry", "base"), _law(tables))
    return law if isinstance(law, str) else ""


def _value(tables: dict[str, Any], table: str, key: str) -> Any:
    keys = tables.get(table)
    return keys.get(key) if isinstance(keys, dict) else None


def _key_path(error: ErrorDetails) -> KeyPath:
    """Key of an error, without the law that pydantic inserts into the keys of materials."""
    parts = error["loc"]
    while isinstance(parts[-1], int):  # an item of an array of values
        parts = parts[:-1]
    inside = error["ctx"].get("inside", ()) if "ctx" in error else ()  # of an array of tables checked as a whole
    return _without_law(parts, ("law",) if error["type"].startswith("union_tag") else inside)


@lru_cache(maxsize=256)  # an array can have thousands of invalid items
def _without_law(parts: tuple[int | str, ...], inside: KeyPath) -> KeyPath:
    before = (None, *parts)
    location = (str(part) for last, part in zip(before, parts, strict=False) if last not in _WITH_LAW)
    return *location, *inside


def _nearest_key(key: KeyPath, law: str) -> KeyPath | None:
    *table, name = key
    if answer_to(key) or (not table and _tables_with(name)):
        return None
    near = fields.nearest(name, fields_at(tuple(table), law))
    return (*table, near) if near else None


def problem_of(given: CaseInput, key: KeyPath, message: str, hint: str, about: KeyPath) -> Problem:
    """A problem with the file and the line, or the override, that gives a key its value."""
    override, source = given.override_of(key), given.source_of(key)
    line, text = source.location(key)
    name = ".".join(without_indices(about))
    if override:
        return Problem(set_option(override.argument), None, ".".join(key), message, hint, "", name)
    return Problem(source.name, line, ".".join(key), message, hint, text, name)


def _qualified(key: KeyPath, field: FieldInfo | None = None) -> str:
    *table, name = key
    if name.isdecimal():
        return _table_name(key).rstrip(":")
    if field and fields.expected(field) == "a table":
        return f"[{'.'.join(key)}]"
    return f"{_table_name(tuple(table))} {name}" if table else name


def _table_name(table: KeyPath) -> str:
    """A table as in a case file, with the number of the item in an array of tables."""
    array, *rest = table
    if not rest:
        return heading(table)
    number, *inside = rest
    if not number.isdecimal():
        return f"[{'.'.join(table)}]"
    return " ".join([heading((array,)), f"{int(number) + 1}:", *inside])


def _unknown_key(given: CaseInput, key: KeyPath, intended: KeyPath | None, law: str) -> Problem:
    *table, name = key
    quoted = f"unknown key {fields.shown(name)}"
    message = f"{_table_name(tuple(table))} {quoted}" if table else quoted
    if intended:
        field = field_at(intended, law)
        hint = f'did you mean "{intended[-1]}"?   ({field.description}: {fields.expected(field)})'
    else:
        known = "known keys: " + ", ".join(fields_at(tuple(table), law))
        hint = _answer(given, key) or _correct_place(given, key, law) or known
    return problem_of(given, key, message, hint, intended or tuple(table))


def _answer(given: CaseInput, key: KeyPath) -> str | None:
    """The answer to a key for what is not modelled; to an unknown table, by its keys as well."""
    value = value_at(given.tables, key)
    keys = [key, *((*key, str(name)) for name in value)] if isinstance(value, dict) else [key]
    return next(filter(None, map(answer_to, keys)), None)


def _correct_place(given: CaseInput, key: KeyPath, law: str) -> str:
    """The law or the table to which a misplaced key belongs; empty if there is none."""
    *table, name = key
    laws = [other for other in LAWS if name in fields_at(("material",), other)]
    if tuple(table) in MATERIALS and laws:
        return f"not a key of law {law}, but of {' and '.join(laws)}"
    if table and name in fields_at((*table, "material"), law):
        return f"a key of its material: material = {{ {name} = ... }}"
    tables = _tables_with(name)
    if tables and given.override_of(key):
        return f'did you mean "{tables[0]}.{name}"?'
    return f"move this key to {heading(tuple(tables[0].split('.')))}" if tables else ""


def _tables_with(name: str) -> list[str]:
    """The tables that have a key of this name."""
    paths = (path.rpartition(".") for path in key_names())
    return [table for table, _, last in paths if table and last == name]


def _bad_value(given: CaseInput, key: KeyPath, error: ErrorDetails, law: str) -> Problem:
    field = field_at(key, law)
    expected = fields.expected(field)
    if error["type"] in ("missing", "union_tag_not_found"):
        message = f"{_qualified(key, field)} is missing: expected {expected}"
        return problem_of(given, key, message, f"{field.description}{_replaced_array(given, key)}", key)
    value, last = value_at(given.tables, key), error["loc"][-1]
    item = f", item {last + 1}: {fields.shown(error['input'])}" if isinstance(last, int) else ""
    reason = error["msg"] if error["type"] in ("quantity", "value_error") else f"expected {expected}"
    is_float = isinstance(value, float) and not fields.number_of(field)  # where 4.0 is wrong and 4 is right
    stated = "" if key[-1].isdecimal() else f" = {value if is_float else fields.shown(value)}"
    message = f"{_qualified(key)}{stated}{item}: {reason}"
    return problem_of(given, key, message, _value_hint(key, field, value), key)


def _replaced_array(given: CaseInput, key: KeyPath) -> str:
    """That an array of tables replaces the one of the extended case, if it does, and how to change an item of that."""
    array, *inside = key
    replaced = [link.name for link in given.chain if array in link.tables][1:]
    if not (inside and fields.item_table(field_at((array,), "")) and replaced):
        return ""
    item = value_at(given.tables, key[:2])
    name, value = next(iter(item.items()), (key[-1], "..."))
    change = f"--set {array}.{inside[0]}.{name}={value if value == '...' else fields.shown(value)}"
    return (
        f"; [[{array}]] replaces all of {replaced[0]}: give every key, or change one of them by {change} without "
        f"[[{array}]]"
    )


def _value_hint(key: KeyPath, field: FieldInfo, value: Any) -> str:
    """What an invalid value is likely to mean; "" if that is unknown."""
    if fields.item_table(field) and isinstance(value, dict):
        return f"write [[{key[-1]}]], in double brackets, once for each of them"
    if not isinstance(value, str):
        return ""
    if fields.is_quoted(value, field):
        return f"write {value} without quotes"
    near = fields.nearest(value, map(str, fields.allowed(field)))
    return f'did you mean "{near}"?' if near and near != value else ""


def _valid_values(
    tables: dict[str, Any], invalid_keys: set[KeyPath], law: Callable[[KeyPath], str], at: KeyPath = ()
) -> Iterator[tuple[str, Any]]:
    """Converted values of all keys that are valid by themselves, as input of the constraints."""
    for name, field in fields_at(at, law(at)).items():
        key = (*at, name)
        if key in invalid_keys or (name not in tables and field.is_required()):
            continue
        if fields.item_table(field):
            continue  # checked where the array is read
        if key in MATERIALS or fields.subtable(field):
            yield from _valid_values(tables.get(name, {}), invalid_keys, law, key)
        else:
            value, converter = tables.get(name, field.default), fields.converter_of(field)
            with suppress(PydanticCustomError):  # a key that was not checked, since its table is invalid
                yield ".".join(key), converter(value) if converter else value


def _violated(given: CaseInput, violation: ViolatedConstraint) -> Problem:
    keys: list[KeyPath] = [tuple(key.split(".")) for key in violation.constraint.keys]
    value = violation.values[0]
    expected = violation.message + _unit_hint(violation)
    stated = f" {expected}" if value is None else f" = {fields.shown(value)}: {expected}"
    at = next((key for key in keys if given.has(key)), keys[0])
    present = [key for key, value in zip(keys, violation.values, strict=True) if value is not None]
    others = [_location(given, key) for key in present if key != at]
    return problem_of(given, at, _qualified(keys[0]) + stated, "; ".join(others), keys[0])


def _unit_hint(violation: ViolatedConstraint) -> str:
    """That the larger of two lengths is likely to be in mm; "" if it is not much larger, or they are no lengths."""
    lengths = {
        value: key
        for key, value in zip(violation.constraint.keys[:2], violation.values, strict=False)
        if isinstance(value, float) and (number := fields.number_of(field_at(tuple(key.split(".")), "")))
        if number.unit == "m"
    }
    if len(lengths) < 2 or max(lengths) < max(LEAST_LENGTH, MOST_RATIO * min(lengths)):
        return ""
    return f'; if {lengths[max(lengths)]} is in mm, write "{max(lengths):g} mm"'


def _location(given: CaseInput, key: KeyPath) -> str:
    name, override, source = ".".join(key), given.override_of(key), given.source_of(key)
    if not given.has(key):
        return f"{name}: default value"
    return f"{name}: {set_option(override.argument) if override else f'{source.name}:{source.location(key)[0]}'}"
