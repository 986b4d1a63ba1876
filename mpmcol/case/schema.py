"""The words of a case file (schema 1): every table and key with its sentence, unit, bounds and default."""

from __future__ import annotations

import hashlib
import json
import math
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, Union

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from mpmcol.case.constraints import broken_rules
from mpmcol.experiments import EXPERIMENTS
from mpmcol.mpm.constitutive import LAWS, elastic
from mpmcol.units import Keys, Number, choice, quantity

if TYPE_CHECKING:

    class ColumnMaterial(elastic.Elasticity):
        """What every law's material has."""

        law: str

    LawName: TypeAlias = str
    ExperimentName: TypeAlias = str
else:
    _materials = tuple(law.Material for law in LAWS.values())
    ColumnMaterial = Annotated[Union[_materials], Field(discriminator="law")]  # noqa: UP007
    LawName = Literal[tuple(LAWS)]
    ExperimentName = Literal[("paper", *EXPERIMENTS)]


def _whole(value: Any) -> Any:
    if type(value) is not int:  # True == 1 and 4.0 == 4 would pass as members of a Literal
        raise PydanticCustomError("whole_number", "expected a whole number")
    return value


class Geometry(Keys):
    """The column, what it stands on, and the box that is simulated."""

    model: Literal["plane", "axisymmetric", "quarter", "full"] = choice(
        "plane strain, a cylinder by axial symmetry, or 3D: a quarter between two planes of symmetry, or all"
    )
    release: Literal["one-sided", "two-sided"] = choice(
        "plane: the column leans on a wall, or collapses to both sides (half of it is modelled)", "one-sided"
    )
    section: Literal["cylinder", "box"] = choice(
        "quarter, full: horizontal section of the column, a circle or a rectangle", "cylinder"
    )
    radius: float = quantity(
        "r_i: width of a plane column (half of it if two-sided), radius, or half-width of a box", "m", gt=0
    )
    depth: float | None = quantity("half-depth of a box; radius if absent", "m", None, gt=0)
    height: float | None = quantity("h_i: initial height of the column; or give aspect", "m", None, gt=0)
    aspect: float | None = quantity("a = h_i / r_i: aspect ratio; or give height", "", None, gt=0)
    base: Literal["elastic", "rigid"] = choice("elastic layer as in the paper, or no-slip grid nodes", "elastic")
    base_thickness: float = quantity("thickness of the elastic base", "m", 0.02, gt=0)
    domain_length: float | None = quantity(
        "length of the grid from the wall or axis; sized from the expected runout if absent", "m", None, gt=0
    )
    domain_height: float | None = quantity(
        "height of the grid above the base; sized from the column if absent", "m", None, gt=0
    )
    gravity: float = quantity("gravitational acceleration g, downwards", "m/s2", 9.81, gt=0)

    @property
    def shape(self) -> str:
        """Name of the column's geometry (mpmcol.setup.geometries)."""
        return self.model if self.model in ("plane", "axisymmetric") else self.section

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return 2 if self.model in ("plane", "axisymmetric") else 3

    @property
    def r_i(self) -> float:
        """Initial width or radius, m."""
        return self.radius

    @property
    def h_i(self) -> float:
        """Initial height, m."""
        return self.height if self.height is not None else self.radius * (self.aspect or math.nan)

    @property
    def a(self) -> float:
        """Aspect ratio h_i / r_i."""
        return self.aspect if self.aspect is not None else self.h_i / self.radius


class Grid(Keys):
    """The background grid and the material points in it."""

    spacing: float = quantity("grid node spacing h", "m", gt=0)
    points_per_cell: Annotated[Literal[1, 4, 8, 9, 16, 27], BeforeValidator(_whole)] = choice(
        "material points per full cell: a square number, in three dimensions a cube; 4 or 8 if absent", None
    )


class Method(Keys):
    """The material point method and its variants."""

    basis: Literal["linear", "quadratic", "cubic"] = choice(
        "B-spline that carries the points' data to the nodes; with linear hats, points that cross cells ring",
        "quadratic",
    )
    kernel_correction: bool = choice(
        "weights next to a wall keep constants and linear fields: hats in its half cell, for the cubic spline the node "
        "outside as a linear continuation; false cuts the spline off",
        True,
    )
    transfer: Literal["taylor-flip", "flip", "pic", "tpic", "apic"] = choice(
        "velocity transfer; taylor-flip (Taylor P2G, FLIP update) is the paper's, tpic has a PIC update, apic carries "
        "an affine matrix from the weights in place of the velocity gradient",
        "taylor-flip",
    )
    flip_fraction: float = quantity(
        "share of the FLIP velocity in taylor-flip and flip, the rest is PIC", "", 1.0, ge=0, le=1
    )
    stress_order: Literal["usl", "usf", "musl"] = choice(
        "when the stress is updated: last (the paper's), first, or last with nodal velocities made anew from the "
        "points; usf and musl take almost twice the time",
        "usl",
    )
    position_update: Literal["trapezoid", "paper", "end"] = choice(
        "x += dt v - dt^2 a / 2, the printed form without 1/2, or the end velocity", "trapezoid"
    )
    wall_impulse: bool = choice("points feel the impulse of a wall; false is the paper's form", True)
    volume_update: Literal["determinant", "exponential"] = choice(
        "factor on the volume ratio J in a step: det(I + dt L), the paper's, with which all that turns grows, or "
        "exp(dt tr L)",
        "determinant",
    )
    volumetric_strain: Literal["point", "cell"] = choice(
        "each point has its own, or all closed points of a cell have their mean, which keeps nearly incompressible "
        "material and linear hats from locking",
        "point",
    )
    opening_strain: bool = choice("material that has opened stays stress-free until it is closed again", True)
    deactivate_base: bool = choice(
        "deactivate the elastic base during the collapse where it is farther from the column than it is thick; its "
        "nodes are held; saves 10 to 20 % of the time in 2D, 50 % in 3D",
        False,
    )


class Time(Keys):
    """The time step."""

    cfl: float = quantity(
        "time step over h / (c_p + v); a run says so if a point alone does not bear it", "", 0.5, gt=0, le=2
    )


class Equilibrate(Keys):
    """First stage: the column comes to rest under gravity behind its gate."""

    damping: float = quantity("local damping alpha_d", "", 0.5, ge=0, lt=1)
    law: LawName = choice("law of the column in this stage: its own (if absent) or elastic", None)
    max_time_factor: float = quantity("longest duration in units of 4 h_i / c_p", "", 40.0, gt=0)
    tolerance: float = quantity("unbalanced force ratio at which the column rests", "", 1e-4, gt=0, lt=1)


class Collapse(Keys):
    """Second stage: the gate is gone and the column collapses."""

    damping: float = quantity("local damping alpha_d", "", 0.05, ge=0, lt=1)
    end: Literal["rest", "time"] = choice("end at rest, or only after the longest duration", "rest")
    max_time_factor: float = quantity("longest duration in units of sqrt(h_i / g)", "", 6.0, gt=0)


class Stages(Keys):
    """What happens one after the other."""

    initial_stress: Literal["gravity", "k0"] = choice(
        "damped loading by gravity, or assigned and then shortly damped", "gravity"
    )
    k0: float = quantity(
        "horizontal over vertical stress for initial_stress = k0; the law's active value if absent",
        "",
        None,
        ge=0,
    )
    equilibrate: Equilibrate = choice("the first stage: rest under gravity behind the gate", Equilibrate())
    collapse: Collapse = choice("the second stage: the collapse, after the gate is gone", Collapse())
    gate_speed: float = quantity("speed at which the gate is lifted", "m/s", math.inf, gt=0, allow_inf=True)


_RELEASE_TIME = Number("s", {"ge": 0})


class Output(Keys):
    """What is written during the run."""

    snapshots: Annotated[int, Field(ge=1)] = choice("snapshots of the collapse, even in time", 20)
    times: tuple[Annotated[float, _RELEASE_TIME, BeforeValidator(_RELEASE_TIME)], ...] | None = choice(
        "times of the snapshots in s after release, rising; replaces snapshots", None
    )
    compression: Literal["none", "gzip"] = choice("compression of the snapshots", "none")

    @field_validator("times", mode="before")
    @classmethod
    def _array(cls, times: Any) -> Any:
        return tuple(times) if isinstance(times, list) else times


class Score(Keys):
    """What the result is compared with."""

    experiment: ExperimentName = choice("published experiment to score against; paper: the paper's own", "paper")


def _elastic_part(data: dict[str, Any]) -> elastic.Material:
    shared = data["material"].model_dump(include=set(elastic.Elasticity.model_fields))
    return elastic.Material(law="elastic", **shared)


class Case(Keys):
    """A whole simulation, as read from a case file, with all defaults filled in."""

    schema_: Annotated[Literal[1], BeforeValidator(_whole), Field(alias="schema")] = choice(
        "version of the words in this file", 1
    )
    title: str = choice("one line for tables and charts", "")
    geometry: Geometry = choice("the column, its base and the domain")
    grid: Grid = choice("the background grid and the material points in it")
    material: ColumnMaterial = choice("the column's material; its other keys depend on law")
    base_material: elastic.Material = Field(
        default_factory=_elastic_part,
        description="the base's material; if absent, the elastic part of material",
    )
    method: Method = choice("the material point method and its variants", Method())
    time: Time = choice("the time step", Time())
    stages: Stages = Field(default=Stages(), validate_default=True, description="what happens, in turn")
    output: Output = choice("what is written during the run", Output())
    score: Score = choice("what the result is compared with", Score())

    @field_validator("grid", mode="before")
    @classmethod
    def _fill_in_from_geometry(cls, grid: Any, info: ValidationInfo) -> Any:
        """Resolve the default of points_per_cell: two an axis."""
        geometry = info.data.get("geometry")
        if geometry is None or not isinstance(grid, dict):
            return grid
        return {"points_per_cell": 2**geometry.dimension, **grid}

    @field_validator("stages", mode="before")
    @classmethod
    def _fill_in_from_material(cls, stages: Any, info: ValidationInfo) -> Any:
        """Resolve the defaults of stages that depend on the column's law."""
        material = info.data.get("material")
        given = stages.model_dump(exclude_none=True) if isinstance(stages, Stages) else stages
        if material is None or not isinstance(given, dict):
            return given
        filled = {"k0": _active_ratio(material), **given}
        if isinstance(equilibrate := given.get("equilibrate", {}), dict):
            filled["equilibrate"] = {"law": material.law, **equilibrate}
        return filled

    @model_validator(mode="after")
    def _agree(self) -> Case:
        broken = [f"{rule.key} {rule.sentence}" for rule in broken_rules(leaf_values(self))]
        if broken:
            raise PydanticCustomError("rules", "{text}", {"text": "; ".join(broken)})
        return self


def _active_ratio(material: Any) -> float:
    """Horizontal over vertical stress: 1 / N_phi, or nu / (1 - nu) for a law without friction."""
    elastic_ratio = material.poissons_ratio / (1.0 - material.poissons_ratio)
    return float(getattr(material, "active_pressure_ratio", elastic_ratio))


def leaf_values(keys: Keys, prefix: str = "") -> dict[str, Any]:
    """Give the value of every key by its dotted name, for example "stages.collapse.damping"."""
    values: dict[str, Any] = {}
    for name, field in type(keys).model_fields.items():
        value, path = getattr(keys, name), prefix + (field.alias or name)
        values |= leaf_values(value, path + ".") if isinstance(value, Keys) else {path: value}
    return values


def case_hash(case: Case) -> str:
    """Twelve hexadecimal digits that name what is simulated: neither title, output and score, nor how h_i was given."""
    content = case.model_dump(mode="json", by_alias=True, exclude={"title", "output", "score"})
    content["geometry"] |= {"aspect": None, "height": case.geometry.h_i}
    if case.geometry.dimension == 2:  # words that mean nothing there
        del content["geometry"]["section"], content["geometry"]["depth"]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:12]
