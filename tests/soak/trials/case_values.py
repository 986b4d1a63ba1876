"""Cases with values at bounds, of wrong type or unit, huge or tiny are run, or refused with a message for each key.

Half of the trials only use values that the keys accept by themselves, so that many cases are discretized.
"""

from __future__ import annotations

import math
import random
import tomllib
from collections.abc import Iterator
from contextlib import suppress
from copy import deepcopy
from datetime import date
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import tomli_w

from mpmcol.case import flattened_text, key_names, shipped_cases
from mpmcol.case.fields import (
    allowed,
    converter_of,
    item_number,
    item_table,
    minimum,
    number_of,
    subtable,
    value_type,
)
from mpmcol.case.outline import OutlinePoints
from mpmcol.case.reference import MATERIALS, field_at, fields_at
from mpmcol.case.toml_lines import value_at
from mpmcol.units import FACTORS, Number
from tests.support.bad_input import failure_in_reading, find_failure

COUNT = 20_000
KEYS_OF_A_TRIAL, KEYS_OF_A_VALID_TRIAL = (1, 2, 4, 8), (1, 1, 2, 3)
WRONG_TYPES = (
    True, False, 0, -1, 2**63 - 1, -(2**63), math.nan, math.inf, -math.inf, "", " ", "x", "é\u202e\x1b[0m", "x" * 3000,
    [], [[]], [1, 2], ["a"], {}, {"a": {"b": 1}}, date(1979, 5, 27),
)  # fmt: skip
STRUCTURAL = (
    "extends",
    "schema",
    "material.law",
    "layers.material.law",
    "geometry.model",
)  # another value makes other keys invalid
NEAR = (-1e-9, 0.0, 1e-9)  # beside a bound
POWERS = ((-1.0, 1.0), (-6.0, 6.0), (-29.9, 29.9), (-320.0, 308.0))  # of ten


def trial(seed: int, folder: Path) -> str | None:
    """Check one case, with some of its values given as by `--set`."""
    draw = random.Random(seed)
    tables = tomllib.loads(draw.choice(_texts()))
    only_valid, overrides = draw.random() < 0.5, []
    for _ in range(draw.choice(KEYS_OF_A_VALID_TRIAL if only_valid else KEYS_OF_A_TRIAL)):
        key, value = _change(draw, tables, only_valid)
        if draw.random() < 0.2:
            overrides.append(f"{key}={draw.choice((_as_toml(value), str(value)))}")
        elif value is None:
            _remove(tables, key)
        else:
            _put(tables, key, value)
    path = folder / "my.toml"
    path.write_text(tomli_w.dumps(tables), encoding="utf-8")
    return find_failure(lambda: failure_in_reading(path, overrides))


@cache
def _texts() -> tuple[str, ...]:
    return tuple(flattened_text(name) for name in shipped_cases())


def _change(draw: random.Random, tables: dict[str, Any], only_valid: bool) -> tuple[str, Any]:
    """A key and its new value; None to leave the key out."""
    law = tables["material"].get("law") if isinstance(tables.get("material"), dict) else None
    key = draw.choice([key for key in key_names() if not only_valid or (key not in STRUCTURAL and _is_value(key, law))])
    key = _in_an_item(draw, tables, key)
    path = tuple(key.split("."))
    if not only_valid and draw.random() < 0.1:
        return draw.choice((key + "s", key.upper(), f"{key}.x", path[-1], f"é.{key}")), 1
    if not only_valid and draw.random() < 0.1:
        return key, None
    values = list(_values(draw, field_at(path, law if isinstance(law, str) else "")))
    return key, draw.choice(values if only_valid else [*values, *deepcopy(WRONG_TYPES)])


def _is_value(key: str, law: str) -> bool:
    """Whether a key is a value, not a table, in a case with this law."""
    *table, name = key.split(".")
    field = fields_at(tuple(table), law).get(name)
    return field is not None and not (subtable(field) or item_table(field) or tuple(key.split(".")) in MATERIALS)


def _in_an_item(draw: random.Random, tables: dict[str, Any], key: str) -> str:
    """A key of an array of tables with the index of an item, which is added if there is none; other keys as given."""
    array, _, inside = key.partition(".")
    if not inside or array not in ("layers", "walls"):
        return key
    items = tables.get(array)
    if not isinstance(items, list) or not items:
        items = tables[array] = [_item(tables, array)]
    return f"{array}.{draw.randrange(len(items))}.{inside}"


def _item(tables: dict[str, Any], array: str) -> dict[str, Any]:
    """A layer, or a wall in front of the column, with the base that walls need."""
    if array == "layers":
        return {"to": 0.05, "material": {"density": 2000.0}}
    for table, values in (("geometry", {"base": "rigid"}), ("method", {"wall_impulse": True})):
        if isinstance(tables.setdefault(table, {}), dict):
            tables[table] |= values
    geometry = tables["geometry"]
    radius = geometry.get("radius") if isinstance(geometry, dict) else None
    start = 2.0 * radius if isinstance(radius, float) and math.isfinite(radius) else 0.6
    return {"from": start, "to": 1.5 * start, "height": 0.5 * start}


def _values(draw: random.Random, field: Any) -> Iterator[Any]:
    """Values that a key accepts by itself, or almost."""
    if number := number_of(field):
        yield from (_number(draw, number) for _ in range(8))
        yield f"{_number(draw, number)!r} {draw.choice([*FACTORS, 'furlong', 'm m', '°'])}"
    elif item := item_number(field):
        yield sorted(abs(_number(draw, item)) for _ in range(draw.choice((0, 1, 3, 300))))
        yield [_number(draw, item) for _ in range(3)]
    elif isinstance(converter_of(field), OutlinePoints):
        yield [[draw.choice((0.0, draw.uniform(0.0, 0.3))) for _ in "xy"] for _ in range(draw.choice((2, 3, 4, 600)))]
        yield [[0.0, 0.0], [draw.uniform(0.0, 1.0), 0.0], [draw.uniform(0.0, 1.0), draw.uniform(0.0, 1.0)]]
        yield "outline.csv"
    elif options := allowed(field):
        yield from options
    elif value_type(field) is int:
        yield from (minimum(field) or 0, 1, 7, 10**6, 10**15)
    elif value_type(field) is bool:
        yield from (True, False)
    else:
        yield from ("elastic", "gravity", "x")


def _number(draw: random.Random, number: Number) -> float:
    """A number between the bounds, at or beside them, or of any power of ten."""
    low = next((bound for name, bound in number.bounds.items() if name[0] == "g"), 0.0)
    high = next((bound for name, bound in number.bounds.items() if name[0] == "l"), None)
    near = [bound + step for bound in number.bounds.values() for step in NEAR]
    usual = draw.uniform(low, high) if high is not None else 10.0 ** draw.uniform(*draw.choice(POWERS))
    return draw.choice([*near, usual, usual, usual, usual])


def _put(tables: dict[str, Any], key: str, value: Any) -> None:
    """Set a key, through the items of arrays of tables; what is in its way becomes a table."""
    parts = key.split(".")
    table: Any = tables
    for part, following in pairwise(parts):
        place = int(part) if isinstance(table, list) else part
        inside = table[place] if isinstance(table, list) else table.get(part)
        if not (isinstance(inside, dict) or (isinstance(inside, list) and following.isdecimal())):
            inside = table[place] = {}
        table = inside
    table[parts[-1]] = value


def _remove(tables: dict[str, Any], key: str) -> None:
    *path, name = key.split(".")
    with suppress(KeyError):
        table = value_at(tables, tuple(path))
        if isinstance(table, dict):
            table.pop(name, None)


def _as_toml(value: Any) -> str:
    return "" if value is None else tomli_w.dumps({"v": value}).removeprefix("v = ").strip()
