"""Mohr-Coulomb with softening: friction, dilatancy and cohesion decay from peak to residual values with plastic strain.

phi = phi_r + (phi_p - phi_r) exp(-beta eps), psi and c likewise (Fern & Soga 2016, doi:10.1007/s11440-016-0436-x; Table
1 of the paper), eps = path integral of sqrt(2/3 de:de) with de the deviatoric plastic strain increment. Other codes use
factors other than sqrt(2/3): set `strain_factor`.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

from mpmcol.mpm.constitutive.elastic import Derived, Elasticity
from mpmcol.mpm.constitutive.elementary import cotangent, decay, sine
from mpmcol.mpm.constitutive.mohr_coulomb import MOST_DEGREES, flow_number, shear_friction
from mpmcol.mpm.constitutive.pyramid import return_to_cone
from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import sqrt
from mpmcol.units import option, quantity

STATE: tuple[str, ...] = ("plastic_shear_strain",)
INVARIANTS = False
DERIVED: dict[str, Derived] = {}


class Material(Elasticity):
    """[material] with law = "mohr-coulomb-softening"."""

    law: Literal["mohr-coulomb-softening"] = option("constitutive law", "mohr-coulomb-softening")
    friction_peak_deg: float = quantity("peak friction angle", "deg", gt=0.0, le=MOST_DEGREES)
    friction_residual_deg: float = quantity("residual friction angle", "deg", gt=0.0, le=MOST_DEGREES)
    dilatancy_peak_deg: float = quantity("peak dilatancy angle", "deg", 0.0, ge=0.0, le=MOST_DEGREES)
    dilatancy_residual_deg: float = quantity("residual dilatancy angle", "deg", 0.0, ge=0.0, le=MOST_DEGREES)
    softening_rate: float = quantity("softening rate beta of the exponential decay, Table 1 of the paper", gt=0.0)
    strain_factor: float = quantity(
        "factor of the plastic shear strain increment, deps = factor * sqrt(de:de)",
        default=math.sqrt(2.0 / 3.0),
        gt=0.0,
    )
    cohesion: float = quantity("peak cohesion c", "Pa", 0.0, ge=0.0)
    cohesion_residual: float | None = quantity("residual cohesion; default: that of the peak", "Pa", None, ge=0.0)

    @property
    def active_pressure_ratio(self) -> float:
        """K_a = 1 / N_phi of the peak state, the ratio of horizontal to vertical stress at active yield."""
        return 1.0 / flow_number(math.sin(math.radians(self.friction_peak_deg)))

    @property
    def mobilised_friction(self) -> float:
        """Ratio of shear to normal stress of a layer in shear, residual."""
        return shear_friction(self.friction_residual_deg, self.dilatancy_residual_deg)


class SofteningParams(NamedTuple):
    """Moduli (Pa), residual angles and peak minus residual (radians), decay rate, residual cohesion and peak minus
    residual (Pa), smallest N_phi.
    """

    bulk_modulus: float
    shear_modulus: float
    phi_residual: float
    phi_excess: float
    psi_residual: float
    psi_excess: float
    rate: float
    strain_factor: float
    cohesion_residual: float
    cohesion_excess: float
    weakest_n_phi: float


PARAMS = SofteningParams


def make_params(material: Material) -> SofteningParams:
    """Angles in radians, peak values as the excess over the residual ones."""
    phi_r, psi_r = math.radians(material.friction_residual_deg), math.radians(material.dilatancy_residual_deg)
    phi_p, psi_p = math.radians(material.friction_peak_deg), math.radians(material.dilatancy_peak_deg)
    c_p, c_r = material.cohesion, material.cohesion_residual
    return SofteningParams(
        material.bulk_modulus,
        material.shear_modulus,
        phi_r,
        phi_p - phi_r,
        psi_r,
        psi_p - psi_r,
        material.softening_rate,
        material.strain_factor,
        c_p if c_r is None else c_r,
        0.0 if c_r is None else c_p - c_r,
        flow_number(math.sin(min(phi_r, phi_p))),
    )


@device
def may_yield(s1, s3, history, params):
    """Yield function for the smallest friction and no cohesion: above zero wherever the actual one is."""
    return params.weakest_n_phi * s1 - s3


@device
def return_map(s1, s2, s3, history, params, dt):
    """Return to the yield surface of the present plastic strain, then add the increment to that strain."""
    eps, other = history
    remaining = decay(params.rate * eps)
    sin_phi = sine(params.phi_residual + params.phi_excess * remaining)
    cohesion = params.cohesion_residual + params.cohesion_excess * remaining
    k, a = flow_number(sin_phi), cohesion * cotangent(sin_phi)
    m = flow_number(sine(params.psi_residual + params.psi_excess * remaining))
    yields = k * (s1 - a) - (s3 - a)
    t1, t2, t3, released = return_to_cone(s1 - a, s2 - a, s3 - a, k, m, params.bulk_modulus, params.shear_modulus)
    d1, d2, d3 = s1 - a - t1, s2 - a - t2, s3 - a - t3
    mean = (d1 + d2 + d3) * (1.0 / 3.0)
    d1, d2, d3 = d1 - mean, d2 - mean, d3 - mean
    norm = sqrt(d1 * d1 + d2 * d2 + d3 * d3) * (0.5 / params.shear_modulus)
    return t1 + a, t2 + a, t3 + a, (eps + params.strain_factor * norm, other), released, yields


@device
def apex(history, params):
    """Mean stress of an opened point, Pa."""
    remaining = decay(params.rate * history[0])
    cohesion = params.cohesion_residual + params.cohesion_excess * remaining
    return cohesion * cotangent(sine(params.phi_residual + params.phi_excess * remaining))
