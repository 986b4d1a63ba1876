"""G2P and the stress update as separate phases, for schemes that update the stress with other nodal velocities.

P2G needs the velocity gradient (or APIC's matrix) of G2P, the stress update that of its own nodal velocities. The
latter occupies the lanes of L while the stress of a tile is updated; the former is saved and then restored.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from mpmcol.mpm.boundary import Box, column_box
from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import phase, prange, variant
from mpmcol.mpm.kernels.interpolation import make_interpolate, restore_columns, save_columns
from mpmcol.mpm.kernels.particle_update import LIMIT_WORK, TRAVEL, make_update_tile_stress
from mpmcol.mpm.kernels.transfer import make_move_points
from mpmcol.mpm.kernels.transfer_common import PREFETCH_DISTANCE, force_mask, prefetch_record, store_gradient
from mpmcol.mpm.lanes import L_ZZ, LANES, RECORD_SIZE, VX, X_VECTOR, Y_VECTOR, Z_VECTOR, Q, X
from mpmcol.mpm.settings import Scheme
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.simd import extract, load, store, where_positive


@cache
def make_g2p(dimension: int, scheme: Scheme) -> Callable[..., None]:
    """G2P over all points, without the stress update."""
    move_points = make_move_points(dimension, scheme.basis, scheme.affine)
    affine, is_musl = scheme.affine, scheme.stress_order == "musl"
    size, matrix_size = RECORD_SIZE[dimension], dimension * LANES

    @phase
    @variant(dimension, *scheme)
    def g2p(rows, grid, tiles, settings, dt, pending, report):
        """Move all points. With MUSL they keep their positions for now; `pending` (n, 8) receives the new vectors 0.

        Reads: nodes (v~, a). Writes: rows, pending, report (n_tiles, 7). Eq. (26)-(28).
        """
        start = tiles.start
        for t in prange(len(start) - 1):
            first, stop = start[t], start[t + 1]
            averages = np.empty(stop - first)
            matrices = np.empty(matrix_size * (stop - first)) if affine else averages
            if is_musl:
                for p in range(first, stop):
                    store(pending, p * LANES, load(rows, p * size))
            report[t, TRAVEL], report[t, LIMIT_WORK] = move_points(
                rows, first, stop, stop, grid, settings, dt, averages, matrices
            )
            for p in range(first, stop):
                if affine:
                    restore_columns(rows, p * size, dimension, matrices, matrix_size * (p - first))
                if is_musl:
                    old, new = load(pending, p * LANES), load(rows, p * size)
                    store(pending, p * LANES, new)
                    store(rows, p * size, where_positive(force_mask(3), old, new))

    return g2p


@cache
def make_update_stresses(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., None]:
    """The stress update of all points with the gradient of the present nodal velocities."""
    update_tile_stress = make_update_tile_stress(dimension, column_law, base_law, scheme)
    interpolate = make_interpolate(dimension, SHAPE_FUNCTIONS[scheme.basis], affine=False)
    size, matrix_size = RECORD_SIZE[dimension], dimension * LANES
    is_musl, flat = scheme.stress_order == "musl", dimension == 2

    @phase
    @variant(dimension, column_law, base_law, *scheme)
    def update_stresses(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, side_rate, pending, report):
        """Update the stress of all points, whose own gradient is unchanged; with MUSL they then move to `pending`.

        Reads: nodes (v, q), pending. Writes: rows, report (n_tiles, 7). Eq. (28)-(34), c_p + |v_p| of Eq. (35)-(36).
        """
        nodes, start, layers, cells = grid.nodes, tiles.start, tiles.layers, tiles.cells
        box, everywhere = column_box(grid, settings), Box(-np.inf, np.inf, np.inf, -np.inf, np.inf)
        for t in prange(len(layers)):
            first, stop = start[t], start[t + 1]
            matrices, averages = np.empty(matrix_size * (stop - first)), np.empty(stop - first + LANES)
            for p in range(first, stop):
                prefetch_record(rows, size, p + PREFETCH_DISTANCE)
                o, at = p * size, matrix_size * (p - first)
                own_x, own_y = load(rows, o + X_VECTOR), load(rows, o + Y_VECTOR)
                save_columns(matrices, at, dimension, own_x, own_y, own_x if flat else load(rows, o + Z_VECTOR))
                mean, x, y, z = interpolate(load(rows, o), nodes, grid, settings)
                averages[p - first] = extract(mean, Q)
                store_gradient(rows, o, dimension, x, y, z)
                if flat:
                    rows[o + L_ZZ] = extract(mean, VX) / rows[o + X] if settings.axisymmetric else 0.0
            update_tile_stress(
                rows, cells, layers[t], stop, column, base, c2_column, c2_base, settings, box, everywhere, dt, averages,
                side_rate, report[t],
            )  # fmt: skip
            for p in range(first, stop):
                restore_columns(rows, p * size, dimension, matrices, matrix_size * (p - first))
                if flat:
                    rows[p * size + L_ZZ] = matrices[matrix_size * (p - first) + L_ZZ - X_VECTOR]
                if is_musl:
                    store(rows, p * size, where_positive(force_mask(3), load(pending, p * LANES), load(rows, p * size)))

    return update_stresses
