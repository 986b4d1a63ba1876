"""Mohr-Coulomb with a non-associated flow rule, returned exactly in closed form.

Principal stresses s1 >= s2 >= s3, tension > 0, measured from the apex c cot(phi); k = (1 + sin phi) / (1 - sin phi), m
likewise with psi: yield function f = k s1 - s3 <= 0, plastic potential m s1 - s3. Face, both edges and apex follow
Clausen, Damkilde & Andersen (2007), doi:10.1016/j.compstruc.2007.04.002. With psi = 0 no plastic flow can remove
tension; the same formulas are then a tension cut-off at the apex. A smaller tensile strength, its loss, and material
without friction, which has no apex, are in `pyramid`.
"""

from __future__ import annotations

from math import cos, inf, radians, sin, sqrt, tan
from typing import TYPE_CHECKING, Literal, NamedTuple

from mpmcol.mpm.constitutive.elastic import Derived, Elasticity
from mpmcol.mpm.constitutive.failure import after_opening as after_opening
from mpmcol.mpm.constitutive.failure import remaining
from mpmcol.mpm.constitutive.pyramid import excess_with_cut_off, return_to_cone, return_with_cut_off
from mpmcol.mpm.jit import device
from mpmcol.units import option, quantity

STATE: tuple[str, ...] = ()
INVARIANTS = False
DERIVED: dict[str, Derived] = {}
MOST_DEGREES = 89.0  # N grows without bound towards 90
DOUBLED = 1.0  # plastic volumetric strain of material whose volume has doubled
UNLIMITED = 1e30  # Pa, tensile strength of material without friction; finite, so that no difference is NaN


class ConstantAngles:
    """Ratios of stresses of a material with constant angles of friction and dilatancy."""

    if TYPE_CHECKING:  # keys of the material
        friction_deg: float
        dilatancy_deg: float

    @property
    def active_pressure_ratio(self) -> float:
        """K_a = 1 / N_phi, the ratio of horizontal to vertical stress at active yield."""
        return 1.0 / flow_number(sin(radians(self.friction_deg)))

    @property
    def mobilised_friction(self) -> float:
        """Ratio of shear to normal stress of a layer in shear."""
        return shear_friction(self.friction_deg, self.dilatancy_deg)


class Material(ConstantAngles, Elasticity):
    """[material] with law = "mohr-coulomb"."""

    law: Literal["mohr-coulomb"] = option("constitutive law", "mohr-coulomb")
    friction_deg: float = quantity("friction angle phi; 0 needs cohesion", "deg", ge=0.0, le=MOST_DEGREES)
    dilatancy_deg: float = quantity("dilatancy angle psi, at most friction_deg", "deg", 0.0, ge=0.0, le=MOST_DEGREES)
    cohesion: float = quantity("cohesion c", "Pa", 0.0, ge=0.0)
    tension: float | None = quantity(
        "tensile strength, at most c cot(phi); default: c cot(phi), and no limit without friction", "Pa", None, ge=0.0
    )
    failure_strain: float | None = quantity(
        "plastic volumetric strain under tension beyond which a point loses cohesion and tensile strength; 0: once it "
        "has reached its tensile strength; inf: never; default: 1 with tension, else inf",
        "", None, ge=0.0, allow_inf=True,
    )  # fmt: skip

    @property
    def apex(self) -> float:
        """Mean stress at the apex, c cot(phi), Pa; inf without friction."""
        return self.cohesion / tan(radians(self.friction_deg)) if self.friction_deg > 0.0 else inf


class MohrCoulombParams(NamedTuple):
    """Moduli (Pa), N_phi, N_psi, mean stress at the apex (Pa); strength 2 c sqrt(N_phi) and tensile strength (Pa).

    cut_off: 1 where the last two apply, in place of the apex, until the first history variable exceeds
    failure_strain (`failure`); 0 without cohesion, which leaves nothing to lose.
    """

    bulk_modulus: float
    shear_modulus: float
    n_phi: float
    n_psi: float
    apex: float
    strength: float
    tension: float
    cut_off: float
    failure_strain: float


PARAMS = MohrCoulombParams


def make_params(material: Material) -> MohrCoulombParams:
    """Flow numbers of the angles, and the mean stress at the apex."""
    phi, psi = radians(material.friction_deg), radians(material.dilatancy_deg)
    apex, failure = material.apex, material.failure_strain
    tension = min(apex if material.tension is None else material.tension, UNLIMITED)
    if failure is None:
        failure = inf if material.tension is None else DOUBLED
    if material.cohesion == 0.0:
        failure = inf
    return MohrCoulombParams(
        material.bulk_modulus,
        material.shear_modulus,
        flow_number(sin(phi)),
        flow_number(sin(psi)),
        apex,
        2.0 * material.cohesion * sqrt(flow_number(sin(phi))),
        tension,
        float(material.cohesion > 0.0 and (tension < apex or failure < inf)),
        failure,
    )


def shear_friction(friction_deg: float, dilatancy_deg: float) -> float:
    """Ratio of shear to normal stress of a layer that shears without a change of its length, without cohesion.

    tan(delta) = sin(phi) cos(psi) / (1 - sin(phi) sin(psi)) (Davis 1968): the directions of stress and of the strain
    increment coincide.
    """
    phi, psi = radians(friction_deg), radians(dilatancy_deg)
    return sin(phi) * cos(psi) / (1.0 - sin(phi) * sin(psi))


@device
def flow_number(sine: float) -> float:
    """N = (1 + sin) / (1 - sin)."""
    return (1.0 + sine) / (1.0 - sine)


@device
def may_yield(s1, s3, history, params):
    """The yield function; with a cut-off the larger of those of shear and tension."""
    if params.cut_off > 0.0:
        return excess_with_cut_off(s1, s3, params.n_phi, *present_strength(history, params))
    return params.n_phi * (s1 - params.apex) - (s3 - params.apex)


@device
def return_map(s1, s2, s3, history, params, dt):
    """Return sorted principal stresses to the yield surface; see `ConstitutiveLaw.return_map`."""
    if params.cut_off > 0.0:
        strength, tension = present_strength(history, params)
        t1, t2, t3, released, expanded = return_with_cut_off(
            s1, s2, s3, params.n_phi, params.n_psi, strength, tension, params.bulk_modulus, params.shear_modulus
        )
        strained = history[0] + expanded, history[1]
        return t1, t2, t3, strained, released, may_yield(s1, s3, history, params)
    a = params.apex
    t1, t2, t3, released = return_to_cone(
        s1 - a, s2 - a, s3 - a, params.n_phi, params.n_psi, params.bulk_modulus, params.shear_modulus
    )
    return t1 + a, t2 + a, t3 + a, history, released, may_yield(s1, s3, history, params)


@device
def apex(history, params):
    """Mean stress of an opened point, Pa."""
    return remaining(params.tension, history, params)


@device
def present_strength(history, params):
    """2 c sqrt(N_phi) and tensile strength (Pa), both zero where material has failed in tension."""
    return remaining(params.strength, history, params), remaining(params.tension, history, params)
