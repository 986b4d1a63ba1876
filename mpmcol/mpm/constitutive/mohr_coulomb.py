"""Mohr-Coulomb with a non-associated flow rule, returned exactly in closed form.

Principal stresses s1 >= s2 >= s3, tension > 0, measured from the apex c cot(phi); k = (1 + sin phi) / (1 - sin phi), m
likewise with psi: yield function f = k s1 - s3 <= 0, plastic potential m s1 - s3. Face, both edges and apex follow
Clausen, Damkilde & Andersen (2007), doi:10.1016/j.compstruc.2007.04.002. With psi = 0 no plastic flow can remove
tension; the same formulas are then a tension cut-off at the apex.
"""

from __future__ import annotations

from math import cos, radians, sin, tan
from typing import Literal, NamedTuple

from mpmcol.mpm.constitutive.elastic import Derived, Elasticity
from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import where_positive
from mpmcol.units import option, quantity

STATE: tuple[str, ...] = ()
INVARIANTS = False
DERIVED: dict[str, Derived] = {}
MOST_DEGREES = 89.0  # N grows without bound towards 90


class Material(Elasticity):
    """[material] with law = "mohr-coulomb"."""

    law: Literal["mohr-coulomb"] = option("constitutive law", "mohr-coulomb")
    friction_deg: float = quantity("friction angle phi", "deg", gt=0.0, le=MOST_DEGREES)
    dilatancy_deg: float = quantity("dilatancy angle psi, at most friction_deg", "deg", 0.0, ge=0.0, le=MOST_DEGREES)
    cohesion: float = quantity("cohesion c", "Pa", 0.0, ge=0.0)

    @property
    def active_pressure_ratio(self) -> float:
        """K_a = 1 / N_phi, the ratio of horizontal to vertical stress at active yield."""
        return 1.0 / flow_number(sin(radians(self.friction_deg)))

    @property
    def mobilised_friction(self) -> float:
        """Ratio of shear to normal stress of a layer in shear."""
        return shear_friction(self.friction_deg, self.dilatancy_deg)


class MohrCoulombParams(NamedTuple):
    """Moduli (Pa), N_phi, N_psi, and the mean stress at the apex (Pa)."""

    bulk_modulus: float
    shear_modulus: float
    n_phi: float
    n_psi: float
    apex: float


PARAMS = MohrCoulombParams


def make_params(material: Material) -> MohrCoulombParams:
    """Flow numbers of the angles, and the mean stress at the apex."""
    phi, psi = radians(material.friction_deg), radians(material.dilatancy_deg)
    return MohrCoulombParams(
        material.bulk_modulus,
        material.shear_modulus,
        flow_number(sin(phi)),
        flow_number(sin(psi)),
        material.cohesion / tan(phi),
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
    """The yield function."""
    return params.n_phi * (s1 - params.apex) - (s3 - params.apex)


@device
def return_map(s1, s2, s3, history, params, dt):
    """Return sorted principal stresses to the yield surface; see `ConstitutiveLaw.return_map`."""
    a = params.apex
    t1, t2, t3, released = return_to_cone(
        s1 - a, s2 - a, s3 - a, params.n_phi, params.n_psi, params.bulk_modulus, params.shear_modulus
    )
    return t1 + a, t2 + a, t3 + a, history, released, may_yield(s1, s3, history, params)


@device
def apex(history, params):
    """Mean stress of an opened point, Pa."""
    return params.apex


@device
def return_to_cone(s1, s2, s3, k, m, bulk, shear):
    """Return a yielding stress, measured from the apex; also gives the volumetric strain released at the apex."""
    p = (s1 + s2 + s3) * (1.0 / 3.0)
    # Distance from each edge, along the flow directions of its two faces; where both are positive the stress returns
    # to the apex.
    edge1 = (s1 + s2 - 2.0 * p + m * (s3 - p)) * (0.5 / shear) + (2.0 + m) * p * (1.0 / (3.0 * bulk))
    edge3 = (s1 - p + m * (s2 + s3 - 2.0 * p)) * (0.5 / shear) + (1.0 + 2.0 * m) * p * (1.0 / (3.0 * bulk))
    coupling = (0.5 * bulk / shear - 1.0 / 3.0) * (m - 1.0)  # lambda / 2G (m - 1)
    step = (k * s1 - s3) * (1.0 / (k * m + 1.0 + coupling * (k - 1.0)))
    face1, face2, face3 = s1 - step * (m + coupling), s2 - step * coupling, s3 - step * (coupling - 1.0)

    spread = (k - 1.0) * (m - 1.0) * (1.0 / (3.0 * shear))
    on1 = edge1 * (1.0 / (spread + (2.0 + m) * (2.0 + k) * (1.0 / (9.0 * bulk))))
    on3 = edge3 * (1.0 / (spread + (1.0 + 2.0 * m) * (1.0 + 2.0 * k) * (1.0 / (9.0 * bulk))))
    beyond1, beyond3 = face2 - face1, face3 - face2
    t1 = where_positive(beyond1, on1, where_positive(beyond3, on3, face1))
    t2 = where_positive(beyond1, on1, where_positive(beyond3, k * on3, face2))
    t3 = where_positive(beyond1, k * on1, where_positive(beyond3, k * on3, face3))

    at_apex = where_positive(edge1, where_positive(edge3, 1.0, 0.0), 0.0)
    released = where_positive(at_apex, where_positive(p, p * (1.0 / bulk), 0.0), 0.0)
    return (
        where_positive(at_apex, 0.0, t1),
        where_positive(at_apex, 0.0, t2),
        where_positive(at_apex, 0.0, t3),
        released,
    )
