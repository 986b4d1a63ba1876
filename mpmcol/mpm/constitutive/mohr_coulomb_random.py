"""Mohr-Coulomb with a random field of friction: tan(phi) varies from point to point and moves with the material.

tan(phi) is lognormal with two correlation lengths, horizontal and vertical (`random_field`), as in the random material
point method of Wang, Hicks & Vardon (2016, doi:10.1680/jgele.16.00019). The second history variable of a point is its
tan(phi) over the mean, minus one; it is constant. Flow rule and return are those of `mohr_coulomb`.
"""

from __future__ import annotations

from math import radians, sin, tan
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from mpmcol.mpm.constitutive.elastic import Derived, Elasticity
from mpmcol.mpm.constitutive.elastic import after_opening as after_opening
from mpmcol.mpm.constitutive.mohr_coulomb import MOST_DEGREES, ConstantAngles, flow_number
from mpmcol.mpm.constitutive.pyramid import return_to_cone
from mpmcol.mpm.constitutive.random_field import gaussian_field, lognormal_variation
from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import sqrt, where_positive
from mpmcol.units import option, quantity

STATE: tuple[str, ...] = ()
INVARIANTS = False
DIGITS = 6  # of tan(phi) over its mean: the last bits of cosines, which differ between machines, have no effect


class Material(ConstantAngles, Elasticity):
    """[material] with law = "mohr-coulomb-random"; ratios of stresses are those of the mean."""

    law: Literal["mohr-coulomb-random"] = option("constitutive law", "mohr-coulomb-random")
    friction_deg: float = quantity(
        "friction angle whose tangent is the mean of tan(phi)", "deg", gt=0.0, le=MOST_DEGREES
    )
    friction_variation: float = quantity("coefficient of variation of tan(phi), a lognormal field", "", ge=0.0, le=1.0)
    correlation_length: float = quantity(
        "horizontal correlation length of the field (scale of fluctuation): points closer than a fraction of it have "
        "about the same friction", "m", gt=0.0,
    )  # fmt: skip
    correlation_length_vertical: float | None = quantity(
        "vertical correlation length; default: the horizontal one", "m", None, gt=0.0
    )
    seed: Annotated[int, Field(ge=0)] = option("number of the realization of the field", 0)
    dilatancy_deg: float = quantity(
        "dilatancy angle psi, at most friction_deg; less where the friction angle is smaller", "deg", 0.0,
        ge=0.0, le=MOST_DEGREES,
    )  # fmt: skip
    cohesion: float = quantity("cohesion c, the same at all points", "Pa", 0.0, ge=0.0)

    @property
    def correlation_lengths(self) -> dict[str, float]:
        """Horizontal and vertical correlation length by their keys, m."""
        vertical = self.correlation_length_vertical or self.correlation_length
        return {"correlation_length": self.correlation_length, "correlation_length_vertical": vertical}

    def initial_history(self, x: np.ndarray) -> np.ndarray:
        """History (n, 2) of points at positions x (n, d), m: tan(phi) over its mean, minus one, as second variable."""
        horizontal, vertical = self.correlation_lengths.values()
        field = gaussian_field(x, horizontal, vertical, self.seed)
        history = np.zeros((len(x), 2))
        history[:, 1] = np.round(lognormal_variation(field, self.friction_variation), DIGITS)
        return history


class RandomFrictionParams(NamedTuple):
    """Moduli (Pa), mean of tan(phi), N_psi, and mean stress at the apex for the mean of tan(phi) (Pa)."""

    bulk_modulus: float
    shear_modulus: float
    tan_phi: float
    n_psi: float
    apex: float


PARAMS = RandomFrictionParams


def make_params(material: Material) -> RandomFrictionParams:
    """The mean of tan(phi), the flow number of psi, and the apex c cot(phi)."""
    tan_phi = tan(radians(material.friction_deg))
    return RandomFrictionParams(
        material.bulk_modulus,
        material.shear_modulus,
        tan_phi,
        flow_number(sin(radians(material.dilatancy_deg))),
        material.cohesion / tan_phi,
    )


@device
def present_n_phi(history, params):
    """N_phi of a point: (1 + sin phi) / (1 - sin phi) = (tan phi + sqrt(1 + tan^2 phi))^2."""
    tan_phi = params.tan_phi * (1.0 + history[1])
    root = tan_phi + sqrt(1.0 + tan_phi * tan_phi)
    return root * root


@device
def apex(history, params):
    """Mean stress of an opened point, c cot(phi), Pa."""
    return params.apex / (1.0 + history[1])


@device
def may_yield(s1, s3, history, params):
    """The yield function N_phi (s1 - a) - (s3 - a) with the apex a."""
    a = apex(history, params)
    return present_n_phi(history, params) * (s1 - a) - (s3 - a)


@device
def return_map(s1, s2, s3, history, params, dt):
    """Return sorted principal stresses to the yield surface of the point; see `ConstitutiveLaw.return_map`."""
    a, k = apex(history, params), present_n_phi(history, params)
    m = where_positive(k - params.n_psi, params.n_psi, k)  # no more dilatancy than friction
    t1, t2, t3, released = return_to_cone(s1 - a, s2 - a, s3 - a, k, m, params.bulk_modulus, params.shear_modulus)
    return t1 + a, t2 + a, t3 + a, history, released, k * (s1 - a) - (s3 - a)


def friction_angle(
    mean: np.ndarray, shear: np.ndarray, history: np.ndarray, params: RandomFrictionParams
) -> np.ndarray:
    """Friction angle of the points (n,), deg."""
    angle: np.ndarray = np.degrees(np.arctan(params.tan_phi * (1.0 + history[1])))
    return angle


DERIVED: dict[str, Derived] = {"local_friction_angle": friction_angle}
