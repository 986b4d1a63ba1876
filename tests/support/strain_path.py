"""One material point driven by a given velocity gradient."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import driver, variant
from mpmcol.mpm.kernels.stress import make_stress_update


@cache
def make_path(d: int, law: ConstitutiveLaw) -> Callable[..., Any]:
    """The compiled loop over steps of equal strain."""
    stress_update = make_stress_update(d, law)

    @driver
    @variant(d, law)
    def path(sigma, gradient, params, settings, steps):
        J, opening, history = 1.0, 0.0, (0.0, 0.0)
        for _ in range(steps):
            sigma, J, opening, history, _ = stress_update(
                sigma, gradient, 1.0, J, opening, history, params, settings, 1.0 / steps
            )
        return sigma, J

    return path
