"""Mohr-Coulomb with softening: friction, dilatancy and cohesion decay from peak to residual values with plastic strain.

phi = phi_r + (phi_p - phi_r) exp(-beta eps), psi and c likewise (Fern & Soga 2016, doi:10.1007/s11440-016-0436-x; Table
1 of the paper), eps = path integral of sqrt(2/3 de:de) with de the deviatoric plastic strain increment. Other codes use
factors other than sqrt(2/3): set `strain_factor`. A tensile strength below c cot(phi) decays in proportion to c.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

from mpmcol.mpm.constitutive.elastic import Derived, Elasticity
from mpmcol.mpm.constitutive.elementary import cotangent, decay, sine
from mpmcol.mpm.constitutive.mohr_coulomb import MOST_DEGREES, flow_number, shear_friction
from mpmcol.mpm.constitutive.pyramid import excess_with_cut_off, return_to_cone, return_with_cut_off
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
    tension: float | None = quantity(
        "tensile strength at peak, at most c cot(phi) there; it decays as c; default: c cot(phi)", "Pa", None, ge=0.0
    )

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
    residual (Pa), smallest N_phi; tensile strength over cohesion, and 1 where it applies in place of the apex, else 0.
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
    tension_ratio: float
    cut_off: float


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
        0.0 if material.tension is None or c_p == 0.0 else material.tension / c_p,
        float(material.tension is not None and c_p > 0.0),
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
    sin_phi, cohesion = present_strength(remaining, params)
    k, m = flow_number(sin_phi), flow_number(sine(params.psi_residual + params.psi_excess * remaining))
    if params.cut_off > 0.0:
        a, strength, tension = 0.0 * cohesion, 2.0 * cohesion * sqrt(k), params.tension_ratio * cohesion
        yields = excess_with_cut_off(s1, s3, k, strength, tension)
        t1, t2, t3, released, _ = return_with_cut_off(
            s1, s2, s3, k, m, strength, tension, params.bulk_modulus, params.shear_modulus
        )
    else:  # measured from the apex
        a = cohesion * cotangent(sin_phi)
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
    sin_phi, cohesion = present_strength(decay(params.rate * history[0]), params)
    if params.cut_off > 0.0:
        return params.tension_ratio * cohesion
    return cohesion * cotangent(sin_phi)


@device
def after_opening(history, opening, params):
    """The history itself: opening changes nothing."""
    return history


@device
def present_strength(remaining, params):
    """sin(phi) and c (Pa), where this share of the softening remains."""
    return (
        sine(params.phi_residual + params.phi_excess * remaining),
        params.cohesion_residual + params.cohesion_excess * remaining,
    )
