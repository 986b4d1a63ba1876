"""mu(I) rheology: Drucker-Prager at constant volume whose friction grows with the rate of shear.

    sqrt(J2) = c + mu(I) p,   mu(I) = mu_s + (mu_2 - mu_s) / (1 + I_0 / I),   I = rate d sqrt(rho_s / p)

with the pressure p, the plastic shear rate, the diameter d and the density rho_s of the grains (Jop, Forterre &
Pouliquen 2006, doi:10.1038/nature04801). Elastic below c + mu_s p. The return is implicit in the rate and has a closed
form (Dunatunga & Kamrin 2015, doi:10.1017/jfm.2015.383), so that the time step remains that of elastic waves. With the
trial shear stress t, S_0 = c + mu_s p, S_2 = c + mu_2 p and alpha = G dt (I_0 / d) sqrt(p / rho_s), the shear stress is
the smaller root of

    s^2 - (S_2 + t + alpha) s + S_2 t + S_0 alpha = 0.

Material under tension, which cohesion allows, has no rate dependence. mu_2 = mu_s gives Drucker-Prager.
"""

from __future__ import annotations

from math import asin, degrees, inf, sqrt
from typing import Any, Literal, NamedTuple

import numpy as np

from mpmcol.mpm.constitutive.elastic import Derived, Elasticity
from mpmcol.mpm.constitutive.failure import after_expansion, remaining
from mpmcol.mpm.constitutive.failure import after_opening as after_opening
from mpmcol.mpm.constitutive.invariants import active_ratio, return_from_tension
from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import sqrt as root
from mpmcol.mpm.simd import where_positive
from mpmcol.units import option, quantity

STATE: tuple[str, ...] = ()
INVARIANTS = True


class Material(Elasticity):
    """[material] with law = "mu-i"."""

    law: Literal["mu-i"] = option("constitutive law", "mu-i")
    mu_s: float = quantity(
        'friction coefficient mu_s at vanishing rate, or an angle such as "21 deg"', gt=0.0, lt=1.0, is_tangent=True
    )
    mu_2: float = quantity(
        'friction coefficient mu_2 at large rates, or an angle such as "33 deg"', gt=0.0, le=10.0, is_tangent=True
    )
    I_0: float = quantity("inertial number at which mu is midway between mu_s and mu_2", gt=0.0)
    grain_diameter: float = quantity("diameter d of the grains", "m", gt=0.0)
    grain_density: float = quantity(
        "density rho_s of the grains, larger than that of the bulk material (density)", "kg/m3", gt=0.0
    )
    cohesion: float = quantity("cohesion c", "Pa", 0.0, ge=0.0)
    failure_strain: float = quantity(
        "plastic volumetric strain at the apex, under tension, beyond which a point loses its cohesion; 0: once it has "
        "reached the apex; inf: never",
        "", inf, ge=0.0, allow_inf=True,
    )  # fmt: skip

    @property
    def friction_deg(self) -> float:
        """Friction angle of Mohr-Coulomb with the same strength in plane strain at vanishing rate, degrees."""
        return degrees(asin(self.mu_s))

    @property
    def active_pressure_ratio(self) -> float:
        """Ratio of horizontal to vertical stress at active yield."""
        return active_ratio(self.mu_s)

    @property
    def mobilised_friction(self) -> float:
        """Ratio of shear to normal stress of a layer in slow shear."""
        return self.mu_s


class MuIParams(NamedTuple):
    """Moduli (Pa), mu_s, mu_2 - mu_s, I_0, (I_0 / d) / sqrt(rho_s) (SI), c and mean stress at the apex (Pa), and the
    strain that ends both.
    """

    bulk_modulus: float
    shear_modulus: float
    mu_s: float
    mu_excess: float
    I_0: float
    rate_scale: float
    cohesion: float
    apex: float
    failure_strain: float


PARAMS = MuIParams


def inertial_number(mean: np.ndarray, shear: np.ndarray, history: Any, params: MuIParams) -> np.ndarray:
    """I of the last step (n,), from the stress that the return has left: I_0 (mu - mu_s) / (mu_2 - mu).

    0 without flow, without pressure, and without dependence on the rate.
    """
    strength = remaining(params.cohesion, history, params) - params.mu_s * mean
    fast, flowing = params.mu_excess * np.maximum(-mean, 0.0), (shear > strength) & (mean < 0.0)
    rest = np.maximum(fast - (shear - strength), np.finfo(float).eps * fast)
    return params.I_0 * np.where(flowing & (fast > 0.0), (shear - strength) / np.where(fast > 0.0, rest, 1.0), 0.0)


DERIVED: dict[str, Derived] = {"inertial_number": inertial_number}


def friction_of(number: np.ndarray, material: Material) -> np.ndarray:
    """mu(I)."""
    return material.mu_s + (material.mu_2 - material.mu_s) * number / (material.I_0 + number)


def well_posed(number: np.ndarray, material: Material) -> np.ndarray:
    """Whether the equations of incompressible flow are well-posed at I (n,).

    Barker, Schaeffer, Bohorquez & Gray 2015 (doi:10.1017/jfm.2015.412): with n = I mu'(I) / mu(I),
    4 n^2 - 4 n + mu^2 (1 - n / 2)^2 <= 0.
    """
    mu = friction_of(number, material)
    n = number * (material.mu_2 - material.mu_s) * material.I_0 / (material.I_0 + number) ** 2 / mu
    return 4.0 * n**2 - 4.0 * n + mu**2 * (1.0 - 0.5 * n) ** 2 <= 0.0


def make_params(material: Material) -> MuIParams:
    """The parameters of the formulas."""
    return MuIParams(
        material.bulk_modulus,
        material.shear_modulus,
        material.mu_s,
        material.mu_2 - material.mu_s,
        material.I_0,
        material.I_0 / (material.grain_diameter * sqrt(material.grain_density)),
        material.cohesion,
        material.cohesion / material.mu_s,
        material.failure_strain if material.cohesion > 0.0 else inf,
    )


@device
def may_yield(mean, shear, history, params):
    """Shear stress above the strength at vanishing rate."""
    return shear - (remaining(params.cohesion, history, params) - params.mu_s * mean)


@device
def apex(history, params):
    """Mean stress of an opened point, Pa."""
    return remaining(params.apex, history, params)


@device
def return_map(mean, shear, history, params, dt):
    """Return mean and shear stress with the strength at the rate of this step; see `ConstitutiveLaw.return_map`."""
    pressure = where_positive(mean, 0.0, -mean)
    slow, excess = remaining(params.cohesion, history, params) - params.mu_s * mean, params.mu_excess * pressure
    alpha = (params.shear_modulus * params.rate_scale * dt) * root(pressure)
    fast = slow + excess
    # B^2 - 4 H without cancellation
    difference = shear - fast + alpha
    discriminant = difference * difference + 4.0 * (alpha * excess)
    sums = fast + shear + alpha + root(discriminant)  # 0 without stress and strength, as is then the product
    flowing = 2.0 * (fast * shear + slow * alpha) / where_positive(sums, sums, 1.0)
    limit = apex(history, params)
    new_mean, new_shear, released, opens = return_from_tension(mean, flowing, limit, params.bulk_modulus)
    new_history = after_expansion(history, released, params)
    return new_mean, new_shear, new_history, released, where_positive(opens, opens, shear - flowing)
