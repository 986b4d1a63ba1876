"""Stress filter: the mean stress of flowing points approaches its average on the grid.

Differences of stress between the points of a cell exert no force on the nodes, so that nothing damps them; they arise
because each point yields and opens at its own time. In every step, before its stress update, a point moves towards the
average of its surroundings:

    q_p = tr(sigma_p) / 3 + K min(e_o, e_max)               mean stress; K e_o continues it for opened points, with
                                                            the bulk modulus K of the column for all points
    q_i = sum_p m_p w_ip q_p / m_i                          P2G, in the free lane of the node
    q_p <- q_p + chi_p (sum_i w_ip q_i - q_p)               G2P
    chi_p = r dt / (1 + r dt) min(1, (shear rate of p / reference shear rate)^2)

The volume ratio or the opening strain changes by the strain of the change, so that J stays tied to the stress.
A point whose q exceeds the mean stress at the apex opens. Points that have opened further than e_max are not changed.
Since m_p q_p is averaged symmetrically, the volume is kept in the mean; momentum is not touched. r is a multiple of
c / h, so that the filter vanishes on fine grids and does not depend on the time step; states of rest are not filtered.
It is an F-bar method (de Souza Neto et al. 1996, doi:10.1016/0020-7683(95)00259-6) for the elastic part of the
volumetric strain alone, reached gradually.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.lanes import OPENING, SIGMA
from mpmcol.mpm.simd import splat, spread, where_positive


def make_filtered_stress(dimension: int) -> Callable[..., Any]:
    """The stress q of a point, which the filter averages."""
    xx, yy, zz = SIGMA[dimension][:3]

    @device
    @variant(dimension)
    def filtered_stress(rows, o, settings):
        """q (Pa) of the point whose record starts at `o`, in all lanes."""
        mean = (spread(rows, o + xx) + spread(rows, o + yy) + spread(rows, o + zz)) * (1.0 / 3.0)
        opening, furthest = spread(rows, o + OPENING), splat(settings.filter_opening)
        return mean + settings.filter_modulus * where_positive(opening - furthest, furthest, opening)

    return filtered_stress


def make_stress_filter(tensors: ModuleType, law: ConstitutiveLaw) -> Callable[..., Any]:
    """The filter for one point, or for eight as vectors; tensors: the module of tensors of a dimension."""
    strain_increment, contract, isotropic = tensors.strain_increment, tensors.contract, tensors.isotropic
    add, select, apex = tensors.add, tensors.select, law.apex

    @device
    @variant(tensors, law)
    def filter_stress(s, L, V0, J, opening, history, params, settings, dt, average):
        """New stress, J and opening strain of points with the grid average `average` (Pa), and the volumetric
        elastic energy lost (J).
        """
        K, furthest, inv_K = settings.filter_modulus, settings.filter_opening, 1.0 / params.bulk_modulus
        mean = (s[0] + s[1] + s[2]) * (1.0 / 3.0)
        q = mean + K * where_positive(opening - furthest, furthest, opening)
        e = strain_increment(L, dt)
        volumetric = e[0] + e[1] + e[2]
        shear2 = contract(e, e) - volumetric * volumetric * (1.0 / 3.0)
        flow = shear2 * (2.0 / (dt * settings.filter_shear_rate) ** 2)
        flow = where_positive(flow - 1.0, 1.0, flow)
        share = settings.filter_rate * dt
        q = q + (share / (1.0 + share)) * flow * (average - q)

        limit, far = apex(history, params), opening - furthest
        excess = q - limit
        closed = where_positive(far, mean, where_positive(excess, limit, q))
        change = closed - mean
        new_opening = where_positive(excess, excess * (1.0 / K), 0.0) if settings.opening_strain else opening
        return (
            add(select(where_positive(far, 0.0, excess), isotropic(mean), s), isotropic(change)),
            J * (1.0 + change * inv_K),
            where_positive(far, opening, new_opening),
            (-0.5 * inv_K) * V0 * J * change * (closed + mean),
        )

    return filter_stress
