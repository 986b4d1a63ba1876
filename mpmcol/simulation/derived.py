"""History of the laws of points by name, and quantities that follow from it and the stress (`DERIVED` of a law)."""

from __future__ import annotations

import numpy as np

from mpmcol.case import Case
from mpmcol.mpm.constitutive import LAWS
from mpmcol.mpm.particles import Points


def history_of_laws(case: Case, points: Points) -> dict[str, np.ndarray]:
    """History variables (n,) of the laws by name; zero for points of materials without the variable."""
    laws = [(kind, LAWS[material.law].STATE) for kind, material in enumerate(case.materials)]
    found = {name: np.zeros(len(points)) for _, names in laws for name in names}
    for kind, names in laws:
        own = points.kind == kind
        for k, name in enumerate(names):
            found[name][own] = points.history[own, k]
    return found


def derived_quantities(case: Case, points: Points) -> dict[str, np.ndarray]:
    """Arrays (n,) by name; zero for points of materials without the quantity."""
    laws = [(kind, LAWS[material.law], material) for kind, material in enumerate(case.materials)]
    found = {name: np.zeros(len(points)) for _, law, _ in laws for name in law.DERIVED}
    if not found:
        return found
    (mean, shear), history = _invariants(points.sigma), points.history.T
    for kind, law, material in laws:
        own, params = points.kind == kind, law.make_params(material)
        for name, function in law.DERIVED.items():
            found[name][own] = function(mean[own], shear[own], history[:, own], params)
    return found


def _invariants(sigma: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean stress and sqrt(J2) (n,) of stresses xx yy zz xy yz xz (n, 6)."""
    mean = sigma[:, :3].mean(axis=1)
    deviator2 = ((sigma[:, :3] - mean[:, None]) ** 2).sum(axis=1)
    return mean, np.sqrt(0.5 * deviator2 + (sigma[:, 3:] ** 2).sum(axis=1))
