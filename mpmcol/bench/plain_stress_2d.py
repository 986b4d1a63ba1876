"""Stress update of the plain loops: the formulas of `kernels.stress_2d` on separate arrays."""

# Compiled functions take what Numba infers.
# mypy: allow-untyped-defs
# ruff: noqa: ANN001

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from types import ModuleType

from mpmcol.jit import device, phase, prange
from mpmcol.kernels.stress_2d import _return_in_plane


def make_update_stress(column_law: ModuleType, base_law: ModuleType) -> Callable[..., None]:
    """The loop over all points with the laws of column and base frozen in."""
    column_stress, base_stress = _make_point_stress(column_law), _make_point_stress(base_law)

    @phase
    def update_stress(points, tiles, settings, column, base, c2_column, c2_base, dt, report):
        """Volume, stress and time step of all points.

        Reads: points (L). Writes: points (sigma, J, opening, history), report (n_tiles, 2). Eq. (29)-(36).
        """
        v_p, L_p, sigma_p, V0_p, J_p = points.v, points.L, points.sigma, points.V0, points.J
        opening_p, history_p, start, split = points.opening, points.history, tiles.start, tiles.split
        for t in prange(len(split)):
            speed, work = 0.0, 0.0
            for p in range(start[t], split[t]):
                work += column_stress(p, L_p, sigma_p, V0_p, J_p, opening_p, history_p, column, settings, dt)
                speed = max(speed, sqrt(c2_column * J_p[p]) + sqrt(v_p[p, 0] ** 2 + v_p[p, 1] ** 2))
            for p in range(split[t], start[t + 1]):
                work += base_stress(p, L_p, sigma_p, V0_p, J_p, opening_p, history_p, base, settings, dt)
                speed = max(speed, sqrt(c2_base * J_p[p]) + sqrt(v_p[p, 0] ** 2 + v_p[p, 1] ** 2))
            report[t, 0], report[t, 1] = speed, work

    return update_stress


def _make_point_stress(law: ModuleType) -> Callable[..., float]:
    """The update of one point under `law`."""
    return_map, apex = law.return_map, law.apex

    @device
    def point_stress(p, L_p, sigma_p, V0_p, J_p, opening_p, history_p, params, settings, dt):
        """Update sigma, J, opening and history of point `p`; returns its stress work, J."""
        l_xx, l_xy, l_yx = dt * L_p[p, 0], dt * L_p[p, 1], dt * L_p[p, 2]
        l_yy, l_zz = dt * L_p[p, 3], dt * L_p[p, 4]
        s_xx, s_yy, s_zz, s_xy = sigma_p[p, 0], sigma_p[p, 1], sigma_p[p, 2], sigma_p[p, 3]
        history = (history_p[p, 0], history_p[p, 1])
        ratio = ((1.0 + l_xx) * (1.0 + l_yy) - l_xy * l_yx) * (1.0 + l_zz)  # Eq. 29, 30
        shear, volumetric, volume = 0.5 * (l_xy + l_yx), l_xx + l_yy + l_zz, V0_p[p] * J_p[p]
        turn = l_xy - l_yx
        t_xx, t_yy, t_zz = s_xx + turn * s_xy, s_yy - turn * s_xy, s_zz  # Eq. 33, 34
        t_xy = s_xy + 0.5 * turn * (s_yy - s_xx)
        third = volumetric / 3.0

        if opening_p[p] > 0.0:
            opened = (1.0 + opening_p[p]) * ratio - 1.0
            opening_p[p] = max(opened, 0.0)
            t_xx = t_yy = t_zz = apex(history, params)
            t_xy = 0.0
            if opened > 0.0:
                sigma_p[p, 0], sigma_p[p, 1], sigma_p[p, 2], sigma_p[p, 3] = t_xx, t_yy, t_zz, t_xy
                return 0.0
            ratio, volumetric = 1.0 + opened, opened
        pressure = params.bulk_modulus * volumetric
        t_xx += 2.0 * params.shear_modulus * (l_xx - third) + pressure
        t_yy += 2.0 * params.shear_modulus * (l_yy - third) + pressure
        t_zz += 2.0 * params.shear_modulus * (l_zz - third) + pressure
        t_xy += 2.0 * params.shear_modulus * shear

        centre, half = 0.5 * (t_xx + t_yy), 0.5 * (t_xx - t_yy)
        radius = sqrt(half * half + t_xy * t_xy)
        r1, r2, r3, q, freed, elastic = _return_in_plane(
            centre + radius, centre - radius, t_zz, history, params, return_map
        )
        if not elastic:
            scale = 0.5 * (r1 - r2) / radius if radius > 0.0 else 0.0
            centre = 0.5 * (r1 + r2)
            t_xx, t_yy, t_zz, t_xy = centre + scale * half, centre - scale * half, r3, scale * t_xy
            history_p[p, 0], history_p[p, 1] = q
            if settings.opening_strain:
                opening_p[p] = freed
                ratio /= 1.0 + freed
        J_p[p] *= ratio
        sigma_p[p, 0], sigma_p[p, 1], sigma_p[p, 2], sigma_p[p, 3] = t_xx, t_yy, t_zz, t_xy
        work = (s_xx + t_xx) * l_xx + (s_yy + t_yy) * l_yy + (s_zz + t_zz) * l_zz + 2.0 * (s_xy + t_xy) * shear
        return 0.5 * volume * work

    return point_stress
