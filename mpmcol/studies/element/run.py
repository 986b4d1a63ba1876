"""The element test of a law: stresses and strains along a path, from an isotropic stress."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import brentq

from mpmcol.case import Case
from mpmcol.errors import UsageError
from mpmcol.mpm.constitutive import LAWS
from mpmcol.mpm.constitutive.invariants import invariants_of
from mpmcol.mpm.element import make_element_step
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.threads import compiled_calls
from mpmcol.studies.element.paths import StrainPath

COMPONENTS = ("xx", "yy", "zz", "xy")
WIDEST = 10.0  # of the rate of the strain: limit of the rate that keeps a stress constant

State = tuple[tuple[float, ...], float, float, tuple[float, float]]  # stress, J, opening strain, history
Columns = dict[str, np.ndarray]


def element_test(case: Case, path: StrainPath, pressure: float, strain: float, steps: int, rate: float) -> Columns:
    """Columns of an element test by name, each (steps + 1,); see `mpmcol explain element.csv`.

    Args:
        case: its material is tested.
        path: a member of PATHS.
        pressure: initial isotropic pressure, Pa.
        strain: at the end, of the kind that the path states.
        steps: number of equal steps.
        rate: of the strain, 1/s.

    Raises:
        UsageError: no rate keeps the controlled stress, as after a failure in tension.
    """
    law, dt = LAWS[case.material.law], strain / steps / rate
    params, settings = law.make_params(case.material), Settings(gravity_y=0.0)
    compiled = make_element_step(law)

    def advance(state: State, free_rate: float) -> State:
        gradient = tuple(rate * entry for entry in path.gradient(free_rate))
        new: State = compiled(state[0], gradient, *state[1:], params, settings, dt)
        return new

    states: list[State] = [((-pressure, -pressure, -pressure, 0.0, 0.0, 0.0), 1.0, 0.0, (0.0, 0.0))]
    with compiled_calls(compiling=True):
        for number in range(steps):
            free_rate = _free_rate(advance, states[-1], path, pressure, number) if path.free else 0.0
            states.append(advance(states[-1], free_rate))
    return _columns(case, states, np.linspace(0.0, strain, steps + 1))


def _free_rate(
    advance: Callable[[State, float], State], state: State, path: StrainPath, pressure: float, number: int
) -> float:
    """The rate of the free entries, over that of the strain, that keeps the controlled stress."""

    def excess(free_rate: float) -> float:
        return advance(state, free_rate)[0][path.controlled] + pressure

    if excess(-WIDEST) * excess(WIDEST) > 0.0:
        raise UsageError(
            f"step {number + 1}: no strain keeps the stress at -{pressure:g} Pa; set a smaller --strain or more --steps"
        )
    return float(brentq(excess, -WIDEST, WIDEST, xtol=1e-13, rtol=1e-13))


def _columns(case: Case, states: list[State], strain: np.ndarray) -> Columns:
    law = LAWS[case.material.law]
    stress = np.array([state[0] for state in states])
    J, opening = (np.array([state[k] for state in states], dtype=float) for k in (1, 2))
    principal = -np.sort(-np.linalg.eigvalsh(_tensors(stress)), axis=1).T
    mean, shear = invariants_of(*principal)
    sums, differences = principal[0] + principal[2], principal[0] - principal[2]
    ratio = np.divide(differences, -sums, out=np.zeros_like(sums), where=sums < 0.0)
    columns = {"strain": strain, **{f"stress.{name}": stress[:, k] for k, name in enumerate(COMPONENTS)}}
    columns |= {
        "pressure": -mean,
        "shear": shear,
        "max_shear": differences / 2.0,
        "volumetric_strain": J * (1.0 + opening) - 1.0,
    }
    columns |= {"opening_strain": opening, "mobilised_deg": np.degrees(np.arcsin(np.clip(ratio, 0.0, 1.0)))}
    history = np.array([state[3] for state in states])
    columns |= {name: history[:, k] for k, name in enumerate(law.STATE)}
    params: Any = law.make_params(case.material)
    return columns | {name: function(mean, shear, history.T, params) for name, function in law.DERIVED.items()}


def _tensors(stress: np.ndarray) -> np.ndarray:
    """Stresses xx yy zz xy yz xz (n, 6) as (n, 3, 3)."""
    return stress[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
