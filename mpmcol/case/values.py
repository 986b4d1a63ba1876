"""Values of a case by their dotted keys, and the hash that identifies what is simulated."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

from mpmcol.units import Table

if TYPE_CHECKING:
    from mpmcol.case.schema import Case


def leaf_values(keys: Table, prefix: str = "") -> dict[str, Any]:
    """Values of all keys by their dotted names, for example "stages.collapse.damping" or "layers.0.to"."""
    values: dict[str, Any] = {}
    for name, field in type(keys).model_fields.items():
        value, path = getattr(keys, name), prefix + (field.alias or name)
        if isinstance(value, Table):
            values |= leaf_values(value, path + ".")
        elif isinstance(value, tuple) and any(isinstance(item, Table) for item in value):
            for number, item in enumerate(value):
                values |= leaf_values(item, f"{path}.{number}.")
        else:
            values[path] = value
    return values


def case_hash(case: Case) -> str:
    """Twelve hexadecimal digits that identify the simulation.

    Title, output, score and the names of walls have no influence, nor have the choice between height and aspect and
    keys without a value in the tables of friction and of the materials.
    """
    content = case.model_dump(mode="json", by_alias=True, exclude={"title", "output", "score"})
    content["geometry"] |= {"aspect": None, "height": case.geometry.h_i}
    if not case.layers:
        del content["layers"]
    content["walls"] = [{**wall, "name": None} for wall in content["walls"]]
    if not case.walls:
        del content["walls"]
    if case.geometry.dimension == 2:  # keys without a meaning in 2D
        del content["geometry"]["section"], content["geometry"]["depth"]
    if case.geometry.outline is None:
        del content["geometry"]["outline"]
    if case.stages.gate:
        del content["stages"]["gate"]
    if case.geometry.sides == "normal":
        del content["geometry"]["sides"]
    if case.geometry.slope_deg == 0.0:  # without effect: the hash is that of a case without the key
        del content["geometry"]["slope_deg"]
    for table in ("friction", "material", "base_material"):
        content[table] = _given(content[table])
    for layer in content.get("layers", ()):
        layer["material"] = _given(layer["material"])
    if not content["friction"]:
        del content["friction"]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:12]


def _given(table: dict[str, Any]) -> dict[str, Any]:
    """A table without the keys that have no value."""
    return {key: value for key, value in table.items() if value is not None}
