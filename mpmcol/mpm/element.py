"""One material point under a prescribed velocity gradient, by the compiled stress update of the steps."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import driver, variant
from mpmcol.mpm.kernels.stress import make_stress_update


@cache
def make_element_step(law: ConstitutiveLaw) -> Callable[..., Any]:
    """The compiled update of one point in three dimensions.

    (stress xx yy zz xy yz xz, velocity gradient xx xy xz yx yy yz zx zy zz, J, opening strain, history, params,
    settings, dt) -> (stress, J, opening strain, history); Pa, 1/s, s. Eq. 29-34.
    """
    stress_update = make_stress_update(3, law)

    @driver
    @variant(law)
    def element_step(
        sigma: Any, gradient: Any, J: float, opening: float, history: Any, params: Any, settings: Any, dt: float
    ) -> Any:
        sigma, J, opening, history, _ = stress_update(sigma, gradient, 1.0, J, opening, history, params, settings, dt)
        return sigma, J, opening, history

    return element_step
