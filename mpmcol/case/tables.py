"""The tables of a case file and their keys, each with its description, unit, bounds and default."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import BeforeValidator, Field, field_validator, model_validator
from pydantic_core import PydanticCustomError

from mpmcol.case.constraints import FILTER_STRENGTH
from mpmcol.experiments import EXPERIMENTS
from mpmcol.mpm.constitutive import LAWS
from mpmcol.units import Number, Table, option, quantity

if TYPE_CHECKING:
    LawName: TypeAlias = str
    ExperimentName: TypeAlias = str
else:
    LawName = Literal[tuple(LAWS)]
    ExperimentName = Literal[("paper", *EXPERIMENTS)]


def integer(value: Any) -> Any:
    """Refuse values that are no integers: as members of a Literal, True == 1 and 4.0 == 4 would pass."""
    if type(value) is not int:
        raise PydanticCustomError("integer", "expected an integer")
    return value


class GridTable(Table):
    """The background grid and the material points in it."""

    spacing: float = quantity("grid node spacing h", "m", gt=0)
    points_per_cell: Annotated[Literal[1, 4, 8, 9, 16, 27], BeforeValidator(integer)] = option(
        "initial number of material points per cell: 1, 4, 9 or 16 in 2D, 1, 8 or 27 in 3D; default: two per axis", None
    )


class MethodTable(Table):
    """The material point method and its variants."""

    basis: Literal["linear", "quadratic", "cubic"] = option(
        "B-spline shape functions; linear ones suffer from cell-crossing error",
        "quadratic",
    )
    kernel_correction: bool = option(
        "correct the shape functions next to walls, so that they reproduce constant and linear fields; false: "
        "truncated B-splines",
        True,
    )
    transfer: Literal["taylor-flip", "flip", "pic", "tpic", "apic"] = option(
        "velocity transfer between points and grid: taylor-flip is Taylor P2G with FLIP update (the paper), tpic is "
        "Taylor P2G with PIC update, apic is affine PIC",
        "taylor-flip",
    )
    flip_fraction: float = quantity(
        "FLIP fraction of the velocity update of taylor-flip and flip; the rest is PIC", "", 1.0, ge=0, le=1
    )
    stress_order: Literal["usl", "usf", "musl"] = option(
        "stress update last (usl, the paper), first (usf), or last with nodal velocities recomputed from the updated "
        "points (musl); usf and musl take almost twice as long",
        "usl",
    )
    position_update: Literal["trapezoid", "paper", "end"] = option(
        "position update: x += dt v - dt^2 a / 2 (trapezoid), x += dt v - dt^2 a as printed in Eq. 27 (paper), or "
        "x += dt v (end); v, a: nodal velocity at the end of the step and acceleration",
        "trapezoid",
    )
    wall_impulse: bool = option(
        "include the wall reaction in the FLIP velocity increment; false: the paper's form", True
    )
    volume_update: Literal["determinant", "exponential"] = option(
        "factor of the volume ratio J in a step: det(I + dt L) (the paper), which grows under pure rotation, or "
        "exp(dt tr L)",
        "determinant",
    )
    volumetric_strain: Literal["point", "cell"] = option(
        "volumetric strain increment of each point, or averaged over the points of a cell that have not opened, which "
        "avoids volumetric locking of nearly incompressible material and of linear shape functions",
        "point",
    )
    opening_strain: bool = option(
        "track the opening strain: separated material stays stress-free until the opening is closed", True
    )
    stress_filter: Literal["none", "flow"] = option(
        "filter of the mean stress: none (the paper), or flow, where the mean stress of flowing points approaches its "
        "average on the grid, which removes differences between the points of a cell; default: flow, or none without "
        "kernel_correction",
        None,
    )
    filter_strength: float = quantity(
        "rate of stress_filter = flow in units of c_p / h: part of the difference removed while a wave crosses a cell",
        "",
        FILTER_STRENGTH,
        gt=0,
        le=10,
    )
    deactivate_base: bool = option(
        "deactivate the elastic base during the collapse at distances from the column larger than its thickness; its "
        "nodes are fixed; saves 10 to 20 % of the time in 2D, 50 % in 3D",
        False,
    )

    @model_validator(mode="before")
    @classmethod
    def _resolve_filter(cls, data: Any) -> Any:
        """Resolve the default of stress_filter."""
        if not isinstance(data, dict):
            return data
        return {"stress_filter": "none" if data.get("kernel_correction") is False else "flow", **data}


class TimeTable(Table):
    """The time step."""

    cfl: float = quantity(
        "Courant number, time step over h / (c_p + v); a warning is issued if the single-particle stability limit is "
        "exceeded",
        "",
        0.5,
        gt=0,
        le=2,
    )


class EquilibrateTable(Table):
    """First stage: equilibrium under gravity behind the gate."""

    damping: float = quantity("local damping coefficient alpha_d", "", 0.5, ge=0, lt=1)
    law: LawName = option(
        "constitutive law of the column in this stage: elastic (default without a gate), or that of the material", None
    )
    max_time_factor: float = quantity("maximum duration in units of 4 h_i / c_p", "", 40.0, gt=0)
    tolerance: float = quantity("unbalanced force ratio at which the column is in equilibrium", "", 1e-4, gt=0, lt=1)


class CollapseTable(Table):
    """Second stage: collapse after the removal of the gate."""

    damping: float = quantity("local damping coefficient alpha_d", "", 0.05, ge=0, lt=1)
    end: Literal["rest", "time"] = option("end at rest, or after the maximum duration", "rest")
    max_time_factor: float = quantity(
        "maximum duration in units of sqrt(h_i / g); default: 10, on a slope up to five times as long", "", None, gt=0
    )


class StagesTable(Table):
    """The stages of a run."""

    initial_stress: Literal["gravity", "k0"] = option(
        "initial stress: loaded by gravity with damping, or assigned with the ratio k0 and then relaxed", "gravity"
    )
    k0: float = quantity(
        "ratio of horizontal to vertical stress for initial_stress = k0; default: active earth pressure ratio",
        "",
        None,
        ge=0,
    )
    equilibrate: EquilibrateTable = option("first stage: equilibrium under gravity behind the gate", EquilibrateTable())
    collapse: CollapseTable = option("second stage: collapse after the removal of the gate", CollapseTable())
    gate: bool = option(
        "whether a gate at x = r_i holds the material until the release; false: the material stands free, and in the "
        "first stage its law is elastic by default",
        True,
    )
    gate_speed: float = quantity(
        "speed at which the gate is lifted, opening from the bottom; inf: instantaneous removal",
        "m/s",
        math.inf,
        gt=0,
        allow_inf=True,
    )


_RELEASE_TIME = Number("s", {"ge": 0})


class OutputTable(Table):
    """Files that a run writes."""

    snapshots: Annotated[int, Field(ge=1)] = option(
        "number of snapshots until 6 sqrt(h_i / g) after release, on a slope up to five times as long, equally spaced; "
        "then at the same interval",
        20,
    )
    times: tuple[Annotated[float, _RELEASE_TIME, BeforeValidator(_RELEASE_TIME)], ...] | None = option(
        "times of the snapshots after release, increasing; replaces snapshots", None
    )
    compression: Literal["none", "gzip"] = option("compression of the snapshot files", "none")
    wall_forces: bool = option(
        "record forces and moments on floor, back wall and gate, and on [[walls]]: columns of history.csv, and peaks "
        "in result.json",
        False,
    )

    @field_validator("times", mode="before")
    @classmethod
    def _array(cls, times: Any) -> Any:
        return tuple(times) if isinstance(times, list) else times


class ScoreTable(Table):
    """Comparison with an experiment."""

    experiment: ExperimentName = option(
        "experiment that the result is compared with; paper: the one of the paper for this model", "paper"
    )
