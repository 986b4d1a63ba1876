"""One material point driven by a given velocity gradient."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

from mpmcol.mpm.jit import driver, variant
from mpmcol.mpm.kernels import stress_2d, stress_3d


@cache
def make_path(d: int, law: ModuleType) -> Callable[..., Any]:
    """The compiled loop over steps of equal strain."""
    formula = (stress_2d if d == 2 else stress_3d).make_formula(law)

    @driver
    @variant(d, law)
    def path(sigma, gradient, params, settings, steps):
        J, opening, history = 1.0, 0.0, (0.0, 0.0)
        for _ in range(steps):
            sigma, J, opening, history, _ = formula(
                sigma, gradient, 1.0, J, opening, history, params, settings, 1.0 / steps
            )
        return sigma, J

    return path
