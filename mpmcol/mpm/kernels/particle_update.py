"""Update of all points after the grid update, tile by tile: G2P, the stress, and P2G of the next step.

One pass over the points instead of two: they are read from memory once per step. P2G writes to other nodes than those
that G2P reads, since tiles share nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.boundary import Box, column_box
from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import device, make_unpack, phase, prange, variant
from mpmcol.mpm.kernels.interpolation import restore_columns
from mpmcol.mpm.kernels.stress import NO_FAULT, make_update_stress
from mpmcol.mpm.kernels.transfer import make_move_points, make_scatter_points
from mpmcol.mpm.lanes import LANES, RECORD_SIZE
from mpmcol.mpm.settings import PAPER, Scheme

# what is reported for each tile of points
SPEED, TRAVEL, WORK, LIMIT_WORK, FAULT, FILTER, SIDE_WORK, TILE_REPORT = range(8)


class Bodies(NamedTuple):
    """Parameters of the laws of column and base, and the squares of their wave speeds (m2/s2), Eq. 36."""

    column: np.ndarray  # (n_materials, n) those of each material of the column, in the order of PARAMS of its law
    base: Any
    c2_column: np.ndarray  # (n_materials,)
    c2_base: float


@cache
def make_update_points(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme = PAPER
) -> Callable[..., None]:
    """G2P, stress update and the next P2G, with the dimension, the laws of column and base and the scheme frozen in."""
    move_points, size = make_move_points(dimension, scheme.basis, scheme.affine), RECORD_SIZE[dimension]
    update_tile_stress = make_update_tile_stress(dimension, column_law, base_law, scheme)
    scatter_points = make_scatter_points(dimension, scheme.basis)
    affine, matrix_size = scheme.affine, dimension * LANES

    @phase
    @variant(dimension, column_law, base_law, *scheme)
    def update_points(
        rows,
        grid,
        next_grid,
        tiles,
        shares,
        settings,
        column,
        base,
        c2_column,
        c2_base,
        dt,
        side_rate,
        has_next,
        report,
    ):
        """Move all points, update their stress, and scatter them to the nodes of the next step if there is one.

        Tiles of one group in parallel, each node summed in a fixed order, as in P2G. Reads: nodes (v~, a) of `grid`.
        Writes: rows, nodes (m, mv, f, m q) of `next_grid`, report (n_tiles, 7). Eq. (13), (14), (19), (20), (26)-(34),
        and c_p + |v_p| of Eq. (35)-(36).
        """
        start, layers, cells, grouped = tiles.start, tiles.layers, tiles.cells, tiles.grouped
        box, everywhere = column_box(grid, settings), Box(-np.inf, np.inf, np.inf, -np.inf, np.inf)
        for group in range(len(shares)):
            for thread in prange(shares.shape[1] - 1):
                # A function for the body would count references to its arrays for every tile, 5 % of a step.
                for k in range(shares[group, thread], shares[group, thread + 1]):
                    t, following = grouped[k], start[grouped[min(k + 1, len(grouped) - 1)]]
                    first, stop = start[t], start[t + 1]
                    averages = np.empty(stop - first + LANES)
                    matrices = np.empty(matrix_size * (stop - first)) if affine else averages
                    report[t, TRAVEL], report[t, LIMIT_WORK] = move_points(
                        rows, first, stop, following, grid, settings, dt, averages, matrices
                    )
                    update_tile_stress(
                        rows, cells, layers[t], stop, column, base, c2_column, c2_base, settings, box, everywhere, dt,
                        averages, side_rate, report[t],
                    )  # fmt: skip
                    if affine:
                        for p in range(first, stop):
                            restore_columns(rows, p * size, dimension, matrices, matrix_size * (p - first))
                    if has_next:
                        scatter_points(rows, first, stop, first, next_grid, settings)  # they are in the caches now

    return update_points


def make_update_tile_stress(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., None]:
    """The stress update of the points of a tile, first those of each material of the column, then those of the base."""
    update_column = make_update_stress(dimension, column_law, scheme.volumetric_strain)
    update_base = make_update_stress(dimension, base_law, scheme.volumetric_strain)
    Params = column_law.PARAMS
    unpack = make_unpack(len(Params._fields))

    @device
    @variant(dimension, column_law, base_law, *scheme)
    def update_tile_stress(
        rows, cells, layers, stop, column, base, c2_column, c2_base, settings, box, everywhere, dt, averages, side_rate,
        report,
    ):  # fmt: skip
        """Update points to `stop`: those of material k of the column from layers[k], of the base from the last of them.

        averages: of the filtered stress at these points, Pa. side_rate: that of `slow_points`, s/m, for the column.
        Writes WORK, SPEED, FAULT, FILTER and SIDE_WORK of the report.
        """
        first, split = layers[0], layers[len(column)]
        work, speed, lost, side, fault = 0.0, 0.0, 0.0, 0.0, NO_FAULT
        for k in range(len(column)):
            work_k, speed_k, fault_k, lost_k, side_k = update_column(
                rows, cells, layers[k], layers[k + 1], Params(*unpack(column[k])), settings, box, c2_column[k], dt,
                averages[layers[k] - first :], side_rate,
            )  # fmt: skip
            work, speed, lost, side = work + work_k, max(speed, speed_k), lost + lost_k, side + side_k
            fault = fault if fault != NO_FAULT else fault_k
        base_work, base_speed, base_fault, base_lost, _ = update_base(
            rows, cells, split, stop, base, settings, everywhere, c2_base, dt, averages[split - first :], 0.0
        )
        report[WORK], report[SPEED], report[FILTER] = work + base_work, max(speed, base_speed), lost + base_lost
        report[SIDE_WORK], report[FAULT] = side, fault if fault != NO_FAULT else base_fault

    return update_tile_stress
