"""The case file format (schema 1): all tables, and the defaults that depend on other tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal, Union

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from mpmcol.case.constraints import violations
from mpmcol.case.tables import (
    GeometryTable,
    GridTable,
    MethodTable,
    OutputTable,
    ScoreTable,
    StagesTable,
    TimeTable,
    integer,
)
from mpmcol.case.values import leaf_values
from mpmcol.mpm.constitutive import LAWS, elastic
from mpmcol.units import Table, option

if TYPE_CHECKING:

    class ColumnMaterial(elastic.Elasticity):
        """Keys that the materials of all laws have."""

        law: str
else:
    _materials = tuple(law.Material for law in LAWS.values())
    ColumnMaterial = Annotated[Union[_materials], Field(discriminator="law")]  # noqa: UP007


def _elastic_part(data: dict[str, Any]) -> elastic.Material:
    shared = data["material"].model_dump(include=set(elastic.Elasticity.model_fields))
    return elastic.Material(law="elastic", **shared)


class Case(Table):
    """A simulation as read from a case file, with all defaults resolved."""

    schema_: Annotated[Literal[1], BeforeValidator(integer), Field(alias="schema")] = option(
        "version of the case file format", 1
    )
    title: str = option("title in tables and charts", "")
    geometry: GeometryTable = option("column, base and domain")
    grid: GridTable = option("background grid and material points")
    material: ColumnMaterial = option("material of the column; its other keys depend on law")
    base_material: elastic.Material = Field(
        default_factory=_elastic_part,
        description="material of the elastic base; default: density and elastic constants of material",
    )
    method: MethodTable = option("variants of the material point method", MethodTable())
    time: TimeTable = option("time step", TimeTable())
    stages: StagesTable = Field(default=StagesTable(), validate_default=True, description="stages of the run")
    output: OutputTable = option("output files", OutputTable())
    score: ScoreTable = option("comparison with an experiment", ScoreTable())

    @field_validator("grid", mode="before")
    @classmethod
    def _resolve_from_geometry(cls, grid: Any, info: ValidationInfo) -> Any:
        """Resolve the default of points_per_cell: two per axis."""
        geometry = info.data.get("geometry")
        if geometry is None or not isinstance(grid, dict):
            return grid
        return {"points_per_cell": 2**geometry.dimension, **grid}

    @field_validator("stages", mode="before")
    @classmethod
    def _resolve_from_material(cls, stages: Any, info: ValidationInfo) -> Any:
        """Resolve the defaults of stages that depend on the material."""
        material = info.data.get("material")
        given = stages.model_dump(exclude_none=True) if isinstance(stages, StagesTable) else stages
        if material is None or not isinstance(given, dict):
            return given
        filled = {"k0": _active_ratio(material), **given}
        if isinstance(equilibrate := given.get("equilibrate", {}), dict):
            filled["equilibrate"] = {"law": material.law if given.get("gate", True) else "elastic", **equilibrate}
        return filled

    @model_validator(mode="after")
    def _check_constraints(self) -> Case:
        found = [f"{violation.key} {violation.message}" for violation in violations(leaf_values(self))]
        if found:
            raise PydanticCustomError("constraints", "{text}", {"text": "; ".join(found)})
        return self


def _active_ratio(material: Any) -> float:
    """Ratio of horizontal to vertical stress: 1 / N_phi, or nu / (1 - nu) for a law without friction."""
    elastic_ratio = material.poissons_ratio / (1.0 - material.poissons_ratio)
    return float(getattr(material, "active_pressure_ratio", elastic_ratio))
