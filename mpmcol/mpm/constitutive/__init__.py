"""Constitutive laws. A new law is one module here that satisfies `ConstitutiveLaw`, and one line in `LAWS`."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any, Protocol

from mpmcol.mpm.constitutive import (
    drucker_prager,
    elastic,
    mohr_coulomb,
    mohr_coulomb_random,
    mohr_coulomb_softening,
    mu_i,
)
from mpmcol.mpm.constitutive.elastic import Derived, Elasticity


class ConstitutiveLaw(Hashable, Protocol):
    """What the module of a constitutive law defines.

    Stresses are in Pa, tension > 0: either the principal Cauchy stresses s1 >= s2 >= s3, or, with INVARIANTS, the mean
    stress and the shear stress sqrt(J2) >= 0, where the return keeps the direction of the deviator. The functions of
    stresses are compiled (`@device`) and take numbers, or vectors of eight points: they have no branches and select
    with `where_positive`. They also run in plain Python.
    """

    __name__: str

    @property
    def STATE(self) -> tuple[str, ...]:
        """Names of the history variables, at most two.

        The first may only grow with strain, the second is constant; `Material.initial_history` gives their initial
        values, by default zero.
        """

    @property
    def INVARIANTS(self) -> bool:
        """Whether the functions of stresses take invariants instead of principal stresses."""

    @property
    def DERIVED(self) -> dict[str, Derived]:
        """Quantities that follow from the state of a point: name -> function (mean, shear, history, params).

        mean, shear: mean stress and sqrt(J2) (n,), Pa; history: a pair of (n,). Returns (n,).
        """

    @property
    def Material(self) -> type[Elasticity]:
        """Keys of the [material] table of a case file, with units, bounds and defaults."""

    @property
    def PARAMS(self) -> Any:
        """Class of the parameters: a NamedTuple of floats, among them bulk_modulus and shear_modulus (Pa).

        It needs a name that no other law uses: Numba's disk cache identifies compiled code by it.
        """

    def make_params(self, material: Any) -> Any:
        """Parameters of a `Material`."""

    @property
    def may_yield(self) -> Any:
        """(s1, s3, history, params) or (mean, shear, history, params).

        Returns a number above zero wherever `return_map` may change the stress.
        """

    @property
    def return_map(self) -> Any:
        """(s1, s2, s3, history, params, dt) or (mean, shear, history, params, dt): return a trial stress to the yield
        surface.

        dt: duration of the step, s; 0 gives the return to the largest strength of a law that depends on the rate.
        Returns the stress in the same form, the new history (a pair), the volumetric strain released at the apex of the
        surface, and the yield function of the trial stress, in Pa. Only meaningful where the last is above zero.
        """

    def apex(self, history: Any, params: Any) -> Any:
        """Mean stress of a point that has opened, Pa."""

    @property
    def after_opening(self) -> Any:
        """(history, opening, params): the history of a point after a step that left it with this opening strain."""


LAWS: dict[str, ConstitutiveLaw] = {
    "elastic": elastic,
    "mohr-coulomb": mohr_coulomb,
    "mohr-coulomb-softening": mohr_coulomb_softening,
    "mohr-coulomb-random": mohr_coulomb_random,
    "drucker-prager": drucker_prager,
    "mu-i": mu_i,
}
