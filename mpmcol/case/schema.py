"""The case file format (schema 1): all tables, and the defaults that depend on other tables."""

from __future__ import annotations

from math import isclose
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from mpmcol.case.constraints import violations
from mpmcol.case.friction import FrictionTable
from mpmcol.case.geometry import GeometryTable
from mpmcol.case.materials import (
    LayerTable,
    Material,
    check_laws,
    check_layers,
    with_column_material,
    with_inherited_keys,
    with_law_of_column,
)
from mpmcol.case.slope import case_slope_factor
from mpmcol.case.tables import (
    GridTable,
    MethodTable,
    OutputTable,
    ScoreTable,
    StagesTable,
    TimeTable,
    integer,
)
from mpmcol.case.values import leaf_values
from mpmcol.case.walls import WallTable, check_walls, with_names
from mpmcol.units import Table, option

MAX_TIME_FACTOR = 10.0  # default of stages.collapse.max_time_factor on a horizontal base


class Case(Table):
    """A simulation as read from a case file, with all defaults resolved."""

    schema_: Annotated[Literal[1], BeforeValidator(integer), Field(alias="schema")] = option(
        "version of the case file format", 1
    )
    title: str = option("title in tables and charts", "")
    geometry: GeometryTable = option("column, base and domain")
    grid: GridTable = option("background grid and material points")
    material: Material = option("material of the column; its other keys depend on law")
    base_material: Material = Field(
        default_factory=dict,
        validate_default=True,
        description="material of the base; keys that are not given are those of material",
    )
    layers: tuple[LayerTable, ...] = option("layers of the column, whose material has other parameters", ())
    friction: FrictionTable = option("Coulomb friction of floor and walls", FrictionTable())
    method: MethodTable = option("variants of the material point method", MethodTable())
    walls: tuple[WallTable, ...] = option("rigid walls on the base: dams, baffles, steps, end walls", ())
    time: TimeTable = option("time step", TimeTable())
    stages: StagesTable = Field(default=StagesTable(), validate_default=True, description="stages of the run")
    output: OutputTable = option("output files", OutputTable())
    score: ScoreTable = option("comparison with an experiment", ScoreTable())

    @model_validator(mode="before")
    @classmethod
    def _resolve_law_of_layers(cls, case: Any) -> Any:
        """Resolve the law of layers, also if another key of the column's material is invalid."""
        return with_law_of_column(case) if isinstance(case, dict) else case

    @field_validator("grid", mode="before")
    @classmethod
    def _resolve_from_geometry(cls, grid: Any, info: ValidationInfo) -> Any:
        """Resolve the default of points_per_cell: two per axis."""
        geometry = info.data.get("geometry")
        if geometry is None or not isinstance(grid, dict):
            return grid
        return {"points_per_cell": 2**geometry.dimension, **grid}

    @field_validator("base_material", mode="before")
    @classmethod
    def _resolve_base_material(cls, base_material: Any, info: ValidationInfo) -> Any:
        """Resolve the law of the base and the keys that follow from the material of the column."""
        geometry, material = info.data.get("geometry"), info.data.get("material")
        if not isinstance(base_material, dict):
            return base_material
        if geometry is None or material is None:  # invalid: only the keys that are given can be checked
            if geometry is not None and geometry.base == "granular" and "law" not in base_material:
                raise PydanticCustomError("derived", "the law follows from an invalid material")
            return {"law": "elastic", **base_material}
        return with_inherited_keys(base_material, material.model_dump(), geometry.base)

    @field_validator("layers", mode="before")
    @classmethod
    def _resolve_layers(cls, layers: Any, info: ValidationInfo) -> Any:
        """Resolve the keys of the layers that follow from the material of the column."""
        material = info.data.get("material")
        if not isinstance(layers, list):
            return layers
        if material is not None:
            check_laws(layers, material.law)
        return tuple(with_column_material(layer, material.model_dump() if material else {}) for layer in layers)

    @field_validator("layers", mode="after")
    @classmethod
    def _check_layers(cls, layers: tuple[LayerTable, ...], info: ValidationInfo) -> tuple[LayerTable, ...]:
        geometry, material = info.data.get("geometry"), info.data.get("material")
        if geometry is not None and material is not None and layers:
            check_layers(layers, geometry)
        return layers

    @field_validator("walls", mode="before")
    @classmethod
    def _resolve_walls(cls, walls: Any) -> Any:
        """Resolve the names of walls."""
        return with_names(walls) if isinstance(walls, list) else walls

    @field_validator("walls", mode="after")
    @classmethod
    def _check_walls(cls, walls: tuple[WallTable, ...], info: ValidationInfo) -> tuple[WallTable, ...]:
        geometry, method = info.data.get("geometry"), info.data.get("method")
        if geometry is not None and method is not None:
            grid = info.data.get("grid")
            h = geometry.fitted_spacing(grid.spacing) if grid and geometry.r_i > 0.0 else None  # NaN without a radius
            check_walls(walls, geometry, method.wall_impulse, h)
        return walls

    @field_validator("stages", mode="before")
    @classmethod
    def _resolve_from_material(cls, stages: Any, info: ValidationInfo) -> Any:
        """Resolve the defaults of stages that depend on the material and on the slope."""
        material, geometry = info.data.get("material"), info.data.get("geometry")
        given = stages.model_dump(exclude_none=True) if isinstance(stages, StagesTable) else stages
        if material is None or geometry is None or not isinstance(given, dict):
            return given
        filled = {"k0": _active_ratio(material), **given}
        slow = case_slope_factor(cls.model_construct(**info.data))  # keys that are invalid have their defaults
        defaults: dict[str, dict[str, Any]] = {
            "equilibrate": {"law": material.law if given.get("gate", True) else "elastic"},
            "collapse": {"max_time_factor": MAX_TIME_FACTOR * slow},
        }
        for stage, values in defaults.items():
            if isinstance(own := given.get(stage, {}), dict):
                filled[stage] = {**values, **own}
        return filled

    @field_validator("stages", mode="after")
    @classmethod
    def _check_k0(cls, stages: StagesTable, info: ValidationInfo) -> StagesTable:
        """Refuse a ratio that has no effect; the default is in resolved cases."""
        material = info.data.get("material")
        has_effect = stages.initial_stress == "k0" or stages.k0 is None or material is None
        if not has_effect and not isclose(stages.k0, _active_ratio(material)):
            text = f'has no effect with initial_stress = "{stages.initial_stress}": remove it, or set "k0"'
            raise PydanticCustomError("quantity", "{text}", {"text": text, "inside": ("k0",)})
        return stages

    @property
    def materials(self) -> tuple[Material, ...]:
        """Materials by kind of the points: column, base, layers of the column."""
        return (self.material, self.base_material, *(layer.material for layer in self.layers))

    @property
    def material_names(self) -> tuple[str, ...]:
        """Names of `materials` in messages and results."""
        return ("column", "base", *(f"layer-{number}" for number in range(1, len(self.layers) + 1)))

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
