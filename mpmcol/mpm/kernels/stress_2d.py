"""Stress of eight points in two dimensions: Jaumann rotation, elastic increment, return to the law's surface."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcol.mpm import lanes
from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import device, variant
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

RECORD_SIZE = lanes.RECORD_SIZE[2]


def make_formula(law: ConstitutiveLaw) -> Callable[..., Any]:
    """The stress update of one point, or of eight as vectors, with the formulas of `law` frozen in."""
    may_yield, return_map, apex = law.may_yield, law.return_map, law.apex

    @device
    @variant(law)
    def formula(s, L, V0, J, opening, history, params, settings, dt):
        """New stress xx yy zz xy, J, opening, history, and the stress work (J), from L xx xy yx yy zz, Eq. 29-34."""
        s_xx, s_yy, s_zz, s_xy = s
        l_xx, l_xy, l_yx, l_yy, l_zz = dt * L[0], dt * L[1], dt * L[2], dt * L[3], dt * L[4]
        shear = 0.5 * (l_xy + l_yx)  # Eq. 32
        volumetric = l_xx + l_yy + l_zz
        if settings.exponential_volume:
            ratio = exponential(volumetric)
        else:
            ratio = ((1.0 + l_xx) * (1.0 + l_yy) - l_xy * l_yx) * (1.0 + l_zz)  # Eq. 29, 30: det(I + dt L)

        tip, turn = apex(history, params), l_xy - l_yx  # Eq. 33, 34: twice the spin
        t_xx = where_positive(opening, tip, s_xx + turn * s_xy)
        t_yy = where_positive(opening, tip, s_yy - turn * s_xy)
        t_xy = where_positive(opening, 0.0, s_xy + 0.5 * turn * (s_yy - s_xx))
        t_zz = where_positive(opening, tip, s_zz)
        opening, ratio, closed, stays = open_or_close(opening, ratio, volumetric)
        g2, pressure = increment(params, closed, volumetric, stays)
        t_xx, t_yy, t_zz = t_xx + g2 * l_xx + pressure, t_yy + g2 * l_yy + pressure, t_zz + g2 * l_zz + pressure
        t_xy = t_xy + g2 * shear

        centre, half = 0.5 * (t_xx + t_yy), 0.5 * (t_xx - t_yy)
        radius = sqrt(half * half + t_xy * t_xy)
        a, b = centre + radius, centre - radius
        largest, least = where_positive(t_zz - a, t_zz, a), where_positive(b - t_zz, t_zz, b)
        if any_positive(where_positive(stays, 0.0, may_yield(largest, least, history, params))):
            r_a, r_b, r_z, q, freed, yields = return_pair(a, b, t_zz, history, params, return_map)
            yields = where_positive(stays, 0.0, yields)
            scale = where_positive(radius, 0.5 * (r_a - r_b) / radius, 0.0)
            centre = 0.5 * (r_a + r_b)
            t_xx = where_positive(yields, centre + scale * half, t_xx)
            t_yy = where_positive(yields, centre - scale * half, t_yy)
            t_zz, t_xy = where_positive(yields, r_z, t_zz), where_positive(yields, scale * t_xy, t_xy)
            history, opening, ratio = settle(yields, q, history, freed, opening, ratio, settings)
        work = (s_xx + t_xx) * l_xx + (s_yy + t_yy) * l_yy + (s_zz + t_zz) * l_zz + 2.0 * (s_xy + t_xy) * shear
        return (t_xx, t_yy, t_zz, t_xy), J * ratio, opening, history, 0.5 * V0 * J * work

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
        _, v_x, v_y, _, x, y, _, V0 = load_eight(rows, o, RECORD_SIZE)
        J, l_xx, l_yx, l_zz, s_xx, s_xy, s_zz, opening = load_eight(rows, o + 8, RECORD_SIZE)
        number, l_xy, l_yy, q_0, _, s_yy, q_1, kind = load_eight(rows, o + 16, RECORD_SIZE)
        s, L = (s_xx, s_yy, s_zz, s_xy), (l_xx - excess, l_xy, l_yx, l_yy - excess, l_zz - excess)
        t, J, opening, q, work = formula(s, L, V0, J, opening, (q_0, q_1), params, settings, dt)
        store_eight(rows, o + 8, RECORD_SIZE, count, (J, l_xx, l_yx, l_zz, t[0], t[3], t[2], opening))
        store_eight(rows, o + 16, RECORD_SIZE, count, (number, l_xy, l_yy, q[0], t[3], t[1], q[1], kind))
        speed, sound = inspect(J, v_x * v_x + v_y * v_y, c2, settings)
        sound = where_positive(box.x_high - x, where_positive(box.y_high - y, sound, 0.0), 0.0)
        return work, speed, where_positive(x - box.x_low, sound, 0.0)

    return update_stress
