"""What the transfers between points and grid share in two and three dimensions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcol.mpm.boundary import keep_within
from mpmcol.mpm.grid import Grid, Tiles
from mpmcol.mpm.jit import device, phase, prange, variant
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.shape_functions.quadratic import spline_lanes
from mpmcol.mpm.simd import LANES, extract, fma, load, prefetch, splat, store, swap_halves, vector, where_positive

AHEAD = 24  # points: memory answers in the time that so many take


def make_p2g(transfer: Any) -> Callable[..., None]:
    """P2G over all points, with a stencil (`transfer_any.make_transfer`) frozen in."""
    scatter, row = transfer.scatter, transfer.RECORD_SIZE

    @phase
    @variant(transfer)
    def p2g(rows: np.ndarray, grid: Grid, tiles: Tiles, settings: Settings) -> None:
        """Scatter mass, momentum and force, tiles of one group in parallel, each node summed in a fixed order.

        Reads: rows. Writes: nodes (m, mv, f). Eq. (13), (14), (19), (20).
        """
        nodes, start, grouped, group_start = grid.nodes, tiles.start, tiles.grouped, tiles.group_start
        for group in range(len(group_start) - 1):
            for k in prange(group_start[group], group_start[group + 1]):
                tile, following = grouped[k], grouped[min(k + 1, len(grouped) - 1)]
                stop = start[tile + 1]
                jump = start[following] - stop
                for p in range(start[tile], stop):
                    soon = p + AHEAD
                    prefetch_record(rows, row, soon if soon < stop else soon + jump)
                    scatter(rows, p * row, nodes, grid, settings)

    return p2g


@device
def prefetch_record(rows: np.ndarray, row: int, p: int) -> None:
    """Ask for the record of point `p`, of `row` doubles."""
    for o in range(p * row, (p + 1) * row, LANES):
        prefetch(rows, o)


@device
def _on_axes(x: float, y: float, z: float, elsewhere: float) -> Any:
    """Numbers in the lanes of the coordinates, and another in all other lanes."""
    return vector(elsewhere, elsewhere, elsewhere, elsewhere, x, y, z, elsewhere)


@device
def places(record: Any, grid: Grid) -> tuple[Any, Any, Any]:
    """Grid coordinates of the point whose record starts with this row, and `bottom` and `top` of every basis."""
    flat, far = grid.n_z == 1, np.inf
    s = (record - _on_axes(grid.origin_x, grid.origin_y, grid.origin_z, 0.0)) * (1.0 / grid.h)
    bottom = _on_axes(0.5, 0.5, -far if flat else 0.5, -far)
    return s, bottom, _on_axes(grid.n_x - 1.5, grid.n_y - 1.5, far if flat else grid.n_z - 1.5, far)


@device
def stencil(record: Any, grid: Grid, settings: Settings) -> tuple[Any, Any, Any, Any, Any, Any, Any, Any]:
    """Stencil of the point whose record starts with this row, in the lanes of its coordinates, Eq. (17)-(18).

    Returns grid coordinates, first nodes as real numbers, three weights and three gradients (times h).
    """
    s, bottom, top = places(record, grid)
    base, w0, w1, w2, g0, g1, g2 = spline_lanes(s, bottom, top, settings.kernel_correction)
    return s, base, w0, w1, w2, g0, g1, g2


@device
def spread(value: Any, index: int) -> Any:
    """One lane in all lanes."""
    return splat(extract(value, index))


@device
def momenta(d: int) -> Any:
    """One in the lanes of momentum of `d` dimensions."""
    return vector(0.0, 1.0, 1.0, d - 2, 0.0, 0.0, 0.0, 0.0)


@device
def forces(d: int) -> Any:
    """One in the lanes of force of `d` dimensions."""
    return swap_halves(momenta(d))


@device
def move(record: Any, mean: Any, d: int, limits: Any, settings: Settings, dt: float) -> tuple[Any, Any, Any]:
    """New first row of a point's record, Eq. (26)-(27); in lanes 4 to 6 its displacement, and gravity's work (J) on it
    where the limits hold it, which the nodes know nothing of.

    record: the old row. mean: weighted sums of v~ and a over the nodes of `d` dimensions. limits: least and largest
    position in lanes 4 to 6.
    """
    share, swapped = settings.flip_fraction, swap_halves(mean)
    # Eq. 26 and its PIC counterpart
    kept = where_positive(momenta(d), share, 1.0)
    speed_up = fma(momenta(d) * (1.0 - share), mean, momenta(d) * (share * dt) * swapped)
    # Eq. 27
    step = fma(forces(d) * (-settings.position_factor * dt * dt), mean, forces(d) * dt * swapped)
    moved = fma(record, kept, speed_up + step)
    held = keep_within(moved, limits)
    pull = vector(0.0, 0.0, 0.0, 0.0, settings.gravity_x, settings.gravity_y, settings.gravity_z, 0.0)
    return held, step, extract(record, 0) * (pull * (held - moved))


@device
def store_column(rows: np.ndarray, o: int, d: int, gradient: Any) -> None:
    """Write a column of the velocity gradient into the row of lanes at `o`, Eq. (28)."""
    store(rows, o, where_positive(momenta(d), gradient, load(rows, o)))


@device
def power(row: Any, gradient: Any, dt: float) -> Any:
    """Column of sigma times column of grad(v + v~) / 2, summed over lanes 4 to 6 the work on the nodes in this step."""
    return row * fma(splat(-0.5 * dt), gradient, swap_halves(gradient))
