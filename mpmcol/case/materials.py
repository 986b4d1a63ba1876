"""Materials of column, base and layers: keys that are not given are those of the column's material."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Union

from pydantic import Field, field_validator

from mpmcol.case.constraints import violations
from mpmcol.case.geometry import GeometryTable
from mpmcol.case.problem import refusal
from mpmcol.case.values import leaf_values
from mpmcol.mpm.constitutive import LAWS, elastic
from mpmcol.units import Table, option, quantity

if TYPE_CHECKING:

    class Material(elastic.Elasticity):
        """Keys that the materials of all laws have."""

        law: str
else:
    _materials = tuple(law.Material for law in LAWS.values())
    Material = Annotated[Union[_materials], Field(discriminator="law")]  # noqa: UP007

MOST_LAYERS = {2: 14, 3: 2}  # by dimension: cells of a tile times materials are numbered in a byte


class LayerTable(Table):
    """A layer of the column."""

    from_: Annotated[float, Field(alias="from")] = quantity("height of its lower end above the base", "m", 0.0, ge=0)
    to: float = quantity("height of its upper end", "m", gt=0)
    material: Material = option("its material; keys that are not given are those of the column's")

    @field_validator("material", mode="after")
    @classmethod
    def _check_material(cls, material: Material) -> Material:
        """Check what the constraints require of the column's material."""
        for violation in violations(leaf_values(material, "material.")):
            raise refusal(f"{violation.key.partition('.')[2]} {violation.message.replace('material.', '')}")
        return material


def default_base_law(base: Any, law: str) -> str:
    """Law of the base if the case names none: that of the column, `law`, for a granular bed."""
    return law if base == "granular" else "elastic"


def with_inherited_keys(base_material: Mapping[str, Any], material: Mapping[str, Any], base: Any) -> dict[str, Any]:
    """The base's material with the keys of that of the column: all with the same law, else the elastic ones."""
    law = base_material.get("law", default_base_law(base, str(material.get("law"))))
    return {**_shared(material, law), "law": law, **base_material}


def with_column_material(layer: Any, material: Mapping[str, Any]) -> Any:
    """A layer as given, with the keys of the column's material that its own does not replace."""
    own = layer.get("material", {}) if isinstance(layer, dict) else None
    if not isinstance(own, dict):
        return layer
    return {**layer, "material": {**_shared(material, own.get("law", material.get("law"))), **own}}


def with_law_of_column(case: Mapping[str, Any]) -> Mapping[str, Any]:
    """The tables of a case with the law of the column in its layers, so that they are checked if it is invalid."""
    material, layers = case.get("material"), case.get("layers")
    law = material.get("law") if isinstance(material, dict) else None
    if not isinstance(law, str) or law not in LAWS or not isinstance(layers, (list, tuple)):
        return case
    return {**case, "layers": [with_column_material(layer, {"law": law}) for layer in layers]}


def _shared(material: Mapping[str, Any], law: Any) -> dict[str, Any]:
    """Keys of a material that one with this law has as well."""
    keys = material if material.get("law") == law else elastic.Elasticity.model_fields
    return {key: material[key] for key in keys if key in material}


def check_laws(layers: list[Any], law: str) -> None:
    """Raise PydanticCustomError if a layer as given has another law than the column, before its other keys are read."""
    for number, layer in enumerate(layers):
        own = layer.get("material") if isinstance(layer, dict) else None
        if isinstance(own, dict) and own.get("law", law) in [other for other in LAWS if other != law]:
            raise refusal(f'must be that of the column, "{law}"', number, "material", "law")


def check_layers(layers: tuple[LayerTable, ...], geometry: GeometryTable) -> None:
    """Raise PydanticCustomError if layers overlap, begin above the column, or are too many."""
    height, most = geometry.h_i, MOST_LAYERS[geometry.dimension]
    if len(layers) > most:
        raise refusal(f"{len(layers)} layers, expected at most {most} for this model")
    top = 0.0
    for number, layer in sorted(enumerate(layers), key=lambda one: one[1].from_):
        at = number, "from"
        if not layer.from_ < layer.to:
            raise refusal(f"must be smaller than to = {layer.to:g} m", *at)
        if layer.from_ < top:
            raise refusal(f"lies in another layer, which ends at {top:g} m", *at)
        if layer.from_ >= height:
            raise refusal(f"lies above the column, {height:g} m high", *at)
        top = layer.to
