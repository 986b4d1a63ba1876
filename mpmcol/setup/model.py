"""The model of a case: points, grid, boundaries, and the laws and parameters of each stage."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcol.case import Case
from mpmcol.mpm.boundary import AXIS, CONTACT, GATE, Boundary, apply_boundaries, face
from mpmcol.mpm.constitutive import LAWS, elastic
from mpmcol.mpm.contact import Contacts, make_contacts
from mpmcol.mpm.grid import TILE, Grid, allocate_grid, node_coordinates
from mpmcol.mpm.particles import BASE, COLUMN, LAYER, Points
from mpmcol.mpm.settings import Scheme, Settings
from mpmcol.mpm.solver import Body, Solver
from mpmcol.mpm.wall_cells import with_walls
from mpmcol.setup.discretization import Discretization, discretize, stack
from mpmcol.setup.geometry import VERTICAL, Coordinates
from mpmcol.setup.memory import require_memory_for
from mpmcol.setup.stability_limit import TRANSFER_COEFFICIENTS
from mpmcol.setup.time_step import axis_gap
from mpmcol.setup.wall_boxes import cells_in_walls, nodes_of_walls, wall_boundaries
from mpmcol.setup.walls import FACES, GATE_WALL, as_wall, side_friction

POSITION_FACTORS = {"trapezoid": 0.5, "paper": 1.0, "end": 0.0}
FALL_MARGIN = 2.0  # particles ejected by others are faster than free fall
FLOW_SHEAR_RATE = 0.3  # of g / c, the strain rate that the filter itself causes at walls and surfaces
FILTER_OPENING = 0.01  # opening strain of points that the stress filter no longer changes
GATE_REACH = 3.0  # in h: distance beyond the gate that points before it can reach
ON_NODE = 1e-6  # in h: tolerance for a node to lie on an edge


@dataclass(frozen=True)
class StageSetup:
    """What differs between stages: law of the column and its layers, method, and extent of the active base."""

    column: Body
    layers: tuple[Body, ...]
    settings: Settings
    margin: int = 0  # tiles around the column beyond which the base is inactive; 0: all of it is active


@dataclass(frozen=True)
class Model:
    """Initial state of a run: discretization, arrays, laws, and both stages."""

    discretization: Discretization
    points: Points
    grid: Grid
    contacts: Contacts
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
    """Allocate and fill all arrays of a case, with the gate closed if there is one.

    Raises UnfitCase if the arrays do not fit into memory or the domain is too small.
    """
    discretization = discretize(case)
    require_memory_for(discretization)
    points = make_points(case, discretization)
    if case.stages.initial_stress == "k0":
        assign_k0(case, discretization, points)
    grid = make_grid(discretization)
    set_boundaries(grid, discretization, initial_gate_opening(case))
    law, stages = LAWS[case.material.law], case.stages
    first_law = elastic if stages.equilibrate.law == "elastic" else law
    return Model(
        discretization=discretization,
        points=points,
        grid=grid,
        contacts=make_contacts(grid, make_boundaries(grid, discretization, gate_opening=0.0), side_friction(case)),
        scheme=Scheme(
            stress_order=case.method.stress_order,
            affine=case.method.transfer == "apic",
            basis=case.method.basis,
            volumetric_strain=case.method.volumetric_strain,
        ),
        base=make_body(LAWS[case.base_material.law], case.base_material),
        equilibrate=StageSetup(
            *column_bodies(first_law, case), make_settings(case, discretization, stages.equilibrate.damping)
        ),
        collapse=StageSetup(
            *column_bodies(law, case),
            make_settings(case, discretization, stages.collapse.damping),
            active_margin(discretization) if case.method.deactivate_base else 0,
        ),
    )


def make_grid(discretization: Discretization) -> Grid:
    """The grid of a case, with its walls."""
    grid = allocate_grid(discretization.origin, discretization.h, discretization.cells)
    boxes = discretization.wall_boxes
    return with_walls(grid, cells_in_walls(grid, boxes)) if boxes else grid


def make_solver(model: Model, stage: StageSetup) -> Solver:
    """The solver of a model at the beginning of a stage."""
    return Solver(
        model.points, model.grid, stage.settings, stage.column, model.base, model.scheme, model.contacts, stage.layers
    )


def initial_gate_opening(case: Case) -> float:
    """Opening of the gate before the release, m; inf without a gate."""
    return 0.0 if case.stages.gate else math.inf


def set_boundaries(grid: Grid, discretization: Discretization, gate_opening: float) -> None:
    """Apply all boundaries of a case to its grid, with the gate open up to `gate_opening` (m; inf: no gate)."""
    apply_boundaries(grid, make_boundaries(grid, discretization, gate_opening))


def make_boundaries(grid: Grid, discretization: Discretization, gate_opening: float) -> Iterator[Boundary]:
    """The faces of the domain, the zones of open ends above the base, the gate above the base and its opening, walls.

    The gate holds the nodes at and beyond the initial surface of the column. On a floor with slip, zones and gate
    include its nodes. Forces on nodes of both gate and a wall are those of the wall.
    """
    tolerance, walls = ON_NODE * discretization.h, discretization.walls
    x, y, *z = node_coordinates(grid)
    above_base = y > (-tolerance if discretization.faces[VERTICAL][0] == CONTACT else tolerance)
    for axis, (low, high) in enumerate(discretization.faces):
        for side, kind in enumerate((low, high)):
            yield as_wall(face(grid, kind, axis, side), FACES.get((axis, side), ""), walls)
            if kind.zone_cells:
                zone = face(grid, kind, axis, side, kind.zone_cells)
                yield zone._replace(nodes=zone.nodes & above_base)
    closed = above_base & (y > gate_opening - tolerance)
    horizontal_axes = [axis for axis in range(discretization.dimension) if axis != VERTICAL]
    beyond = discretization.beyond_column((x, y, *z), tolerance)
    far = discretization.beyond_column((x, y, *z), -GATE_REACH * discretization.h)
    for axis, nodes, out_of_reach in zip(horizontal_axes, beyond, far, strict=True):
        yield Boundary(GATE, axis, nodes & closed)
        recorded = nodes & closed & ~out_of_reach & ~nodes_of_walls(grid, discretization.wall_boxes)
        yield as_wall(Boundary(GATE, axis, recorded), GATE_WALL, walls)
    for box in discretization.wall_boxes:
        for boundary in wall_boundaries(grid, box):
            yield as_wall(boundary, box.name, walls)


def active_margin(discretization: Discretization) -> int:
    """Tiles around the column in which the base stays active: as wide as the base is thick."""
    return math.ceil(discretization.base / discretization.h / TILE - ON_NODE)


def column_bodies(law: Any, case: Case) -> tuple[Body, tuple[Body, ...]]:
    """The column and its layers, with this law."""
    return make_body(law, case.material), tuple(make_body(law, layer.material) for layer in case.layers)


def make_body(law: Any, material: Any) -> Body:
    """A law with the parameters of a material."""
    return Body(law, law.make_params(material), material.wave_speed**2)


def make_settings(case: Case, discretization: Discretization, damping: float) -> Settings:
    """Parameters of the method from the keys of [method], for a stage with this damping."""
    method, (gravity_x, gravity_y, gravity_z) = case.method, case.geometry.gravity_vector
    taylor, flip = TRANSFER_COEFFICIENTS[method.transfer]
    return Settings(
        gravity_x=gravity_x,
        gravity_y=gravity_y,
        gravity_z=gravity_z,
        alpha_d=damping,
        cfl=case.time.cfl,
        taylor=taylor,
        flip_fraction=flip * method.flip_fraction,
        position_factor=POSITION_FACTORS[method.position_update],
        wall_impulse=method.wall_impulse,
        opening_strain=method.opening_strain,
        kernel_correction=method.kernel_correction,
        axisymmetric=discretization.faces[0][0] == AXIS,
        axis_gap=axis_gap(case),
        open_low_sides=discretization.is_full,
        free_speed=free_speed(case.geometry.gravity, largest_drop(case, discretization)),
        exponential_volume=method.volume_update == "exponential",
        **(stress_filter_settings(case, discretization) if method.stress_filter == "flow" else {}),
    )


def stress_filter_settings(case: Case, discretization: Discretization) -> dict[str, float]:
    """Parameters of the stress filter (`mpmcol.mpm.kernels.stress_filter`) from the case."""
    return {
        "filter_rate": case.method.filter_strength * case.material.wave_speed / discretization.h,
        "filter_shear_rate": FLOW_SHEAR_RATE * case.geometry.gravity / case.material.wave_speed,
        "filter_opening": FILTER_OPENING,
        "filter_modulus": case.material.bulk_modulus,
    }


def free_speed(gravity: float, height: float) -> float:
    """Speed limit, m/s, of material that falls at most `height`: points faster than it and their waves are invalid."""
    return FALL_MARGIN * math.sqrt(2.0 * gravity * height)


def largest_drop(case: Case, discretization: Discretization) -> float:
    """Height that material can fall, from the top of the column to the lowest corner of the domain, m."""
    slope, length = math.radians(case.geometry.slope_deg), discretization.cells[0] * discretization.h
    return (discretization.h_i + discretization.base) * math.cos(slope) + length * math.sin(slope)


def make_points(case: Case, discretization: Discretization) -> Points:
    """Points of the column, followed by those of the base, on regular lattices.

    Raises UnfitCase if parts of the outline of the column are too thin for the points.
    """
    size, base, dy = discretization.point_size, discretization.base, discretization.row_height
    column, shares = _column_points(discretization)
    below = stack(discretization.lattice(discretization.length), size * (np.arange(round(base / size)) + 0.5) - base)
    below = below[~discretization.in_walls(below)]
    points = Points(len(column) + len(below), discretization.dimension)
    points.x[:] = np.concatenate([column, below])
    points.kind[len(column) :] = BASE
    layers = discretization.layers_at(column[:, 1])
    points.kind[: len(column)] = np.where(layers > 0, LAYER - 1 + layers, COLUMN)
    area = size ** (discretization.dimension - 1)
    sizes = np.where(points.kind == BASE, area * size, area * dy)
    points.V0[:] = discretization.geometry.volumes(sizes, points.x)
    points.V0[: len(column)] *= shares
    points.m[:] = points.V0 * np.array([material.density for material in case.materials])[points.kind.astype(np.intp)]
    for kind, material in enumerate(case.materials):
        own = points.kind == kind
        points.history[own] = material.initial_history(points.x[own])
    return points


def _column_points(discretization: Discretization) -> tuple[np.ndarray, np.ndarray | float]:
    """Positions of the points of the column, (n, d), m, and their volumes over those of their cells, (n,) or 1."""
    lattice = discretization.column_lattice()
    if discretization.outline is None:
        return lattice, 1.0
    shares = discretization.outline_shares().reshape(-1)
    return lattice[shares > 0.0], shares[shares > 0.0]


def assign_k0(case: Case, discretization: Discretization, points: Points) -> None:
    """Geostatic stress: vertical from the weight above, horizontal K0 times that; the base also carries the column.

    In an elastic base, K0 = nu / (1 - nu) of confined linear elasticity. On a slope these are the stresses normal to
    the base and along it. The equilibration adds those that carry the weight along the slope, which the gate and the
    shear stress at the base share.
    """
    gravity, ratio = case.geometry.normal_gravity, case.stages.k0
    nu = case.base_material.poissons_ratio
    base_ratio = ratio if case.geometry.base == "granular" else nu / (1.0 - nu)
    x, y, *z = points.x.T
    is_base = points.kind == BASE
    load = mass_above(case, discretization, (x, *z), y)
    vertical = -gravity * (load + np.where(is_base, case.base_material.density * -y, 0.0))
    horizontal = np.where(is_base, base_ratio, ratio) * vertical
    points.sigma = np.stack([horizontal, vertical, horizontal, *3 * [np.zeros_like(vertical)]], axis=1)


def mass_above(case: Case, discretization: Discretization, horizontal: Coordinates, y: np.ndarray) -> np.ndarray:
    """Mass of the column per area above positions, kg/m2: that of its material, and what the layers differ by."""
    mass = case.material.density * discretization.material_above(horizontal, y)
    for layer in case.layers:
        above = [discretization.material_above(horizontal, np.maximum(y, end)) for end in (layer.from_, layer.to)]
        mass += (layer.material.density - case.material.density) * (above[0] - np.maximum(above[1], 0.0))
    return mass
