"""Drucker-Prager without plastic change of volume: sqrt(J2) <= f (c + p tan(phi)), with the pressure p.

f matches the surface to Mohr-Coulomb with the same friction angle phi, cohesion c and apex c cot(phi):

    plane-strain   f = cos(phi), friction mu = sin(phi)      flow in plane strain, psi = 0
    compression    f = 6 cos(phi) / (sqrt(3) (3 - sin(phi)))  triaxial compression
    tangent        f = 1, mu = tan(phi)                       no match: a coefficient mu, given as its angle

(Drucker & Prager 1952, doi:10.1090/qam/48291.) The compression cone is far too strong in plane strain, where phi = 33
degrees acts as 50 degrees. Plastic flow at constant volume cannot remove tension: the apex is a tension cut-off.
Without friction there is no apex (von Mises).
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, inf, radians, sin, sqrt, tan
from typing import Literal, NamedTuple

from mpmcol.mpm.constitutive.elastic import Derived, Elasticity
from mpmcol.mpm.constitutive.failure import after_expansion, remaining
from mpmcol.mpm.constitutive.failure import after_opening as after_opening
from mpmcol.mpm.constitutive.invariants import active_ratio, return_from_tension
from mpmcol.mpm.constitutive.mohr_coulomb import MOST_DEGREES
from mpmcol.mpm.jit import device
from mpmcol.units import option, quantity

STATE: tuple[str, ...] = ()
INVARIANTS = True
DERIVED: dict[str, Derived] = {}

MATCHES: dict[str, Callable[[float], float]] = {
    "plane-strain": cos,
    "compression": lambda phi: 6.0 * cos(phi) / (sqrt(3.0) * (3.0 - sin(phi))),
    "tangent": lambda phi: 1.0,
}


class Material(Elasticity):
    """[material] with law = "drucker-prager"."""

    law: Literal["drucker-prager"] = option("constitutive law", "drucker-prager")
    friction_deg: float = quantity("friction angle phi; 0 needs cohesion", "deg", ge=0.0, le=MOST_DEGREES)
    match: Literal["plane-strain", "compression", "tangent"] = option(
        "coefficient mu of a friction angle: sin(phi), the strength of Mohr-Coulomb in plane strain (plane-strain); "
        "6 sin(phi) / (sqrt(3) (3 - sin(phi))), that in triaxial compression (compression); or tan(phi) (tangent)",
        "plane-strain",
    )
    cohesion: float = quantity("cohesion c", "Pa", 0.0, ge=0.0)
    failure_strain: float = quantity(
        "plastic volumetric strain at the apex, under tension, beyond which a point loses its cohesion; 0: once it has "
        "reached the apex; inf: never",
        "", inf, ge=0.0, allow_inf=True,
    )  # fmt: skip

    @property
    def mobilised_friction(self) -> float:
        """Ratio of shear to normal stress of a layer in shear, mu = f tan(phi)."""
        phi = radians(self.friction_deg)
        return MATCHES[self.match](phi) * tan(phi)

    @property
    def active_pressure_ratio(self) -> float:
        """Ratio of horizontal to vertical stress at active yield."""
        return active_ratio(self.mobilised_friction)


class DruckerPragerParams(NamedTuple):
    """Moduli (Pa), mu, strength without pressure f c and mean stress at the apex (Pa), strain that ends the two."""

    bulk_modulus: float
    shear_modulus: float
    friction: float
    strength: float
    apex: float
    failure_strain: float


PARAMS = DruckerPragerParams


def make_params(material: Material) -> DruckerPragerParams:
    """Friction and strength of the matched surface."""
    phi = radians(material.friction_deg)
    return DruckerPragerParams(
        material.bulk_modulus,
        material.shear_modulus,
        material.mobilised_friction,
        MATCHES[material.match](phi) * material.cohesion,
        material.cohesion / tan(phi) if phi > 0.0 else inf,
        material.failure_strain if material.cohesion > 0.0 else inf,
    )


@device
def may_yield(mean, shear, history, params):
    """The yield function."""
    return shear - (remaining(params.strength, history, params) - params.friction * mean)


@device
def apex(history, params):
    """Mean stress of an opened point, Pa."""
    return remaining(params.apex, history, params)


@device
def return_map(mean, shear, history, params, dt):
    """Return mean and shear stress to the yield surface; see `ConstitutiveLaw.return_map`."""
    yields = may_yield(mean, shear, history, params)
    limit = apex(history, params)
    mean, shear, released, _ = return_from_tension(mean, shear - yields, limit, params.bulk_modulus)
    return mean, shear, after_expansion(history, released, params), released, yields
