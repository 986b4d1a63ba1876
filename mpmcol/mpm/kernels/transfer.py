"""Points to grid and grid to points for a basis of any width, in two and three dimensions.

The quadratic shape functions have transfers of their own, written out node by node (`transfer_quadratic_2d`,
`transfer_quadratic_3d`).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import SimpleNamespace
from typing import Any

from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.kernels import transfer_quadratic_2d, transfer_quadratic_3d
from mpmcol.mpm.kernels.interpolation import SLOPE, make_lines, make_sums, set_columns
from mpmcol.mpm.kernels.transfer_common import forces, momenta, move, power, spread
from mpmcol.mpm.lanes import L_ZZ, S_ZZ, V0, J, M, X, Y, Z
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS, ShapeFunctions
from mpmcol.mpm.simd import extract, fma, load, splat, store, vector

TRANSFERS: dict[int, Any] = {2: transfer_quadratic_2d, 3: transfer_quadratic_3d}


@cache
def make_transfer(dimension: int, basis: str) -> Any:
    """What a dimension and a basis need of the transfers: `scatter`, `gather` and `RECORD_SIZE`."""
    own = TRANSFERS[dimension]
    if basis == "quadratic":
        return own
    return SimpleNamespace(
        __name__=f"{basis}_{dimension}",
        RECORD_SIZE=own.RECORD_SIZE,
        scatter=_make_scatter(dimension, SHAPE_FUNCTIONS[basis]),
        gather=_make_gather(dimension, SHAPE_FUNCTIONS[basis]),
    )


def _make_scatter(dimension: int, basis: ShapeFunctions) -> Callable[..., Any]:
    lines, width, flat = make_lines(dimension, basis, False), basis.WIDTH, dimension == 2
    depth = 1 if flat else width

    @device
    @variant(dimension, basis)
    def scatter(rows, o, nodes, grid, settings):
        """Add one point, whose record starts at `o`, to its nodes."""
        h, inv_h, record = grid.h, 1.0 / grid.h, load(rows, o)
        base, d, x, y, z = lines(record, grid, settings)
        i, j, k = int(extract(base, X)), int(extract(base, Y)), 0 if flat else int(extract(base, Z))
        d_x, d_y, d_z = extract(d, X), extract(d, Y), extract(d, Z)
        m, volume = rows[o + M], rows[o + J] * rows[o + V0]
        hoop = volume * rows[o + S_ZZ] / rows[o + X] if flat and settings.axisymmetric else 0.0

        # Eq. 19, 20, 14: mass, momentum at the point, weight (and the hoop stress of axisymmetry)
        momentum = splat(m) * momenta(dimension)
        pull_x, pull_y, pull_z = m * settings.gravity_x - hoop, m * settings.gravity_y, m * settings.gravity_z
        at_point = fma(record, momentum, vector(m, 0.0, 0.0, 0.0, pull_x, pull_y, 0.0 if flat else pull_z, 0.0))
        # Eq. 20: m L (x_i - x_p); Eq. 13: -V sigma . grad w
        taylor, force = (settings.taylor * h) * momentum, (-volume * inv_h) * forces(dimension)
        row_x, row_y = load(rows, o + 8), load(rows, o + 16)
        row_z = row_y if flat else load(rows, o + 24)

        # node (i, j, k) receives w_j w_k P_i + w_i (w_k Q_j + w_j R_k)
        for a in range(width):
            w_x = spread(x, a)
            p = fma(w_x, fma(splat(d_x + a), row_x * taylor, at_point), spread(x, SLOPE + a) * (row_x * force))
            for b in range(width):
                w_y = spread(y, b)
                q = fma(w_y * splat(d_y + b), row_y * taylor, spread(y, SLOPE + b) * (row_y * force))
                for c in range(depth):
                    w_z = spread(z, c)
                    t = w_z * q
                    if not flat:
                        r = fma(w_z * splat(d_z + c), row_z * taylor, spread(z, SLOPE + c) * (row_z * force))
                        t = fma(w_y, r, t)
                    node = grid.ax[i + a] + grid.ay[j + b] + grid.az[k + c]
                    store(nodes, node, fma(w_y * w_z, p, fma(w_x, t, load(nodes, node))))

    return scatter


def _make_gather(dimension: int, basis: ShapeFunctions) -> Callable[..., Any]:
    sums, flat = make_sums(dimension, basis, False), dimension == 2

    @device
    @variant(dimension, basis)
    def gather(rows, o, nodes, grid, settings, bounds, dt):
        """Update velocity, position and velocity gradient of one point from its nodes.

        Returns two vectors that count in lanes 4 to 6: its displacement, and the work of its old stress on the motion
        of the nodes, with gravity's on it where a wall holds it, J. Eq. (26)-(28), with the shares of FLIP and PIC and
        the position rule that the settings name.
        """
        old = load(rows, o)
        mean, x, y, z = sums(old, nodes, grid, settings)
        work = power(load(rows, o + 8), x, dt) + power(load(rows, o + 16), y, dt)
        if flat:
            l_zz = 0.0
            if settings.axisymmetric:  # v_r / r belongs to the old position
                l_zz = extract(mean, 1) / rows[o + X]
                hoop = (l_zz - 0.5 * dt * extract(mean, 4) / rows[o + X]) * rows[o + S_ZZ]
                work = work + vector(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, hoop, 0.0)
            rows[o + L_ZZ] = l_zz
        else:
            work = work + power(load(rows, o + 24), z, dt)
        work = (dt * rows[o + J] * rows[o + V0]) * work
        record, step, lifted = move(old, mean, dimension, bounds, settings, dt)
        store(rows, o, record)
        set_columns(rows, o, dimension, x, y, z)
        return step, work + lifted

    return gather
