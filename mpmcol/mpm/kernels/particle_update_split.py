"""G2P and the stress update as phases of their own, for steps that update the stress with other nodal velocities.

P2G needs the velocity gradient (or the affine matrix) of G2P, the stress that of its own nodal velocities: this one
takes the lanes of L while a tile's stress is updated, and the other stands aside.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mpmcol.mpm.boundary import Box, column_box, particle_limits
from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import phase, prange, variant
from mpmcol.mpm.kernels.interpolation import keep_columns, make_sums, restore_columns, set_columns
from mpmcol.mpm.kernels.particle_update import (
    FAULT,
    NO_FAULT,
    NODE_WORK,
    SPEED,
    TRAVEL,
    WORK,
    make_update_stresses,
)
from mpmcol.mpm.kernels.transfer import make_transfer
from mpmcol.mpm.kernels.transfer_common import AHEAD, forces, prefetch_record
from mpmcol.mpm.lanes import L_ZZ, RECORD_SIZE, X
from mpmcol.mpm.settings import Scheme
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.simd import LANES, extract, load, maximum, splat, store, where_positive


def make_move(dimension: int, scheme: Scheme) -> Callable[..., None]:
    """G2P without stress."""
    transfer = make_transfer(dimension, scheme.basis)
    gather, row = transfer.gather, transfer.RECORD_SIZE
    affine, waits = scheme.affine, scheme.stress_order == "musl"
    sums = make_sums(dimension, SHAPE_FUNCTIONS[scheme.basis], affine)

    @phase
    @variant(dimension, *scheme)
    def move(rows, grid, tiles, settings, dt, moved, report):
        """Move all points; with MUSL they stay where they are for now, and `moved` (n, 8) has their new first rows.

        Reads: nodes (v~, a). Writes: rows, moved, report (n_tiles, 5). Eq. (26)-(28).
        """
        nodes, start, bounds, inv_h = grid.nodes, tiles.start, particle_limits(grid, settings), 1.0 / grid.h
        for t in prange(len(start) - 1):
            travel, node_work = splat(0.0), splat(0.0)
            for p in range(start[t], start[t + 1]):
                prefetch_record(rows, row, p + AHEAD)
                o, old = p * row, load(rows, p * row)
                if affine:
                    _, x, y, z = sums(old, nodes, grid, settings)
                step, taken = gather(rows, o, nodes, grid, settings, bounds, dt)
                if affine:
                    set_columns(rows, o, dimension, x, y, z)
                if waits:
                    new = load(rows, o)
                    store(moved, p * LANES, new)
                    store(rows, o, where_positive(forces(3), old, new))
                travel, node_work = maximum(travel, abs(step)), node_work + taken
            report[t, TRAVEL] = inv_h * max(extract(travel, 4), extract(travel, 5), extract(travel, 6))
            report[t, NODE_WORK] = extract(node_work, 4) + extract(node_work, 5) + extract(node_work, 6)

    return move


def make_strain(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., None]:
    """The stress update with the gradient of the present nodal velocities."""
    column_stress = make_update_stresses(dimension, column_law, scheme.volumetric_strain)
    base_stress = make_update_stresses(dimension, base_law, scheme.volumetric_strain)
    sums, row, kept = (
        make_sums(dimension, SHAPE_FUNCTIONS[scheme.basis], False),
        RECORD_SIZE[dimension],
        dimension * LANES,
    )
    waits, flat = scheme.stress_order == "musl", dimension == 2

    @phase
    @variant(dimension, column_law, base_law, *scheme)
    def strain(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, moved, report):
        """Update the stress of all points and leave them their gradient; with MUSL they then go where `moved` says.

        Reads: nodes (v), moved. Writes: rows, report (n_tiles, 5). Eq. (28)-(34), and c_p + |v_p| of Eq. (35)-(36).
        """
        nodes, start, split, cells = grid.nodes, tiles.start, tiles.split, tiles.cells
        inside, anywhere = column_box(grid, settings), Box(-np.inf, np.inf, np.inf, -np.inf, np.inf)
        for t in prange(len(split)):
            matrix = np.empty(kept * (start[t + 1] - start[t]))
            for p in range(start[t], start[t + 1]):
                prefetch_record(rows, row, p + AHEAD)
                o, at = p * row, kept * (p - start[t])
                rows_z = load(rows, o + LANES) if flat else load(rows, o + 3 * LANES)
                keep_columns(matrix, at, dimension, load(rows, o + LANES), load(rows, o + 2 * LANES), rows_z)
                mean, x, y, z = sums(load(rows, o), nodes, grid, settings)
                set_columns(rows, o, dimension, x, y, z)
                if flat:
                    rows[o + L_ZZ] = extract(mean, 1) / rows[o + X] if settings.axisymmetric else 0.0
            work, speed, fault = column_stress(rows, cells, start[t], split[t], column, settings, inside, c2_column, dt)
            base_work, base_speed, base_fault = base_stress(
                rows, cells, split[t], start[t + 1], base, settings, anywhere, c2_base, dt
            )
            report[t, WORK], report[t, SPEED] = work + base_work, max(speed, base_speed)
            report[t, FAULT] = fault if fault != NO_FAULT else base_fault
            for p in range(start[t], start[t + 1]):
                restore_columns(rows, p * row, dimension, matrix, kept * (p - start[t]))
                if flat:
                    rows[p * row + L_ZZ] = matrix[kept * (p - start[t]) + L_ZZ - LANES]
                if waits:
                    store(rows, p * row, load(moved, p * LANES))

    return strain
