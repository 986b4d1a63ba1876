"""Flow without change of volume on a grid that has too few ways to keep its volume."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.scenario import Reading, Scene, Trial
from mpmcol.failure_modes.toolkit import PLAIN, advance_to, elastic_body, lattice, make_solver, points_at, walled_grid
from mpmcol.mpm.particles import Points
from mpmcol.mpm.settings import PAPER, Scheme

H, ACROSS, ALONG = 0.1, 4, 16  # m; cells across and along the beam
DENSITY, YOUNG = 1000.0, 1e6
LIGHT = 1e-4  # of the weight over the modulus: the beam's end sinks by less than a twentieth of a cell
PERIODS = 4  # of the beam's own time until it hardly moves
LINEAR, CELLS = Scheme(basis="linear"), Scheme(volumetric_strain="cell")


def stiffness(nu: float, scheme: Scheme) -> Reading:
    """What theory says that the end of a cantilever sinks under its own weight, over what it sinks, less one.

    Timoshenko's beam in plane strain, its shear factor 5/6; the mean over the last of some damped periods.
    """
    low, length, height = 6 * H, ALONG * H, ACROSS * H
    modulus, shear = YOUNG / (1.0 - nu**2), 0.5 * YOUNG / (1.0 + nu)
    gravity = LIGHT * modulus / (DENSITY * length)
    bending = DENSITY * gravity * 12.0 * length**4 / (8.0 * modulus * height**2)
    expected = bending + DENSITY * gravity * length**2 / (2.0 * 5.0 / 6.0 * shear)
    points = points_at(lattice((0.0, low), (length, low + height), H / 2), H / 2, density=DENSITY)
    start = _end_height(points, length)
    grid = walled_grid((0.0, 0.0), H, (ALONG + 4, ACROSS + 12), no_slip="left")
    settings = PLAIN._replace(gravity_y=-gravity, alpha_d=0.2)
    solver = make_solver(points, grid, settings, body=elastic_body(DENSITY, YOUNG, nu), scheme=scheme)
    period = 2.0 * np.pi / 3.516 * length**2 / np.sqrt(modulus * height**2 / (12.0 * DENSITY))
    sunk = []
    for k in range(1, 8 * PERIODS + 1):
        advance_to(solver, period * k / 8.0)
        sunk.append(start - _end_height(solver.points, length))
    bulk = 2.0 / 3.0 * (1.0 + nu) / (1.0 - 2.0 * nu)
    return Reading(float(expected / np.mean(sunk[-8:]) - 1.0), f"K / G = {bulk:.3g}")


def _end_height(points: Points, length: float) -> float:
    """Mean height of the beam's last points, m."""
    return float(points.x[points.x[:, 0] > length - 0.5 * H, 1].mean())


SCENES = (
    Scene(
        name="locking",
        mechanism="A beam that bends keeps its volume, its image on the grid cannot at every point: the false volume "
        "is stiff, and more so the less compressible the material.",
        sign="stiffness of a cantilever over that of a beam, less one",
        unit="",
        bound=0.2,
        source="beam theory with shear; four cells across are 2 to 4 % too stiff where nothing locks (nu = 0.2)",
        remedy="method.volumetric_strain = cell (a column of sand then slumps by 1 to 2 % more); or quadratic splines "
        "and nu of at most 0.49",
        trials=(
            Trial("linear, nu = 0.49", False, partial(stiffness, 0.49, LINEAR)),
            Trial("linear, cells, nu = 0.49", True, partial(stiffness, 0.49, CELLS._replace(basis="linear"))),
            Trial("quadratic, nu = 0.499", False, partial(stiffness, 0.499, PAPER), default=True),
            Trial("quadratic, cells, nu = 0.499", True, partial(stiffness, 0.499, CELLS)),
            Trial("quadratic, nu = 0.49", True, partial(stiffness, 0.49, PAPER), default=True),
            Trial("quadratic, nu = 0.2", True, partial(stiffness, 0.2, PAPER), default=True),
        ),
    ),
)
