"""Volume and stress of a point: Jaumann rotation, elastic increment, return to the law's surface, opening."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from types import ModuleType

import numpy as np

from mpmcol.jit import device
from mpmcol.state import (
    LXX,
    LXY,
    LYX,
    LYY,
    LZZ,
    OPENING,
    Q0,
    Q1,
    SXX,
    SXY,
    SXY_COPY,
    SYY,
    SZZ,
    V0,
    J,
    Settings,
)  # fmt: skip


def make_update_stress(law: ModuleType) -> Callable[..., float]:
    """The stress update of one point under `law`, compiled with the law's formulas frozen in."""
    return_map, apex = law.return_map, law.apex

    @device
    def update_stress(rows: np.ndarray, o: int, params, settings: Settings, dt: float) -> float:
        """Update J, opening and stress of the point whose record starts at `o`; returns its stress work, J.

        Reads: L, sigma, J, e_o, history. Writes: sigma, J, e_o, history. Eq. (29)-(34).
        """
        l_xx, l_yy, l_zz = dt * rows[o + LXX], dt * rows[o + LYY], dt * rows[o + LZZ]
        l_xy, l_yx = dt * rows[o + LXY], dt * rows[o + LYX]
        s_xx, s_yy, s_zz, s_xy = rows[o + SXX], rows[o + SYY], rows[o + SZZ], rows[o + SXY]
        ratio = ((1.0 + l_xx) * (1.0 + l_yy) - l_xy * l_yx) * (1.0 + l_zz)  # Eq. 29, 30: det(I + dt L)
        volume = rows[o + V0] * rows[o + J]
        shear = 0.5 * (l_xy + l_yx)  # Eq. 32
        volumetric = l_xx + l_yy + l_zz
        third = volumetric / 3.0
        history = (rows[o + Q0], rows[o + Q1])

        if rows[o + OPENING] > 0.0:
            opened = (1.0 + rows[o + OPENING]) * ratio - 1.0
            t_xx, t_xy = apex(history, params), 0.0
            t_yy, t_zz = t_xx, t_xx
            if opened > 0.0:
                rows[o + OPENING] = opened
                _store_stress(rows, o, t_xx, t_yy, t_zz, t_xy)
                return volume * t_xx * volumetric  # none without cohesion
            rows[o + OPENING] = 0.0
            ratio, volumetric = 1.0 + opened, opened
        else:
            turn = l_xy - l_yx  # Eq. 33, 34: twice the spin
            t_xx, t_yy, t_zz = s_xx + turn * s_xy, s_yy - turn * s_xy, s_zz
            t_xy = s_xy + 0.5 * turn * (s_yy - s_xx)
        g2, bulk = 2.0 * params.shear_modulus, params.bulk_modulus * volumetric
        t_xx += g2 * (l_xx - third) + bulk
        t_yy += g2 * (l_yy - third) + bulk
        t_zz += g2 * (l_zz - third) + bulk
        t_xy += g2 * shear

        centre, half = 0.5 * (t_xx + t_yy), 0.5 * (t_xx - t_yy)
        radius = sqrt(half * half + t_xy * t_xy)
        r1, r2, r3, q, freed, elastic = _return_in_plane(
            centre + radius, centre - radius, t_zz, history, params, return_map
        )
        if not elastic:
            scale = 0.5 * (r1 - r2) / radius if radius > 0.0 else 0.0
            centre = 0.5 * (r1 + r2)
            t_xx, t_yy, t_zz, t_xy = centre + scale * half, centre - scale * half, r3, scale * t_xy
            rows[o + Q0], rows[o + Q1] = q
            if settings.opening_strain:
                rows[o + OPENING] = freed
                ratio /= 1.0 + freed
        rows[o + J] *= ratio
        _store_stress(rows, o, t_xx, t_yy, t_zz, t_xy)
        work = (s_xx + t_xx) * l_xx + (s_yy + t_yy) * l_yy + (s_zz + t_zz) * l_zz + 2.0 * (s_xy + t_xy) * shear
        return 0.5 * volume * work

    return update_stress


@device
def _store_stress(rows, o, t_xx, t_yy, t_zz, t_xy):
    """Write the stress where P2G expects its columns."""
    rows[o + SXX], rows[o + SYY], rows[o + SZZ] = t_xx, t_yy, t_zz
    rows[o + SXY] = t_xy
    rows[o + SXY_COPY] = t_xy


@device
def _return_in_plane(a, b, z, history, params, return_map):
    """Sort the principal stresses a >= b in the plane and z across it, return them, put them back in place."""
    if z >= a:
        s1, s2, s3, q, freed, elastic = return_map(z, a, b, history, params)
        return s2, s3, s1, q, freed, elastic
    if z <= b:
        return return_map(a, b, z, history, params)
    s1, s2, s3, q, freed, elastic = return_map(a, z, b, history, params)
    return s1, s3, s2, q, freed, elastic
