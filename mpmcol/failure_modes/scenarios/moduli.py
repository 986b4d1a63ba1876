"""What stiffness does: nearly incompressible material, transfers that lose the gradient, soft and fast material."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.problems.single_particle import GROWN, growth
from mpmcol.failure_modes.scenario import Reading, Scene, Trial
from mpmcol.failure_modes.scenarios.time_step import DEFAULT_CFL, SIGN, SOURCE, UNIT, bound_theory, lone_point_trials
from mpmcol.failure_modes.toolkit import (
    DENSITY,
    PLAIN,
    WEIGHTLESS,
    G,
    advance_to,
    elastic_body,
    lattice,
    make_solver,
    points_at,
    sand_body,
    walled_grid,
)
from mpmcol.mpm.particles import COLUMN
from mpmcol.setup.model import free_speed
from mpmcol.setup.stability_limit import BETWEEN, LonePoint

STIFF = LonePoint((BETWEEN,) * 3, nu=0.49)
FLIP = LonePoint((BETWEEN,) * 3, transfer="flip")
APIC = LonePoint((BETWEEN,) * 2, transfer="apic")
H = 0.1
DROP = 3.15  # m: the height of a column of a = 35 on a radius of 90 mm
FALL_SPEED = float(np.sqrt(2.0 * G * DROP))


def squeezed(young: float) -> Reading:
    """An elastic column, 1 m high between rollers, whose weight comes at once."""
    points = points_at(lattice((0.0, 0.0), (2 * H, 1.0), H / 2), H / 2)
    grid = walled_grid((0.0, 0.0), H, (2, 14), rollers="left right bottom")
    body = elastic_body(youngs_modulus=young)
    solver = make_solver(points, grid, PLAIN, body=body)
    period, least = 4.0 / np.sqrt(body.wave_speed2), 1.0
    for k in range(1, 31):
        advance_to(solver, period * k / 30.0)
        least = min(least, float(solver.points.J.min()))
    return Reading(1.0 - least, f"rho g H / M = {DENSITY * G / (body.wave_speed2 * DENSITY):.2g}")


def flight(young: float, free: float) -> Reading:
    """A block of loose sand that flies as fast as one that fell from 3.15 m; `free` is what a check lets pass, m/s."""
    points = points_at(lattice((0.5, 0.5), (0.8, 0.8), H / 2), H / 2, COLUMN)
    points.v[:, 0] = FALL_SPEED
    body = sand_body(youngs_modulus=young)
    solver = make_solver(points, walled_grid((0.0, 0.0), H, (25, 12)), WEIGHTLESS._replace(free_speed=free), body)
    start = points.x[:, 0].mean()
    advance_to(solver, 0.1)
    moved = float(solver.points.x[:, 0].mean() - start)
    return Reading(
        abs(moved / (FALL_SPEED * solver.time) - 1.0), f"{FALL_SPEED / np.sqrt(body.wave_speed2):.2g} of the wave speed"
    )


def impact(mach: float) -> float:
    """An elastic block that meets a smooth wall."""
    points = points_at(lattice((0.0, 0.5), (1.0, 1.5), H / 2), H / 2)
    body = elastic_body()
    c = float(np.sqrt(body.wave_speed2))
    points.v[:, 0] = -mach * c
    solver = make_solver(points, walled_grid((0.0, 0.0), H, (30, 20), rollers="left"), WEIGHTLESS, body=body)
    least = 1.0
    for k in range(1, 41):
        advance_to(solver, 0.1 * k / c)
        least = min(least, float(solver.points.J.min()))
    return 1.0 - least


SCENES = (
    Scene(
        name="incompressible-3d",
        mechanism="A lone point of nu = 0.49 in three dimensions: three axes act on one stiff volume, three times one "
        "of them.",
        sign=SIGN,
        unit=UNIT,
        bound=GROWN,
        source=SOURCE,
        remedy="time.cfl = 0.45 for nu above 0.45 in 3D (bound 0.471 at nu = 0.5), as the run says",
        trials=lone_point_trials(STIFF, default_stands=False),
        theory=bound_theory(STIFF),
    ),
    Scene(
        name="time-step-flip",
        mechanism="A lone point without the Taylor term forgets its rate of strain: its bound is 0.71 of the other.",
        sign=SIGN,
        unit=UNIT,
        bound=GROWN,
        source=SOURCE,
        remedy="taylor-flip (the default) or tpic, which keep it; with flip or pic time.cfl = 0.4 in 3D, as runs say",
        trials=(
            Trial(f"flip, cfl = {DEFAULT_CFL}, the default", False, partial(growth, FLIP, DEFAULT_CFL)),
            Trial("flip, cfl = 0.44", True, partial(growth, FLIP, 0.44)),
            Trial("taylor-flip", True, partial(growth, LonePoint(FLIP.place), DEFAULT_CFL), default=True),
        ),
        theory=bound_theory(FLIP),
    ),
    Scene(
        name="time-step-apic",
        mechanism="A lone point half-way between nodes keeps two thirds of its rate of strain in APIC's affine matrix: "
        "its bound is 0.87 of the other.",
        sign=SIGN,
        unit=UNIT,
        bound=GROWN,
        source=SOURCE,
        remedy="time.cfl below 0.55 in 3D and 0.6 in 2D (nu = 0.2), as the default is",
        trials=lone_point_trials(APIC),
        theory=bound_theory(APIC),
    ),
    Scene(
        name="soft-column",
        mechanism="A column so soft that its own weight is no small part of its modulus: the hypoelastic law is "
        "squeezed flat.",
        sign="largest loss of volume, 1 - J",
        unit="",
        bound=0.1,
        source="a tenth; weight that comes at once squeezes the foot by 2 rho g H / M",
        remedy="youngs_modulus of at least 20 rho g H",
        trials=(
            Trial("E = 20 kPa", False, partial(squeezed, 2e4)),
            Trial("E = 1 MPa", True, partial(squeezed, 1e6)),
        ),
    ),
    Scene(
        name="soft-flight",
        mechanism=f"Loose sand that falls faster than its own waves ({FALL_SPEED:.1f} m/s after {DROP} m) harms "
        "nothing, but a check that takes all faster points for a fault stops it.",
        sign="error of the distance flown",
        unit="",
        bound=1e-9,
        source="free flight is exact",
        remedy="a check that knows what speed gravity can give, the default",
        trials=(
            Trial("E = 0.1 MPa, waves as the limit", False, partial(flight, 1e5, 0.0)),
            Trial("E = 0.1 MPa, waves or gravity", True, partial(flight, 1e5, free_speed(G, DROP)), default=True),
            Trial("E = 10 MPa, waves or gravity", True, partial(flight, 1e7, free_speed(G, DROP)), default=True),
        ),
    ),
    Scene(
        name="impact",
        mechanism="A block that meets a wall at a good part of its wave speed is squeezed far beyond what its law is "
        "meant for.",
        sign="largest loss of volume, 1 - J",
        unit="",
        bound=0.25,
        source="a weak shock squeezes by v / c; above 0.6 c the solver stops, since points are faster than their waves",
        remedy="impacts below a fifth of the wave speed, by a stiffer material",
        trials=(
            Trial("v = 0.9 c", False, partial(impact, 0.9)),
            Trial("v = 0.5 c", False, partial(impact, 0.5)),
            Trial("v = 0.1 c", True, partial(impact, 0.1)),
        ),
    ),
)
