"""Boundary conditions: the table of their types, the nodes that they act on, and their action in the grid update.

A new type is a row of `TYPES` and, where it does more than hold velocity components, code in `constrain` or, for walls
with friction, in `mpmcol.mpm.contact`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal, NamedTuple

import numpy as np

from mpmcol.mpm.grid import Grid, grid_shape, node_blocks, padded_shape
from mpmcol.mpm.jit import device
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import vector, where_positive

# bits of a node's mask: components held by boundaries, those held because of inactive points, and whether the node has
# a row in the table of contacts
HELD_BITS, INACTIVE_BITS, CONTACT_BIT = 0b0000111, 0b0111000, 0b1000000
BOUNDARY_BITS = HELD_BITS | CONTACT_BIT

# Least distance of particles from a face, in h. Closer to a wall, and closer to the axis, a single particle would be
# stiffer than the default time step allows (`mpmcol.setup.stability_limit`).
WALL_GAP, AXIS_GAP = 0.1, 0.2


class BoundaryType(NamedTuple):
    """One row of the table of boundaries."""

    name: str
    holds: Literal["all", "normal", "none"]  # components of the nodal velocity; the rest is free or has friction
    gap: float = 0.0  # least distance of particles, in h
    zone_cells: int = 0  # cells in front of the face whose nodes are held above the base
    stop_cells: int = 0  # column points closer than this many cells stop the run


NO_SLIP = BoundaryType("no-slip floor", "all", WALL_GAP)
CONTACT = BoundaryType("wall with friction", "none", WALL_GAP)  # Coulomb friction; material may separate from it
ROLLER = BoundaryType("smooth wall", "normal", WALL_GAP)  # a smooth wall, or a plane of symmetry
AXIS = BoundaryType("axis", "normal", AXIS_GAP)
OPEN_END = BoundaryType("open end", "normal", WALL_GAP, zone_cells=4, stop_cells=2)  # the zone arrests single particles
FREE = BoundaryType("free", "none", WALL_GAP, stop_cells=2)  # the top of the domain
GATE = BoundaryType("gate", "normal")
WALL_INSIDE = BoundaryType("inside of a wall", "all")  # nodes that only points at its edges reach
INACTIVE = BoundaryType("inactive points", "all")  # set by `mpmcol.mpm.kernels.deactivation`
TYPES = (NO_SLIP, CONTACT, ROLLER, AXIS, OPEN_END, FREE, GATE, WALL_INSIDE, INACTIVE)

Faces = tuple[tuple[BoundaryType, BoundaryType], ...]  # of the domain: low and high face along each axis


class Boundary(NamedTuple):
    """A boundary of a case: its type, the axis of its normal (0 to 2), and the nodes that it acts on.

    A wall with a number has its impulse recorded, and must have one if it is a CONTACT.
    """

    type: BoundaryType
    axis: int
    nodes: np.ndarray  # boolean, broadcastable to (n_x, n_y[, n_z])
    side: int = 0  # 0: the wall is below its nodes along the axis, 1: above them
    wall: int | None = None  # number of the wall
    friction: float = 0.0  # coefficient of a CONTACT

    def held_axes(self, dimension: int) -> Iterable[int]:
        """Axes of the velocity components that are held."""
        return {"all": range(dimension), "normal": (self.axis,), "none": ()}[self.type.holds]


def face(grid: Grid, kind: BoundaryType, axis: int, side: int, cells: int = 0) -> Boundary:
    """A boundary on the low (side 0) or high (side 1) face of the domain and on the `cells` cells in front of it."""
    shape = grid_shape(grid)
    index = np.arange(shape[axis]).reshape([-1 if k == axis else 1 for k in range(len(shape))])
    return Boundary(kind, axis, (shape[axis] - 1 - index if side else index) <= cells, side)


def apply_boundaries(grid: Grid, boundaries: Iterable[Boundary]) -> None:
    """Hold the nodes of these boundaries and release all others; nodes beside inactive points stay held.

    Nodes of walls with a number are marked; they need a row in the solver's table (`mpmcol.mpm.contact`).
    """
    d, boundaries = len(grid_shape(grid)), tuple(boundaries)
    held = [(1 << axis, each.nodes) for each in boundaries for axis in each.held_axes(d)]
    _set_bits(grid, held + [(CONTACT_BIT, each.nodes) for each in boundaries if each.wall is not None])


def hold_components(grid: Grid, *masks: np.ndarray | bool) -> None:
    """Hold velocity components by one boolean mask per axis, each broadcastable to (n_x, n_y[, n_z]).

    All other components are released; nodes beside inactive points stay held.
    """
    _set_bits(grid, ((1 << axis, nodes) for axis, nodes in enumerate(masks)))


def _set_bits(grid: Grid, marked: Iterable[tuple[int, Any]]) -> None:
    bits, shape = np.zeros(padded_shape(grid), np.uint8), grid_shape(grid)
    for bit, nodes in marked:
        bits[tuple(slice(n) for n in shape)] |= np.broadcast_to(nodes, shape).astype(np.uint8) * np.uint8(bit)
    blocks = node_blocks(grid, grid.fixed)
    blocks[:] = bits.reshape(blocks.shape) | (blocks & INACTIVE_BITS)


def inactive_nodes(grid: Grid) -> np.ndarray:
    """Numbers of the nodes that are held because of inactive points."""
    return np.flatnonzero(grid.fixed & INACTIVE_BITS)


def set_inactive_nodes(grid: Grid, nodes: np.ndarray) -> None:
    """Hold exactly these nodes because of inactive points (all components), beside those that boundaries hold."""
    grid.fixed[:] &= BOUNDARY_BITS
    grid.fixed[nodes] |= INACTIVE_BITS


@device
def held_components(mask: Any) -> Any:
    """One in the lanes of the velocity components that a node's mask holds."""
    held = mask | mask >> 3
    return vector(0.0, held & 1, (held >> 1) & 1, (held >> 2) & 1, 0.0, 0.0, 0.0, 0.0)


@device
def reaction_factors(settings: Settings, dt: float) -> tuple[float, float]:
    """1 / dt and dt where the reaction of boundaries enters the acceleration (`wall_impulse`), zeros otherwise."""
    return (1.0 / dt, dt) if settings.wall_impulse else (0.0, 0.0)


@device
def constrain(mask: Any, v: Any, f: Any, a: Any, dt: float, factors: tuple[float, float]) -> tuple[Any, Any, Any, Any]:
    """Equation of motion of one node, subject to its boundaries, Eq. (22), (24).

    mask: what is held there. v: velocity (m/s) before the step. f, a: force per mass (m/s2) without and with damping.
    factors: `reaction_factors`. A held component has zero velocity after the step. With `wall_impulse` its acceleration
    is that which stops it, -v / dt, so that the particles receive the impulse of the boundary; without it is zero.

    Returns one in the lanes of held components, the velocity after the step, the acceleration that the particles
    receive, and twice the work done on the boundary per mass: kinetic energy of the arrested motion and work of the
    forces on it.
    """
    per_dt, reaction_dt = factors
    held = held_components(mask)
    v_after = where_positive(held, 0.0, v + dt * a)
    a_after = where_positive(held, v * -per_dt, a)
    work = where_positive(held, v * (v + reaction_dt * f), 0.0)
    return held, v_after, a_after, work


@device
def particle_limits(grid: Grid, settings: Settings) -> tuple[Any, Any]:
    """Least and largest position of particles in the lanes of the coordinates: the gap of each face inside it."""
    h, far, flat = grid.h, np.inf, grid.n_z == 1
    gap, low_gap = WALL_GAP * h, (settings.axis_gap if settings.axisymmetric else WALL_GAP) * h
    x, y, z = grid.origin_x, grid.origin_y, grid.origin_z
    x_end, y_end, z_end = x + (grid.n_x - 1) * h, y + (grid.n_y - 1) * h, z + (grid.n_z - 1) * h
    return (
        vector(-far, -far, -far, -far, x + low_gap, y + gap, -far if flat else z + gap, -far),
        vector(far, far, far, far, x_end - gap, y_end - gap, far if flat else z_end - gap, far),
    )


@device
def keep_within(record: Any, limits: tuple[Any, Any]) -> Any:
    """A vector with position lanes, whose positions are moved to the nearer limit where they exceed it."""
    moved = where_positive(limits[0] - record, limits[0], record)
    return where_positive(moved - limits[1], limits[1], moved)


class Box(NamedTuple):
    """Limits of the positions of valid points, m."""

    x_low: float
    x_high: float
    y_high: float
    z_low: float
    z_high: float


STOP_CELLS = OPEN_END.stop_cells


@device
def column_box(grid: Grid, settings: Settings) -> Box:
    """Limits of the column: STOP_CELLS from the open ends and from the top of the domain."""
    edge, far = STOP_CELLS * grid.h, np.inf
    return Box(
        grid.origin_x + edge if settings.open_low_sides else -far,
        grid.origin_x + (grid.n_x - 1) * grid.h - edge,
        grid.origin_y + (grid.n_y - 1) * grid.h - edge,
        grid.origin_z + edge if settings.open_low_sides else -far,
        grid.origin_z + (grid.n_z - 1) * grid.h - edge,
    )
