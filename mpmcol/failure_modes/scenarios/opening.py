"""Separation of sand: tension, and volume after separated material comes into contact again."""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.collapse import collapsed
from mpmcol.failure_modes.problems.sand import H, stacked_layers
from mpmcol.failure_modes.scenario import Observation, Scenario, failing, passing
from mpmcol.failure_modes.toolkit import (
    WEIGHTLESS,
    Body,
    advance_steps,
    joined,
    lattice,
    make_solver,
    points_at,
    sand_body,
    walled_grid,
)
from mpmcol.mpm.particles import BASE, COLUMN

SPEED = 0.5  # m/s of each block


def speed_lost(sand: Body | None) -> Observation:
    """Relative loss of speed of two touching blocks that separate, without gravity, in 600 steps; None: elastic."""
    kind = COLUMN if sand else BASE
    left = points_at(lattice((0.2, 0.2), (0.3, 0.3), H / 2), H / 2, kind)
    right = points_at(lattice((0.3, 0.2), (0.4, 0.3), H / 2), H / 2, kind)
    left.v[:, 0], right.v[:, 0] = -SPEED, SPEED
    solver = make_solver(joined(left, right), walled_grid((0.0, 0.0), H, (60, 40)), WEIGHTLESS, sand)
    tension = 0.0
    for _ in range(30):
        advance_steps(solver, 20)
        tension = max(tension, float(solver.points.sigma[:, :3].max()))
    mean = float(solver.points.v[solver.points.id >= len(left), 0].mean())
    return Observation(1.0 - mean / SPEED, f"largest tension {tension:.2g} Pa")


def area_gain(opening_strain: bool) -> Observation:
    """Relative gain of area of layers of sand that separate and settle again."""
    found = stacked_layers(opening_strain)
    note = f"height {found.height:.3f} of the initial height, largest J {found.largest_J:.3f}"
    return Observation(abs(found.area - 1.0), note, (found.times, found.areas))


def largest_volume_ratio(opening_strain: bool, spacing: str) -> Observation:
    """Largest J in the collapse of a column with a = 1."""
    opening = f"method.opening_strain={str(opening_strain).lower()}"
    found = collapsed("coarse-channel", f"grid.spacing={spacing}", opening)
    return Observation(found.largest_J, f"zeta {found.zeta:.3f}")


SCENARIOS = (
    Scenario(
        name="tension",
        mechanism="Cohesion, often added in small amounts for stability, lets sand carry tension: separating material "
        "is held back.",
        metric="speed lost by two separating blocks, over their speed",
        bound=0.01,
        source="chosen here: 1 %; cohesionless blocks separate freely",
        remedy="material.cohesion = 0; the return to the apex is exact, so that no cohesion is needed for stability",
        trials=(
            failing("cohesion = 1 kPa", partial(speed_lost, sand_body(cohesion=1e3))),
            failing("elastic", partial(speed_lost, None)),
            passing("cohesion = 0", partial(speed_lost, sand_body()), default=True),
        ),
    ),
    Scenario(
        name="opening-volume",
        mechanism="A rate law without memory of the separation builds up pressure at the first compressive increment, "
        "although J > 1: gaps become volume of sand.",
        metric="relative area gained by layers that separate and settle again",
        bound=0.01,
        source="chosen here: 1 %; mass is conserved, and with psi = 0 the volume of closed sand",
        remedy="method.opening_strain = true, the default",
        trials=(
            failing("opening_strain = false", partial(area_gain, False)),
            passing("opening_strain = true", partial(area_gain, True), default=True),
        ),
        axes=("time (s)", "area over initial area (-)"),
        slow=True,
    ),
    Scenario(
        name="opening-toe",
        mechanism="A stress-free material point detached ahead of the toe dilates without bound, because no stress "
        "limits its volume.",
        metric="largest volume ratio J in a collapse, a = 1",
        bound=1.5,
        source="chosen here: 1.5; sand with psi = 0 keeps its volume",
        remedy="method.opening_strain = true, the default",
        trials=(
            failing("opening_strain = false, h = 5 mm", partial(largest_volume_ratio, False, "5 mm")),
            failing("opening_strain = false, h = 2 mm", partial(largest_volume_ratio, False, "2 mm")),
            passing("opening_strain = true, h = 5 mm", partial(largest_volume_ratio, True, "5 mm"), default=True),
        ),
        slow=True,
    ),
)
