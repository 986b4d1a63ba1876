"""Stress of eight points in three dimensions: Jaumann rotation, elastic increment, return to the law's surface.

Symmetric tensors are tuples xx yy zz xy yz xz.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcol.mpm import lanes
from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.kernels.principal_stress import determinant, direction, lone_value, second_invariant
from mpmcol.mpm.kernels.stress_common import (
    exponential,
    increment,
    inspect,
    load_eight,
    open_or_close,
    return_pair,
    settle,
    store_eight,
)
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import any_positive, sqrt, where_positive

RECORD_SIZE = lanes.RECORD_SIZE[3]


def make_formula(law: ConstitutiveLaw) -> Callable[..., Any]:
    """The stress update of one point, or of eight as vectors, with the formulas of `law` frozen in."""
    may_yield, return_map, apex = law.may_yield, law.return_map, law.apex

    @device
    @variant(law)
    def formula(s, L, V0, J, opening, history, params, settings, dt):
        """New stress, J, opening, history, and the stress work (J), from L xx xy xz yx yy yz zx zy zz, Eq. 29-34."""
        l_xx, l_xy, l_xz, l_yx, l_yy, l_yz, l_zx, l_zy, l_zz = L
        half = 0.5 * dt
        e_xx, e_yy, e_zz = dt * l_xx, dt * l_yy, dt * l_zz  # Eq. 32
        e = (e_xx, e_yy, e_zz, half * (l_xy + l_yx), half * (l_yz + l_zy), half * (l_xz + l_zx))
        volumetric = e_xx + e_yy + e_zz
        if settings.exponential_volume:
            ratio = exponential(volumetric)
        else:
            ratio = _stretch(e_xx, dt * l_xy, dt * l_xz, dt * l_yx, e_yy, dt * l_yz, dt * l_zx, dt * l_zy, e_zz)

        tip = apex(history, params)
        t = _rotate(s, half * (l_xy - l_yx), half * (l_yz - l_zy), half * (l_xz - l_zx))
        t = _choose(opening, (tip, tip, tip, 0.0, 0.0, 0.0), t)
        opening, ratio, closed, stays = open_or_close(opening, ratio, volumetric)
        g2, pressure = increment(params, closed, volumetric, stays)
        t_xx, t_yy, t_zz = t[0] + g2 * e_xx + pressure, t[1] + g2 * e_yy + pressure, t[2] + g2 * e_zz + pressure
        t = (t_xx, t_yy, t_zz, t[3] + g2 * e[3], t[4] + g2 * e[4], t[5] + g2 * e[5])

        p = (t_xx + t_yy + t_zz) * (1.0 / 3.0)
        d = (t_xx - p, t_yy - p, t_zz - p, t[3], t[4], t[5])
        j2 = second_invariant(d)
        reach = sqrt(j2 * (4.0 / 3.0))  # no principal stress is farther from p
        if any_positive(where_positive(stays, 0.0, may_yield(p + reach, p - reach, history, params))):
            returned, q, freed, yields = _return(p, d, j2, history, params, return_map)
            yields = where_positive(stays, 0.0, yields)
            t = _choose(yields, returned, t)
            history, opening, ratio = settle(yields, q, history, freed, opening, ratio, settings)
        work = (s[0] + t[0]) * e_xx + (s[1] + t[1]) * e_yy + (s[2] + t[2]) * e_zz
        work = work + 2.0 * ((s[3] + t[3]) * e[3] + (s[4] + t[4]) * e[4] + (s[5] + t[5]) * e[5])
        return t, J * ratio, opening, history, 0.5 * V0 * J * work

    return formula


def make_update_stress(law: ConstitutiveLaw) -> Callable[..., Any]:
    """The stress update of eight records under `law`."""
    formula = make_formula(law)

    @device
    @variant(law)
    def update_stress(
        rows: np.ndarray,
        o: int,
        count: int,
        params: Any,
        settings: Settings,
        box: Any,
        c2: float,
        dt: float,
        excess: Any,
    ) -> tuple[Any, Any, Any]:
        """Update J, opening and stress of `count` <= 8 points, the first of whose records starts at `o`.

        Reads: L, sigma, J, e_o, history. Writes: sigma, J, e_o, history. Eq. (29)-(34). Returns three vectors: stress
        work (J), wave speed plus speed (m/s), and one for every point that is sound and inside the box. excess: what
        the strain rate has too much of in every direction.
        """
        _, v_x, v_y, v_z, x, y, z, V0 = load_eight(rows, o, RECORD_SIZE)
        J, l_xx, l_yx, l_zx, s_xx, s_xy, s_xz, opening = load_eight(rows, o + 8, RECORD_SIZE)
        number, l_xy, l_yy, l_zy, _, s_yy, s_yz, kind = load_eight(rows, o + 16, RECORD_SIZE)
        q_0, l_xz, l_yz, l_zz, _, _, s_zz, q_1 = load_eight(rows, o + 24, RECORD_SIZE)
        s, rate_x, rate_y = (s_xx, s_yy, s_zz, s_xy, s_yz, s_xz), l_xx - excess, l_yy - excess
        L = (rate_x, l_xy, l_xz, l_yx, rate_y, l_yz, l_zx, l_zy, l_zz - excess)
        t, J, opening, q, work = formula(s, L, V0, J, opening, (q_0, q_1), params, settings, dt)
        store_eight(rows, o + 8, RECORD_SIZE, count, (J, l_xx, l_yx, l_zx, t[0], t[3], t[5], opening))
        store_eight(rows, o + 16, RECORD_SIZE, count, (number, l_xy, l_yy, l_zy, t[3], t[1], t[4], kind))
        store_eight(rows, o + 24, RECORD_SIZE, count, (q[0], l_xz, l_yz, l_zz, t[5], t[4], t[2], q[1]))
        speed, sound = inspect(J, v_x * v_x + v_y * v_y + v_z * v_z, c2, settings)
        sound = where_positive(box.x_high - x, where_positive(box.y_high - y, sound, 0.0), 0.0)
        sound = where_positive(box.z_high - z, where_positive(x - box.x_low, sound, 0.0), 0.0)
        return work, speed, where_positive(z - box.z_low, sound, 0.0)

    return update_stress


@device
def _choose(condition, a, b):
    """Tensor a where the condition is above zero, else b."""
    return (
        where_positive(condition, a[0], b[0]), where_positive(condition, a[1], b[1]),
        where_positive(condition, a[2], b[2]), where_positive(condition, a[3], b[3]),
        where_positive(condition, a[4], b[4]), where_positive(condition, a[5], b[5]),
    )  # fmt: skip


@device
def _stretch(xx, xy, xz, yx, yy, yz, zx, zy, zz):
    """det(I + L dt), Eq. 29, 30."""
    a, b, c = 1.0 + xx, 1.0 + yy, 1.0 + zz
    return a * (b * c - yz * zy) - xy * (yx * c - yz * zx) + xz * (yx * zy - b * zx)


@device
def _rotate(s, w_xy, w_yz, w_xz):
    """Old stress turned by the spin of this step, s + w s - s w, Eq. 33, 34."""
    xx, yy, zz, xy, yz, xz = s
    return (
        xx + 2.0 * (w_xy * xy + w_xz * xz),
        yy + 2.0 * (w_yz * yz - w_xy * xy),
        zz - 2.0 * (w_xz * xz + w_yz * yz),
        xy + w_xy * (yy - xx) + w_xz * yz + w_yz * xz,
        yz + w_yz * (zz - yy) - w_xy * xz - w_xz * xy,
        xz + w_xz * (zz - xx) + w_xy * yz - w_yz * xy,
    )


@device
def _return(p, d, j2, history, params, return_map):
    """Return the stress p I + d in its principal directions."""
    value = lone_value(j2, determinant(d))
    n_x, n_y, n_z = direction(d, value)
    # what is left of d across n, without its mean
    half, lone = 0.5 * value, 1.5 * value
    b = (
        d[0] + half - lone * n_x * n_x, d[1] + half - lone * n_y * n_y, d[2] + half - lone * n_z * n_z,
        d[3] - lone * n_x * n_y, d[4] - lone * n_y * n_z, d[5] - lone * n_x * n_z,
    )  # fmt: skip
    radius, centre = sqrt(second_invariant(b)), p - half
    r_a, r_b, r_n, q, freed, yields = return_pair(
        centre + radius, centre - radius, p + value, history, params, return_map
    )
    scale = where_positive(radius, 0.5 * (r_a - r_b) / radius, 0.0)
    mean = 0.5 * (r_a + r_b)
    rest = r_n - mean
    returned = (
        mean + rest * n_x * n_x + scale * b[0], mean + rest * n_y * n_y + scale * b[1],
        mean + rest * n_z * n_z + scale * b[2], rest * n_x * n_y + scale * b[3],
        rest * n_y * n_z + scale * b[4], rest * n_x * n_z + scale * b[5],
    )  # fmt: skip
    return returned, q, freed, yields
