"""All that happens to a point after the grid update, tile by tile: G2P, stress, and a look at whether it is sound."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcol.mpm.boundary import Box, column_box, particle_limits
from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import device, phase, prange, variant
from mpmcol.mpm.kernels import stress_2d, stress_3d
from mpmcol.mpm.kernels.interpolation import keep_columns, make_sums, restore_columns
from mpmcol.mpm.kernels.transfer import make_transfer
from mpmcol.mpm.kernels.transfer_common import AHEAD, prefetch_record
from mpmcol.mpm.kernels.volumetric_averaging import make_excess
from mpmcol.mpm.lanes import RECORD_SIZE
from mpmcol.mpm.settings import PAPER, Scheme
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.simd import (
    LANES,
    any_positive,
    extract,
    load,
    maximum,
    reduce_max,
    reduce_sum,
    splat,
    vector,
    where_positive,
)

# what a tile of points reports
SPEED, TRAVEL, WORK, NODE_WORK, FAULT, TILE_REPORT = range(6)

NO_FAULT = -1.0
STRESSES = {2: stress_2d, 3: stress_3d}


def make_update_points(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme = PAPER
) -> Callable[..., None]:
    """G2P and stress, tile by tile, with the dimension, the laws of column and base and the scheme frozen in."""
    transfer = make_transfer(dimension, scheme.basis)
    gather, row = transfer.gather, transfer.RECORD_SIZE
    column_stress = make_update_stresses(dimension, column_law, scheme.volumetric_strain)
    base_stress = make_update_stresses(dimension, base_law, scheme.volumetric_strain)
    affine, kept = scheme.affine, dimension * LANES
    sums = make_sums(dimension, SHAPE_FUNCTIONS[scheme.basis], affine)

    @phase
    @variant(dimension, column_law, base_law, *scheme)
    def update_points(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, report):
        """Move all points and update their stress.

        Reads: nodes (v~, a). Writes: rows, report (n_tiles, 5). Eq. (26)-(34), and c_p + |v_p| of Eq. (35)-(36).
        """
        nodes, start, split, cells = grid.nodes, tiles.start, tiles.split, tiles.cells
        inside, anywhere = column_box(grid, settings), Box(-np.inf, np.inf, np.inf, -np.inf, np.inf)
        bounds, inv_h = particle_limits(grid, settings), 1.0 / grid.h
        for t in prange(len(split)):
            travel, node_work = splat(0.0), splat(0.0)
            if affine:  # the stress needs the velocity gradient in its lanes first
                matrix = np.empty(kept * (start[t + 1] - start[t]))
            for p in range(start[t], start[t + 1]):
                prefetch_record(rows, row, p + AHEAD)
                if affine:
                    _, x, y, z = sums(load(rows, p * row), nodes, grid, settings)
                    keep_columns(matrix, kept * (p - start[t]), dimension, x, y, z)
                step, taken = gather(rows, p * row, nodes, grid, settings, bounds, dt)
                travel, node_work = maximum(travel, abs(step)), node_work + taken
            report[t, TRAVEL] = inv_h * max(extract(travel, 4), extract(travel, 5), extract(travel, 6))
            report[t, NODE_WORK] = extract(node_work, 4) + extract(node_work, 5) + extract(node_work, 6)
            work, speed, fault = column_stress(rows, cells, start[t], split[t], column, settings, inside, c2_column, dt)
            base_work, base_speed, base_fault = base_stress(
                rows, cells, split[t], start[t + 1], base, settings, anywhere, c2_base, dt
            )
            report[t, WORK], report[t, SPEED] = work + base_work, max(speed, base_speed)
            report[t, FAULT] = fault if fault != NO_FAULT else base_fault
            if affine:
                for p in range(start[t], start[t + 1]):
                    restore_columns(rows, p * row, dimension, matrix, kept * (p - start[t]))

    return update_points


def make_update_stresses(dimension: int, law: ConstitutiveLaw, volumetric_strain: str) -> Callable[..., Any]:
    """The stress update of a range of points, eight at a time."""
    update_stress, row = STRESSES[dimension].make_update_stress(law), RECORD_SIZE[dimension]
    find_excess, averaged = make_excess(dimension), volumetric_strain == "cell"

    @device
    @variant(dimension, law, volumetric_strain)
    def update_stresses(rows, cells, first, stop, params, settings, box, c2, dt):
        """Returns the stress work (J), the largest c_p + |v_p| (m/s), the row of the first bad point or NO_FAULT."""
        work, speed, fault = splat(0.0), splat(0.0), NO_FAULT
        if averaged:
            beyond = np.empty(stop - first + LANES)
            find_excess(rows, cells, first, stop, beyond)
        for p in range(first, stop, LANES):
            count = min(stop - p, LANES)
            real = float(count) - vector(0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5)
            excess = load(beyond, p - first) if averaged else 0.0
            spent, fastest, sound = update_stress(rows, p * row, count, params, settings, box, c2, dt, excess)
            work = work + where_positive(real, spent, 0.0)
            speed = maximum(speed, where_positive(real, fastest, 0.0))
            bad = where_positive(real, 1.0 - sound, 0.0)
            if fault == NO_FAULT and any_positive(bad):
                fault = p + _first_positive(bad)
        return reduce_sum(work), reduce_max(speed), fault

    return update_stresses


@device
def _first_positive(value):
    """Number of the first lane above zero, as a real number."""
    first = vector(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)
    return -reduce_max(where_positive(value, -first, -float(LANES)))
