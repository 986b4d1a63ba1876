"""Energy ledger of a run: stored energies, and the work that damping, walls, plastic flow and the transfers take."""

from __future__ import annotations

import numpy as np

from mpmcol.case import Case
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.particles import BASE, Points
from mpmcol.mpm.solver import Solver

Energies = dict[str, float]


def stored_energies(case: Case, points: Points) -> Energies:
    """Potential, kinetic and elastic energy of all points, J (per metre or per radian in two dimensions)."""
    (xx, yy, zz, xy, yz, xz), is_base = points.sigma.T, points.kind == BASE
    bulk = np.where(is_base, case.base_material.bulk_modulus, case.material.bulk_modulus)
    shear = np.where(is_base, case.base_material.shear_modulus, case.material.shear_modulus)
    p = (xx + yy + zz) / 3.0
    deviator = (xx - p) ** 2 + (yy - p) ** 2 + (zz - p) ** 2 + 2.0 * (xy**2 + yz**2 + xz**2)
    gravity_x, gravity_y, _ = case.geometry.gravity_vector
    v2 = sum(v**2 for v in points.v.T)  # by component, since NumPy sums along short rows slowly
    return {
        "potential": -float(np.sum(points.m * gravity_x * points.x[:, 0] + points.m * gravity_y * points.x[:, 1])),
        "kinetic": float(0.5 * np.sum(points.m * v2)),
        "elastic": float(np.sum(points.V * (0.5 * p**2 / bulk + 0.25 * deviator / shear))),
    }


def energy_ledger(case: Case, solver: Solver, initial: Energies) -> Energies:
    """Energies and work since the ledger was started with the `initial` stored energies, J.

    potential + kinetic + elastic + plastic + filter + damping + walls + transfer = constant, up to `residual`.
    `filter` is the elastic energy that the stress filter takes, `plastic` the stress work that is neither stored nor
    taken by it; `transfer` is what P2G and G2P take from the kinetic energy of the points and from their stress work.
    """
    now, sums = stored_energies(case, solver.points), solver.ledger
    plastic = sums[loop.L_WORK] - sums[loop.L_FILTER] - (now["elastic"] - initial["elastic"])
    transfer = sums[loop.L_GRID] - (now["kinetic"] - initial["kinetic"])
    transfer += sums[loop.L_NODE_WORK] - sums[loop.L_WORK]
    lost = {
        "filter": sums[loop.L_FILTER],
        "damping": sums[loop.L_DAMPING],
        "walls": sums[loop.L_WALLS],
        "transfer": transfer,
    }
    residual = sum(now.values()) - sum(initial.values()) + plastic + sum(lost.values())
    return {name: float(value) for name, value in {**now, "plastic": plastic, **lost, "residual": residual}.items()}
