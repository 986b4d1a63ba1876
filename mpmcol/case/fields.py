"""Reading the schema's fields: what a key expects, in words, and how a value looks in a case file."""

from __future__ import annotations

import difflib
import json
import types
from collections.abc import Iterable
from typing import Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from mpmcol.units import Keys, Number

_LONGEST = 60


def fields(table: type[Keys]) -> dict[str, FieldInfo]:
    """Give the fields of a table by the names that they have in a case file."""
    return {field.alias or name: field for name, field in table.model_fields.items()}


def value_type(field: FieldInfo) -> Any:
    """Give the type of a key without its "or None"."""
    if get_origin(field.annotation) in (Union, types.UnionType) and type(None) in get_args(field.annotation):
        return next(kind for kind in get_args(field.annotation) if kind is not type(None))
    return field.annotation


def subtable(field: FieldInfo) -> type[Keys] | None:
    """Give the table that a key stands for, None if it is a plain value."""
    kind = value_type(field)
    return kind if isinstance(kind, type) and issubclass(kind, Keys) else None


def number_of(field: FieldInfo) -> Number | None:
    """Give the unit and bounds of a quantity, None for other keys."""
    return next((part for part in field.metadata if isinstance(part, Number)), None)


def item_number(field: FieldInfo) -> Number | None:
    """Give the unit and bounds of the items of an array of quantities, None for other keys."""
    items = get_args(value_type(field))[:1] if get_origin(value_type(field)) is tuple else ()
    parts = (part for item in items for part in get_args(item))
    return next((part for part in parts if isinstance(part, Number)), None)


def allowed(field: FieldInfo) -> tuple[Any, ...]:
    """Give the words that a key accepts, empty if it accepts more than a few words."""
    return get_args(value_type(field)) if get_origin(value_type(field)) is Literal else ()


def minimum(field: FieldInfo) -> int | None:
    """Give the smallest value of a whole number, None if it has none."""
    return next((part.ge for part in field.metadata if hasattr(part, "ge")), None)


def expected(field: FieldInfo) -> str:
    """Say what a key accepts, for example "a number > 0, in m"."""
    if number := number_of(field):
        return number.expected
    if item := item_number(field):
        return f"an array, each item {item.expected}"
    if words := allowed(field):
        return " or ".join(", ".join(map(shown, words)).rsplit(", ", 1))
    at_least = minimum(field)
    whole = "a whole number" + ("" if at_least is None else f" >= {at_least}")
    return {bool: "true or false", int: whole, str: "a text in quotes"}.get(value_type(field), "a table")


def shown(value: Any) -> str:
    """Write a value nearly as a case file has it, in at most a few dozen printable characters."""
    match value:
        case None:
            return "absent"
        case bool():
            return str(value).lower()
        case str():
            return shortened(json.dumps(value, ensure_ascii=False))
        case float():
            return f"{value:.9g}"
        case dict():
            return "a table"
        case list() | tuple():
            return shortened(f"[{', '.join(shown(item) for item in value[:_LONGEST])}]")
    return shortened(str(value))


def shortened(text: str, longest: int = _LONGEST) -> str:
    """Replace what a terminal cannot print, and cut a long text."""
    printable = "".join(character if character.isprintable() else "?" for character in text[: longest + 1])
    return printable if len(printable) <= longest else printable[: longest - 3] + "..."


def nearest(word: str, words: Iterable[str]) -> str | None:
    """Give the word that was probably meant: a similar one, or the shortest that begins so, or None."""
    by_lower, lower = {known.lower(): known for known in words}, word.lower()[:_LONGEST]
    begun = sorted((known for known in by_lower if lower and known.startswith(lower)), key=len)
    near = difflib.get_close_matches(lower, by_lower, 1) or begun
    return by_lower[near[0]] if near else None
