"""Reference of the shipped cases and of all keys of a case file in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from pydantic.fields import FieldInfo

from mpmcol.case import fields
from mpmcol.case.load import load_case
from mpmcol.case.outline import OutlinePoints
from mpmcol.case.reference import default_value, field_at, fields_at, heading, key_names, laws_with
from mpmcol.case.source import shipped_cases
from mpmcol.mpm.constitutive import LAWS

_KEY_COLUMNS = ("key", "accepted values", "unit", "default", "description")
_CASE_COLUMNS = ("case", "title", "model", "a", "spacing")


def markdown_reference() -> str:
    """Tables of the shipped cases and of the keys of each table of a case file."""
    tables = [name for name in key_names() if _is_table(name)]
    sections = [
        ("## Shipped cases", _CASE_COLUMNS, map(_case_row, shipped_cases())),
        ("## Keys at the top of the file", _KEY_COLUMNS, _key_rows(())),
        *(
            (f"## {heading(tuple(name.split('.')))}", _KEY_COLUMNS, _key_rows(tuple(name.split("."))))
            for name in tables
        ),
    ]
    return "\n".join(line for section in sections for line in _section(*section))


def _section(title: str, columns: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    table = title.removeprefix("## ").strip("[]")
    about = [str(field_at(tuple(table.split(".")), "").description) + ".", ""] if table in key_names() else []
    yield from (title, "", *(line[:1].upper() + line[1:] for line in about))
    yield from (_row(columns), "|" + "---|" * len(columns), *map(_row, rows), "")


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _case_row(name: str) -> tuple[str, ...]:
    case = load_case(name)
    a = f"{case.geometry.a:g}" if case.geometry.is_rectangle else "outline"
    return f"`{name}`", case.title, case.geometry.model, a, f"{1e3 * case.grid.spacing:g} mm"


def _key_rows(table: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    names = dict.fromkeys(name for law in LAWS for name in fields_at(table, law))
    for name in names:
        key = (*table, name)
        if not _is_table(".".join(key)):
            field = field_at(key, "")
            yield f"`{name}`", _accepted(field), _unit(field), _default(field), _description(key, field)


def _is_table(name: str) -> bool:
    return any(key.startswith(name + ".") for key in key_names())


def _accepted(field: FieldInfo) -> str:
    if number := fields.number_of(field):
        return (number.interval or "number") + (", or an angle in quotes" if number.is_tangent else "")
    if item := fields.item_number(field):
        return f"array, each {item.interval}"
    if values := fields.allowed(field):
        return ", ".join(f"`{fields.shown(value)}`" for value in values)
    return fields.expected(field)


def _unit(field: FieldInfo) -> str:
    number = fields.number_of(field) or fields.item_number(field)
    return number.unit if number else "m" if isinstance(fields.converter_of(field), OutlinePoints) else ""


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    value = default_value(field)
    return "" if value is None else f"`{fields.shown(value)}`"


def _description(key: tuple[str, ...], field: FieldInfo) -> str:
    laws = laws_with(key)
    return str(field.description) + (f" ({', '.join(laws)})" if len(laws) < len(LAWS) else "")
