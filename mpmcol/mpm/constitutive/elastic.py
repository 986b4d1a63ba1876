"""Isotropic linear elasticity (hypoelastic: Jaumann rate, Eq. 33), without yield."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, NamedTuple

import numpy as np

from mpmcol.mpm.jit import device
from mpmcol.units import Table, option, quantity

Derived = Callable[[np.ndarray, np.ndarray, Any, Any], np.ndarray]

STATE: tuple[str, ...] = ()
INVARIANTS = False
DERIVED: dict[str, Derived] = {}


class Elasticity(Table):
    """Keys of every material."""

    density: float = quantity("initial density", "kg/m3", gt=0.0)
    youngs_modulus: float = quantity("Young's modulus E", "Pa", gt=0.0)
    poissons_ratio: float = quantity("Poisson's ratio nu", ge=0.0, lt=0.5)

    @property
    def bulk_modulus(self) -> float:
        """K = E / (3 (1 - 2 nu)), Pa."""
        return self.youngs_modulus / (3.0 * (1.0 - 2.0 * self.poissons_ratio))

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)), Pa."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))

    @property
    def wave_speed(self) -> float:
        """Speed of compression waves at the initial density, Eq. 36, m/s."""
        return float(((self.bulk_modulus + 4.0 / 3.0 * self.shear_modulus) / self.density) ** 0.5)

    def initial_history(self, x: np.ndarray) -> np.ndarray:
        """History variables (n, 2) of points at positions x (n, d), m, before the first step: zero."""
        return np.zeros((len(x), 2))


class Material(Elasticity):
    """[material] with law = "elastic"."""

    law: Literal["elastic"] = option("constitutive law", "elastic")


class ElasticParams(NamedTuple):
    """Moduli, Pa."""

    bulk_modulus: float
    shear_modulus: float


PARAMS = ElasticParams


def make_params(material: Elasticity) -> ElasticParams:
    """Elastic moduli of any material."""
    return ElasticParams(material.bulk_modulus, material.shear_modulus)


@device
def may_yield(s1, s3, history, params):
    """Zero: elastic points never yield."""
    return 0.0


@device
def return_map(s1, s2, s3, history, params, dt):
    """The trial stress itself."""
    return s1, s2, s3, history, 0.0, 0.0


@device
def apex(history, params):
    """Infinite: elastic points never open."""
    return np.inf


@device
def after_opening(history, opening, params):
    """The history itself: opening changes nothing."""
    return history
