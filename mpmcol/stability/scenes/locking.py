"""Isochoric flow on a grid that has too few ways to keep its volume."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.stability.blocks import (
    WEIGHTLESS,
    advance_steps,
    by_id,
    elastic_body,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.stability.scene import Reading, Scene, Trial
from mpmcol.state import Scheme

H, CELLS = 0.1, 4  # across the beam


def parasitic_energy(nu: float, basis: str) -> Reading:
    """Rate of volumetric over that of deviatoric elastic energy in a beam that bends without change of volume.

    v_x = x y, v_y = -(x^2 + y^2) / 2, D_xx = y = -D_yy, from the middle of the beam; one step of a weightless body.
    """
    centre, corner = np.array([1.5, 1.5]) + 0.37 * H, np.array([5.0, 0.5]) * CELLS * H / 2
    points = points_at(centre + lattice(tuple(-corner), tuple(corner), H / 2), H / 2)
    x, y = (points.x - centre).T
    points.v[:] = 1e-3 * np.stack([x * y, -0.5 * (x**2 + y**2)], axis=1)
    gradient = np.zeros((len(x), 3, 3))
    gradient[:, 0, 0], gradient[:, 1, 1], gradient[:, 0, 1], gradient[:, 1, 0] = y, -y, x, -x
    points.grad_v = 1e-3 * gradient
    body = elastic_body(poissons_ratio=nu)
    solver = make_solver(
        points, walled_grid((0.0, 0.0), H, (30, 30)), WEIGHTLESS, body=body, scheme=Scheme(basis=basis)
    )
    advance_steps(solver, 1)
    L = by_id(solver).grad_v
    trace = np.trace(L, axis1=1, axis2=2)
    D = 0.5 * (L + L.transpose(0, 2, 1)) - trace[:, None, None] / 3.0 * np.eye(3)
    share = float(np.mean(trace**2) / np.mean(np.sum(D**2, axis=(1, 2))))
    ratio = body.params.bulk_modulus / body.params.shear_modulus
    return Reading(0.5 * ratio * share, f"K / G = {ratio:.3g}")


SCENES = (
    Scene(
        name="locking",
        mechanism="A beam that bends keeps its volume, its image on the grid does not: the false volume is stiff, and "
        "more so "
        "the less compressible the material.",
        sign="volumetric over deviatoric energy, which is to be zero",
        unit="",
        bound=1.0,
        source="as much false energy as true: the beam is twice as stiff as it should be",
        remedy="quadratic splines, nu of at most 0.4; volumetric strain averaged over a cell would remedy it",
        trials=(
            Trial("linear, nu = 0.49", False, partial(parasitic_energy, 0.49, "linear")),
            Trial("quadratic, nu = 0.499", False, partial(parasitic_energy, 0.499, "quadratic"), default=True),
            Trial("quadratic, nu = 0.49", True, partial(parasitic_energy, 0.49, "quadratic"), default=True),
            Trial("quadratic, nu = 0.2", True, partial(parasitic_energy, 0.2, "quadratic"), default=True),
        ),
    ),
)
