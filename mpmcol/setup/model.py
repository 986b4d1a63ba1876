"""From a case to arrays: points, grid, walls of each stage, laws and numbers of each stage."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcol.case import Case
from mpmcol.mpm.constitutive import LAWS, elastic
from mpmcol.mpm.grid import TILE, Grid, allocate_grid, node_coordinates, set_fixed
from mpmcol.mpm.particles import BASE, Points
from mpmcol.mpm.settings import Scheme, Settings
from mpmcol.mpm.solver import Body
from mpmcol.setup.discretization import END_CELLS, Discretization, discretize, require_memory_for
from mpmcol.setup.geometries import GEOMETRIES
from mpmcol.setup.stability_limit import TRANSFERS
from mpmcol.setup.time_step import axis_gap

POSITION_FACTORS = {"trapezoid": 0.5, "paper": 1.0, "end": 0.0}
FALL_MARGIN = 2.0  # grains that others throw ahead are faster than a free fall
ON_NODE = 1e-6  # in h: how far a node may be from an edge and still stand on it


@dataclass(frozen=True)
class StageSetup:
    """What differs from stage to stage: the column's law, the damping, and where the base is inactive."""

    column: Body
    settings: Settings
    margin: int = 0  # tiles around the column beyond which the base is inactive; 0: all of it is active


@dataclass(frozen=True)
class Model:
    """Everything a run starts from."""

    discretization: Discretization
    points: Points
    grid: Grid
    scheme: Scheme
    base: Body
    equilibrate: StageSetup
    collapse: StageSetup

    @property
    def column_points(self) -> int:
        """Number of material points of the column."""
        return int(np.sum(self.points.kind != BASE))

    @property
    def column_mass(self) -> float:
        """Mass of the column, kg (per metre or radian in two dimensions)."""
        return float(self.points.m[self.points.kind != BASE].sum())


def build_model(case: Case) -> Model:
    """Allocate and fill all arrays of a case; the gate is closed. Raises UsageError if they cannot fit."""
    discretization = discretize(case)
    require_memory_for(discretization)
    grid = allocate_grid(discretization.origin, discretization.h, discretization.cells)
    close_walls(grid, discretization, gate_opening=0.0)
    points = fill(case, discretization)
    if case.stages.initial_stress == "k0":
        assign_k0(case, discretization, points)
    own_law, stages = case.material.law, case.stages
    first_law = elastic if stages.equilibrate.law == "elastic" else LAWS[own_law]
    return Model(
        discretization=discretization,
        points=points,
        grid=grid,
        scheme=Scheme(
            stress_order=case.method.stress_order,
            affine=case.method.transfer == "apic",
            basis=case.method.basis,
            volumetric_strain=case.method.volumetric_strain,
        ),
        base=make_body(elastic, case.base_material),
        equilibrate=StageSetup(
            make_body(first_law, case.material), make_settings(case, discretization, stages.equilibrate.damping)
        ),
        collapse=StageSetup(
            make_body(LAWS[own_law], case.material),
            make_settings(case, discretization, stages.collapse.damping),
            active_margin(discretization) if case.method.deactivate_base else 0,
        ),
    )


def active_margin(discretization: Discretization) -> int:
    """Tiles around the column in which the base stays active: as wide as the base is thick."""
    return math.ceil(discretization.base / discretization.h / TILE - ON_NODE)


def make_body(law: Any, material: Any) -> Body:
    """A law with the parameters of a material."""
    return Body(law, law.make_params(material), material.wave_speed**2)


def make_settings(case: Case, discretization: Discretization, damping: float) -> Settings:
    """The numbers of the method from the words of [method]."""
    method = case.method
    taylor, flip = TRANSFERS[method.transfer]
    return Settings(
        gravity_y=-case.geometry.gravity,
        alpha_d=damping,
        cfl=case.time.cfl,
        taylor=taylor,
        flip_fraction=flip * method.flip_fraction,
        position_factor=POSITION_FACTORS[method.position_update],
        wall_impulse=method.wall_impulse,
        opening_strain=method.opening_strain,
        kernel_correction=method.kernel_correction,
        axisymmetric=GEOMETRIES[discretization.shape].AXISYMMETRIC,
        axis_gap=axis_gap(case),
        open_low_sides=discretization.is_full,
        free_speed=free_speed(case.geometry.gravity, discretization.h_i + discretization.base),
        exponential_volume=method.volume_update == "exponential",
    )


def free_speed(gravity: float, height: float) -> float:
    """Speed that gravity can give to material that was at rest at most `height` above all else, m/s."""
    return FALL_MARGIN * math.sqrt(2.0 * gravity * height)


def fill(case: Case, discretization: Discretization) -> Points:
    """Points of the column, then of the base, on even lattices."""
    size, base, dy = discretization.point_size, case.base_material, discretization.h_i / discretization.rows
    column = _stack(discretization.column_section(), dy * (np.arange(discretization.rows) + 0.5))
    below = _stack(
        discretization.section(discretization.length),
        size * (np.arange(round(discretization.base / size)) + 0.5) - discretization.base,
    )
    points = Points(len(column) + len(below), discretization.dimension)
    points.x[:] = np.concatenate([column, below])
    points.kind[len(column) :] = BASE
    area = size ** (discretization.dimension - 1)
    sizes = np.where(points.kind == BASE, area * size, area * dy)
    points.V0[:] = GEOMETRIES[discretization.shape].volumes(sizes, points.x)
    points.m[:] = points.V0 * np.where(points.kind == BASE, base.density, case.material.density)
    return points


def _stack(places: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Points (n, d) at all heights `y` over all horizontal places (n, d - 1)."""
    x = np.repeat(places, len(y), axis=0)
    return np.insert(x, 1, np.tile(y, len(places)), axis=1)


def assign_k0(case: Case, discretization: Discretization, points: Points) -> None:
    """Geostatic stress: vertical from the weight above, horizontal K0 times it; the base carries the column, too."""
    gravity, ratio = case.geometry.gravity, case.stages.k0
    nu = case.base_material.poissons_ratio
    x, y, *z = points.x.T
    beyond = np.logical_or.reduce(
        GEOMETRIES[discretization.shape].gate((x, *z), discretization.r_i, discretization.depth)
    )
    is_base = points.kind == BASE
    load = np.where(beyond, 0.0, case.material.density * (discretization.h_i - np.maximum(y, 0.0)))
    vertical = -gravity * (load + np.where(is_base, case.base_material.density * -y, 0.0))
    horizontal = np.where(is_base, nu / (1.0 - nu), ratio) * vertical
    points.sigma = np.stack([horizontal, vertical, horizontal, *3 * [np.zeros_like(vertical)]], axis=1)


def close_walls(grid: Grid, discretization: Discretization, gate_opening: float) -> None:
    """Fix velocities: v = 0 at the floor, v normal to walls, axis, planes of symmetry and ends, and at the gate.

    Above the base the ends hold END_CELLS wide, so that grains that run ahead come to rest there. The gate holds all
    nodes at and beyond the column's surface above the base and above `gate_opening` (m, inf: none).
    """
    x, y, *z = node_coordinates(grid)
    slack = ON_NODE * discretization.h
    floor = y < -discretization.base + slack
    horizontal = (x, *z)
    sides = [(c < c.min() + slack) | (c > c.max() - slack) for c in horizontal]
    ends = [(abs(c) > discretization.length - END_CELLS * discretization.h - slack) & (y > slack) for c in horizontal]
    gate = GEOMETRIES[discretization.shape].gate(horizontal, discretization.r_i - slack, discretization.depth - slack)
    closed = (y > slack) & (y > gate_opening - slack)
    held = [floor | side | end | (surface & closed) for side, end, surface in zip(sides, ends, gate, strict=True)]
    set_fixed(grid, held[0], floor, *held[1:])
