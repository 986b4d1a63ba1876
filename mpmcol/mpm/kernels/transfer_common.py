"""Parts of the transfers between points and grid that are the same for all shape functions and dimensions."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.mpm.boundary import WALL_GAP, keep_within
from mpmcol.mpm.grid import Grid
from mpmcol.mpm.jit import device
from mpmcol.mpm.lanes import AX, L_ZZ, LANES, S_ZZ, V0, VX, X_VECTOR, Y_VECTOR, Z_VECTOR, J, M, Q, X
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.shape_functions.quadratic import WIDTH, spline_lanes
from mpmcol.mpm.simd import extract, fma, load, prefetch, splat, store, swap_halves, vector, where_positive
from mpmcol.mpm.wall_cells import beside_walls, fold_three, keep_out_of_walls

PREFETCH_DISTANCE = 24  # points processed in the time that memory takes to answer


@device
def prefetch_record(rows: np.ndarray, size: int, p: int) -> None:
    """Prefetch the record of point `p`, of `size` doubles."""
    for o in range(p * size, (p + 1) * size, LANES):
        prefetch(rows, o)


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
def update_point(
    rows: np.ndarray,
    o: int,
    near: bool,
    old: Any,
    mean: Any,
    gradient: Any,
    d: int,
    limits: Any,
    grid: Grid,
    settings: Settings,
    dt: float,
) -> tuple[Any, Any, float]:
    """Write new velocity, position and velocity gradient of the point whose record starts at `o`, Eq. (26)-(28).

    near: whether it may be beside a wall. old: vector 0 of its record. mean: weighted sums of v~ and a over its nodes.
    gradient: columns of the velocity gradient along x, y, z; in two dimensions the third is ignored. limits: see
    `update_motion`. Returns two vectors with an axis per lane from X on: the displacement (m), and the work (J) of the
    old stress on the motion of the nodes, plus that of gravity where the limits stop the point; and the average of the
    filtered stress (Pa).
    """
    grad_x, grad_y, grad_z = gradient
    work = incremental_work(load(rows, o + X_VECTOR), grad_x, dt) + incremental_work(
        load(rows, o + Y_VECTOR), grad_y, dt
    )
    l_zz = 0.0
    if d == 3:
        work = work + incremental_work(load(rows, o + Z_VECTOR), grad_z, dt)
    elif settings.axisymmetric:  # v_r / r at the old position
        l_zz = extract(mean, VX) / rows[o + X]
        hoop_work = (l_zz - 0.5 * dt * extract(mean, AX) / rows[o + X]) * rows[o + S_ZZ]
        work = work + vector(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, hoop_work, 0.0)
    work = (dt * rows[o + J] * rows[o + V0]) * work
    new, displacement, limit_work = update_motion(near, old, mean, d, limits, grid, settings, dt)
    store(rows, o, new)
    store_gradient(rows, o, d, grad_x, grad_y, grad_z)
    if d == 2:
        rows[o + L_ZZ] = l_zz
    return displacement, work + limit_work, extract(mean, Q)


@device
def update_motion(
    near: bool, old: Any, mean: Any, d: int, limits: Any, grid: Grid, settings: Settings, dt: float
) -> tuple[Any, Any, Any]:
    """New velocity and position of a point, Eq. (26)-(27).

    near, old, mean: see `update_point`. limits: smallest and largest position. Returns the new vector 0; the
    displacement (m) and, where limits or walls stop the point, the work of gravity (J), which is not part of the nodal
    balance, with an axis per lane from X on.
    """
    share, swapped = settings.flip_fraction, swap_halves(mean)
    # Eq. 26 and its PIC counterpart
    kept = where_positive(momentum_mask(d), share, 1.0)
    increment = fma(momentum_mask(d) * (1.0 - share), mean, momentum_mask(d) * (share * dt) * swapped)
    # Eq. 27
    displacement = fma(force_mask(d) * (-settings.position_factor * dt * dt), mean, force_mask(d) * dt * swapped)
    free = fma(old, kept, increment + displacement)
    new = keep_out_of_walls(grid.wall_cells, near, old, keep_within(free, limits), WALL_GAP * grid.h, grid)
    gravity = vector(0.0, 0.0, 0.0, 0.0, settings.gravity_x, settings.gravity_y, settings.gravity_z, 0.0)
    return new, displacement, extract(old, M) * (gravity * (new - free))


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


@device
def incremental_work(column: Any, gradient: Any, dt: float) -> Any:
    """Column of sigma times column of grad(v + v~) / 2; the sum over lanes X, Y, Z is the stress power per volume."""
    return column * fma(splat(-0.5 * dt), gradient, swap_halves(gradient))
