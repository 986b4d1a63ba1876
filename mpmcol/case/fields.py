"""Access to the fields of the schema: type, bounds and accepted values of a key; values as in a case file."""

from __future__ import annotations

import difflib
import json
import types
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from mpmcol.units import Number, Table

_MAX_LENGTH = 60
_SIMILAR = 0.75  # ratio of difflib from which names count as similar


def fields(table: type[Table]) -> dict[str, FieldInfo]:
    """Fields of a table by their names in a case file."""
    return {field.alias or name: field for name, field in table.model_fields.items()}


def value_type(field: FieldInfo) -> Any:
    """Type of a key without None."""
    if get_origin(field.annotation) in (Union, types.UnionType) and type(None) in get_args(field.annotation):
        return next(kind for kind in get_args(field.annotation) if kind is not type(None))
    return field.annotation


def subtable(field: FieldInfo) -> type[Table] | None:
    """Table that a key holds; None for a value."""
    kind = value_type(field)
    return kind if isinstance(kind, type) and issubclass(kind, Table) else None


def item_table(field: FieldInfo) -> type[Table] | None:
    """Table that each item of an array holds; None for other keys."""
    items = get_args(value_type(field))[:1] if get_origin(value_type(field)) is tuple else ()
    return next((item for item in items if isinstance(item, type) and issubclass(item, Table)), None)


def number_of(field: FieldInfo) -> Number | None:
    """Unit and bounds of a quantity; None for other keys."""
    return next((part for part in field.metadata if isinstance(part, Number)), None)


def converter_of(field: FieldInfo) -> Any:
    """What converts a value of a case file, with a description `expected`: a `Number` or `OutlinePoints`; or None."""
    return next((part for part in field.metadata if hasattr(part, "expected")), None)


def item_number(field: FieldInfo) -> Number | None:
    """Unit and bounds of the items of an array of quantities; None for other keys."""
    items = get_args(value_type(field))[:1] if get_origin(value_type(field)) is tuple else ()
    parts = (part for item in items for part in get_args(item))
    return next((part for part in parts if isinstance(part, Number)), None)


def allowed(field: FieldInfo) -> tuple[Any, ...]:
    """Values that a key accepts, if they are enumerated; otherwise empty."""
    return get_args(value_type(field)) if get_origin(value_type(field)) is Literal else ()


def minimum(field: FieldInfo) -> int | None:
    """Lower bound of an integer; None without a bound."""
    return next((part.ge for part in field.metadata if hasattr(part, "ge")), None)


def is_quoted(text: str, field: FieldInfo) -> bool:
    """Whether a string is a value of a key that accepts no strings, in quotes."""
    if value_type(field) is bool:
        return text in ("true", "false")
    return (value_type(field) is int and text.isdecimal()) or text in (
        str(value) for value in allowed(field) if not isinstance(value, str)
    )


def expected(field: FieldInfo) -> str:
    """Description of the accepted values, for example "a number > 0, in m"."""
    if converter := converter_of(field):
        return str(converter.expected)
    if item := item_number(field):
        return f"an array, each item {item.expected}"
    if item_table(field):
        return "an array of tables"
    if values := allowed(field):
        return " or ".join(", ".join(map(shown, values)).rsplit(", ", 1))
    at_least = minimum(field)
    integer = "an integer" + ("" if at_least is None else f" >= {at_least}")
    return {bool: "true or false", int: integer, str: "a string in quotes"}.get(value_type(field), "a table")


def shown(value: Any) -> str:
    """A value as in a case file, in at most 60 printable characters."""
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
            return shortened(f"[{', '.join(_first_items(value))}]")
    return shortened(str(value))


def _first_items(values: Sequence[Any]) -> Iterator[str]:
    """The first items of an array, as many as can be shown."""
    length = 0
    for item in values:
        yield (text := shown(item))
        length += len(text) + len(", ")
        if length > _MAX_LENGTH:
            return


def shortened(text: str, longest: int = _MAX_LENGTH) -> str:
    """A text without unprintable characters, cut to a maximum length."""
    printable = text[: longest + 1]
    if not printable.isprintable():
        printable = "".join(character if character.isprintable() else "?" for character in printable)
    return printable if len(printable) <= longest else printable[: longest - 3] + "..."


def nearest(name: str, names: Iterable[str]) -> str | None:
    """The most similar known name, or the shortest one with this beginning; None if there is neither."""
    by_lower, lower = {known.lower(): known for known in names}, name.lower()[:_MAX_LENGTH]
    longer = sorted((known for known in by_lower if lower and known.startswith(lower)), key=len)
    near = difflib.get_close_matches(lower, by_lower, 1, _SIMILAR) or longer
    return by_lower[near[0]] if near else None
