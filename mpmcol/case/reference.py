"""Reference of all keys: look-up by name, explanations for the terminal, JSON schema for editors."""

from __future__ import annotations

from copy import copy
from functools import cache
from typing import Any

from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from mpmcol.case import fields
from mpmcol.case.not_modelled import answer_to
from mpmcol.case.outline import COORDINATE, FEWEST, OutlinePoints
from mpmcol.case.schema import Case
from mpmcol.case.tables import LawName
from mpmcol.errors import UsageError
from mpmcol.mpm.constitutive import LAWS
from mpmcol.units import Table, option

# tables whose keys depend on their key `law`
MATERIALS = {
    ("material",): FieldInfo(annotation=LawName, description="constitutive law; the other keys depend on it"),
    ("base_material",): FieldInfo(
        annotation=LawName,
        default=None,
        description="constitutive law; default: elastic, or that of material for a granular base",
    ),
    ("layers", "material"): FieldInfo(
        annotation=LawName, default=None, description="constitutive law; default: that of material, and no other"
    ),
}
_EXTENDS = FieldInfo(
    annotation=str,
    default=None,
    description="case to extend, a shipped case or a path; keys given here replace those of the extended case",
)


@cache
def fields_at(table: tuple[str, ...], law: str) -> dict[str, FieldInfo]:
    """Fields of a table by name; () is the top level; the keys of materials depend on the law.

    An index of an item in an array of tables is ignored.
    """
    table = without_indices(table)
    if not table:
        return {"extends": _EXTENDS, **fields.fields(Case)}
    if table in MATERIALS:
        of_law = fields.fields(LAWS[law].Material) if law in LAWS else {}
        given = of_law if table == ("material",) else {name: _optional(field) for name, field in of_law.items()}
        return {"law": MATERIALS[table]} | given | {"law": MATERIALS[table]} if given else {}
    *parent, name = table
    field = fields_at(tuple(parent), law).get(name)
    inside = (fields.subtable(field) or fields.item_table(field)) if field else None
    return fields.fields(inside) if inside else {}


def without_indices(key: tuple[str, ...]) -> tuple[str, ...]:
    """A key without the indices of items in arrays of tables."""
    return tuple(name for name in key if not name.isdecimal())


def without_index(key: str) -> str:
    """A dotted key without the indices of items: layers.material.friction_deg of layers.0.material.friction_deg."""
    plain = ".".join(without_indices(tuple(key.split("."))))
    return plain if plain in key_names() else key


def heading(key: tuple[str, ...]) -> str:
    """A table as in a case file: [grid], or [[layers]] for an array of tables."""
    name = ".".join(without_indices(key))
    return f"[[{name}]]" if fields.item_table(field_at(without_indices(key), "")) else f"[{name}]"


def _optional(field: FieldInfo) -> FieldInfo:
    """The field without a default of its own: the key follows from another one."""
    optional = copy(field)
    optional.default = None
    return optional


def field_at(key: tuple[str, ...], law: str) -> FieldInfo:
    """Field of a key; without a known law, a key of material is looked up in all laws."""
    laws = [law] if law in LAWS else list(LAWS)
    found = [fields_at(key[:-1], name).get(key[-1]) for name in laws]
    return next((field for field in found if field), None) or option("a key that does not exist")


@cache
def key_names(table: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Dotted names of all keys and tables, in the order of the schema."""
    names: dict[str, None] = {}
    for law in LAWS:
        for name in fields_at(table, law):
            names[".".join((*table, name))] = None
            names |= dict.fromkeys(key_names((*table, name)))
    return tuple(names)


def explain(key: str = "") -> str:
    """Description, accepted values, unit and default of a key, or of all keys of a table.

    An empty key explains all tables. Raises UsageError with the nearest key if there is no such key.
    """
    if not key:
        tables = [name for name in fields_at((), "") if name not in ("schema", "title", "extends")]
        return "\n\n".join(map(explain, ["schema", "title", "extends", *tables]))
    names = key_names()
    if key not in names:
        raise UsageError(f"there is no key {fields.shown(key)}.{hint_for(key)} (mpmcol explain lists all keys)")
    path = tuple(key.split("."))
    inside = [name for name in names if name.startswith(key + ".")]
    title = heading(path) if inside else key
    lines = [f"{title}   {field_at(path, '').description}"] if inside else [key, *_details(path)]
    return "\n".join([*lines, *(line for name in inside for line in _indented(name))])


def keys_with(text: str) -> dict[str, str]:
    """Keys that contain a text, or whose description does, and their descriptions; underscores are spaces."""
    words = text.replace("_", " ").lower()
    described = {name: field_at(tuple(name.split(".")), "").description or "" for name in key_names()}
    return {name: about for name, about in described.items() if words in f"{name.replace('_', ' ')}; {about}".lower()}


def hint_for(key: str) -> str:
    """Why there is no such key, or the key with the most similar last part; "" if there is neither."""
    names = key_names()
    if answer := answer_to(tuple(key.split("."))):
        return f" {answer[:1].upper()}{answer[1:]}."
    near = fields.nearest(key.rpartition(".")[2], (name.rpartition(".")[2] for name in names))
    alike = [name for name in names if near and name.rpartition(".")[2] == near]
    return f' Did you mean "{fields.nearest(key, alike) or alike[0]}"?' if alike else ""


def _indented(name: str) -> list[str]:
    return [f"  {name}", *("  " + line for line in _details(tuple(name.split("."))))]


def _details(path: tuple[str, ...]) -> list[str]:
    field = field_at(path, "")
    lines = [f"    {field.description}", f"    {fields.expected(field)}{_default(field)}"]
    laws = laws_with(path)
    return lines + ([f"    laws: {', '.join(laws)}"] if len(laws) < len(LAWS) else [])


def laws_with(key: tuple[str, ...]) -> list[str]:
    """Laws for which a key exists: all, except for some keys of materials."""
    return [law for law in LAWS if key[-1] in fields_at(key[:-1], law)]


def default_value(field: FieldInfo) -> Any:
    """Default of a key; None if there is none, or if it depends on other keys."""
    is_value = field.default not in (None, PydanticUndefined, "") and not isinstance(field.default, Table)
    return field.default if is_value else None


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "; required"
    value = default_value(field)
    return "; optional" if value is None else f"; default {fields.shown(value)}"


def json_schema() -> dict[str, Any]:
    """JSON schema of a case file: draft 4 without references, as TOML editors require it."""
    schema = _table_schema(())
    required = schema.pop("required")
    schema["anyOf"] = [{"required": ["extends"]}, {"required": required}]
    return {"$schema": "http://json-schema.org/draft-04/schema#", "title": "mpmcol case", **schema}


def _table_schema(table: tuple[str, ...], law: str = "") -> dict[str, Any]:
    keys = fields_at(table, law)
    required = [name for name, field in keys.items() if field.is_required()]
    properties = {name: _field_schema((*table, name), field) for name, field in keys.items()}
    schema = {"type": "object", "properties": properties, "additionalProperties": False}
    return schema | ({"required": required} if required else {})


def _material_schema(table: tuple[str, ...], law: str) -> dict[str, Any]:
    schema = _table_schema(table, law)
    schema["properties"]["law"]["enum"] = [law]
    return schema


def _field_schema(key: tuple[str, ...], field: FieldInfo) -> dict[str, Any]:
    described: dict[str, Any] = {"description": field.description}
    if key in MATERIALS:
        # a law that may be omitted: several laws can then match
        match = "oneOf" if MATERIALS[key].is_required() else "anyOf"
        return described | {match: [_material_schema(key, law) for law in LAWS]}
    if fields.subtable(field):
        return described | _table_schema(key)
    if fields.item_table(field):
        return described | {"type": "array", "items": _table_schema(key)}
    schema = {"description": f"{field.description} ({fields.expected(field)})", **_value_schema(field)}
    plain = field.default not in (None, PydanticUndefined) and field.default != float("inf")
    return schema | ({"default": field.default} if plain else {})


def _value_schema(field: FieldInfo) -> dict[str, Any]:
    if number := fields.number_of(field):
        return _number_schema(number.bounds)
    if item := fields.item_number(field):
        return {"type": "array", "items": _number_schema(item.bounds), "minItems": 1}
    if isinstance(fields.converter_of(field), OutlinePoints):
        point = {"type": "array", "items": _number_schema(COORDINATE.bounds), "minItems": 2, "maxItems": 2}
        return {"oneOf": [{"type": "string"}, {"type": "array", "items": point, "minItems": FEWEST}]}
    if allowed := fields.allowed(field):
        return {"enum": list(allowed)}
    kind = {bool: "boolean", int: "integer"}.get(fields.value_type(field), "string")
    least = fields.minimum(field)
    return {"type": kind} | ({} if least is None else {"minimum": least})


def _number_schema(bounds: dict[str, float]) -> dict[str, Any]:
    schema: dict[str, Any] = {"type": ["number", "string"]}
    for name, bound in bounds.items():
        side = "minimum" if name[0] == "g" else "maximum"
        schema[side] = bound
        if name[1] == "t":
            schema[f"exclusive{side.capitalize()}"] = True
    return schema
