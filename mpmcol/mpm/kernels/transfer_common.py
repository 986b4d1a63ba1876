"""Parts of the transfers between points and grid that are the same for all shape functions and dimensions."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.boundary import WALL_GAP, keep_within, particle_limits
from mpmcol.mpm.grid import Grid
from mpmcol.mpm.jit import device
from mpmcol.mpm.lanes import L_ZZ, S_ZZ, V0, VX, X_VECTOR, Y_VECTOR, Z_VECTOR, J, M, X
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.shape_functions.quadratic import WIDTH, spline_lanes
from mpmcol.mpm.simd import extract, fma, load, prefetch, splat, spread, store, swap_halves, vector, where_positive
from mpmcol.mpm.wall_cells import beside_walls, fold_three, keep_out_of_walls

PREFETCH_DISTANCE = 24  # points processed in the time that memory takes to answer


@device
def prefetch_record(rows: np.ndarray, size: int, p: int) -> None:
    """Prefetch the record of point `p`, of `size` doubles."""
    o = p * size
    prefetch(rows, o)
    prefetch(rows, o + X_VECTOR)
    prefetch(rows, o + Y_VECTOR)
    if size > Z_VECTOR:
        prefetch(rows, o + Z_VECTOR)


@device
def prefetch_ahead(rows: np.ndarray, size: int, p: int, stop: int, following: int) -> None:
    """Prefetch the record PREFETCH_DISTANCE points after `p`; after those to `stop` come those from `following` on."""
    ahead = p + PREFETCH_DISTANCE
    prefetch_record(rows, size, ahead if ahead < stop else ahead + following - stop)


@device
def _coordinate_lanes(x: float, y: float, z: float, other: float) -> Any:
    """A vector with x, y, z in the lanes of the coordinates and `other` in the remaining lanes."""
    return vector(other, other, other, other, x, y, z, other)


@device
def grid_coordinates(record: Any, grid: Grid) -> tuple[Any, Any, Any]:
    """Grid coordinates of a point from vector 0 of its record, and `bottom` and `top` of `ShapeFunctions.evaluate`."""
    flat, far = grid.n_z == 1, np.inf
    s = (record - _coordinate_lanes(grid.origin_x, grid.origin_y, grid.origin_z, 0.0)) * (1.0 / grid.h)
    bottom = _coordinate_lanes(0.5, 0.5, -far if flat else 0.5, -far)
    return s, bottom, _coordinate_lanes(grid.n_x - 1.5, grid.n_y - 1.5, far if flat else grid.n_z - 1.5, far)


@device
def quadratic_stencil(
    record: Any, grid: Grid, settings: Settings
) -> tuple[bool, Any, Any, Any, Any, Any, Any, Any, Any]:
    """Stencil of a point from vector 0 of its record, in the lanes of its coordinates, Eq. (17)-(18).

    Returns whether the point may be beside a wall of `wall_cells`, grid coordinates, first nodes as real numbers, three
    weights and three gradients (times h).
    """
    s, bottom, top = grid_coordinates(record, grid)
    base, w0, w1, w2, g0, g1, g2 = spline_lanes(s, bottom, top, settings.kernel_correction)
    near, low, high = beside_walls(grid.wall_cells, s, base, WIDTH, settings.kernel_correction, grid)
    if near:
        w0, w1, w2 = fold_three(low, high, w0, w1, w2)
        g0, g1, g2 = fold_three(low, high, g0, g1, g2)
    return near, s, base, w0, w1, w2, g0, g1, g2


@device
def broadcast(value: Any, index: int) -> Any:
    """A vector with one lane of `value` in all lanes."""
    return splat(extract(value, index))


@device
def momentum_mask(d: int) -> Any:
    """One in the lanes of momentum (or velocity) of `d` dimensions, else zero."""
    return vector(0.0, 1.0, 1.0, d - 2, 0.0, 0.0, 0.0, 0.0)


@device
def force_mask(d: int) -> Any:
    """One in the lanes of force (or acceleration, or position) of `d` dimensions, else zero."""
    return swap_halves(momentum_mask(d))


@device
def unit_mass(d: int, settings: Settings) -> Any:
    """Mass and weight of a unit mass, in the lanes of a node."""
    return vector(1.0, 0.0, 0.0, 0.0, settings.gravity_x, settings.gravity_y, (d - 2) * settings.gravity_z, 0.0)


@device
def point_terms(rows: np.ndarray, o: int, d: int, unit: Any, q: Any, settings: Settings) -> tuple[Any, Any, Any]:
    """What the nodes receive from the point whose record starts at `o`, in their lanes, Eq. (13), (14), (19), (20).

    unit: see `unit_mass`. q: the stress that the filter averages, Pa. Returns mass, momentum at the point, weight (and
    the hoop stress of axisymmetry), to be multiplied by weights; and the factors of a column of the record in the terms
    with weights times distance and with gradients.
    """
    m, volume = spread(rows, o + M), spread(rows, o + J) * spread(rows, o + V0)
    momentum = momentum_mask(d)
    at_point = where_positive(momentum, load(rows, o), unit)
    if settings.filter_rate > 0.0:
        at_point = where_positive(vector(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), q, at_point)
    at_point = m * at_point
    # An `if` statement around array accesses would leave reference counting, a call per access, in the loop.
    hoop = rows[o + S_ZZ] / rows[o + X] if d == 2 and settings.axisymmetric else 0.0
    at_point = at_point - vector(0.0, 0.0, 0.0, 0.0, hoop, 0.0, 0.0, 0.0) * volume
    return at_point, (settings.taylor * m) * momentum, -volume * force_mask(d)


class PointUpdate(NamedTuple):
    """Factors of the update of all points in a step, by lane, and the limits of their positions."""

    kept: Any  # of vector 0
    mean: Any  # of the weighted sums of v~ and a
    swapped: Any  # of the same with v~ and a exchanged
    gravity: Any  # m/s2, in the lanes of the positions
    limits: Any  # see `particle_limits`


@device
def point_update(d: int, grid: Grid, settings: Settings, dt: float) -> PointUpdate:
    """The factors of Eq. (26)-(27) in a step, with the PIC counterpart of Eq. (26)."""
    share, momentum, position = settings.flip_fraction, momentum_mask(d), force_mask(d)
    return PointUpdate(
        where_positive(momentum, share, 1.0),
        (1.0 - share) * momentum - (settings.position_factor * dt * dt) * position,
        (share * dt) * momentum + dt * position,
        vector(0.0, 0.0, 0.0, 0.0, settings.gravity_x, settings.gravity_y, settings.gravity_z, 0.0),
        particle_limits(grid, settings),
    )


@device
def update_point(
    rows: np.ndarray,
    o: int,
    near: bool,
    mean: Any,
    gradient: tuple[Any, Any, Any],
    d: int,
    factors: PointUpdate,
    grid: Grid,
    settings: Settings,
) -> tuple[Any, Any]:
    """Write new velocity, position and velocity gradient of the point whose record starts at `o`, Eq. (26)-(28).

    near: whether it may be beside a wall. mean: weighted sums of v~ and a over its nodes. gradient: columns of the
    velocity gradient along x, y, z; in two dimensions the third is ignored. Returns two vectors with an axis per lane
    from X on: the displacement by Eq. (27), m, and, where limits or walls stop the point, the work of gravity (J),
    which is not part of the nodal balance.
    """
    old = load(rows, o)
    increment = fma(factors.swapped, swap_halves(mean), factors.mean * mean)
    free = fma(factors.kept, old, increment)
    new = keep_out_of_walls(grid.wall_cells, near, old, keep_within(free, factors.limits), WALL_GAP * grid.h, grid)
    l_zz = extract(mean, VX) / rows[o + X] if settings.axisymmetric else 0.0  # v_r / r at the old position
    limit_work = (spread(rows, o + M) * factors.gravity) * (new - free)
    store(rows, o, new)
    store_gradient(rows, o, d, *gradient)
    if d == 2:
        rows[o + L_ZZ] = l_zz
    return increment, limit_work


@device
def store_gradient(rows: np.ndarray, o: int, d: int, x: Any, y: Any, z: Any) -> None:
    """Write `d` columns of the velocity gradient (or of APIC's matrix) to the record that starts at `o`, Eq. (28)."""
    _store_column(rows, o + X_VECTOR, d, x)
    _store_column(rows, o + Y_VECTOR, d, y)
    if d == 3:
        _store_column(rows, o + Z_VECTOR, d, z)


@device
def _store_column(rows: np.ndarray, o: int, d: int, column: Any) -> None:
    store(rows, o, where_positive(momentum_mask(d), column, load(rows, o)))
