"""Sand that comes apart: tension that must not be, volume that must come back."""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.collapse import collapsed
from mpmcol.failure_modes.problems.sand import H, stacked_layers
from mpmcol.failure_modes.scenario import Reading, Scene, Trial
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

SPEED = 0.5  # m/s: two blocks part at twice this


def speed_lost(sand: Body | None) -> Reading:
    """By two blocks that touch and fly apart without weight, in 600 steps, over their speed; elastic without sand."""
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
    return Reading(1.0 - mean / SPEED, f"largest tension {tension:.2g} Pa")


def area_gained(opening_strain: bool) -> Reading:
    """By a stack of sand whose layers are thrown apart and come together."""
    found = stacked_layers(opening_strain)
    note = f"height {found.height:.3f} of that at the start, largest J {found.largest_J:.3f}"
    return Reading(abs(found.area - 1.0), note, (found.times, found.areas))


def toe(opening_strain: bool, spacing: str) -> Reading:
    """Largest J of a collapsing column, a = 1."""
    found = collapsed("quickstart", f"grid.spacing={spacing}", f"method.opening_strain={str(opening_strain).lower()}")
    return Reading(found.largest_J, f"zeta {found.zeta:.3f}")


SCENES = (
    Scene(
        name="tension",
        mechanism="Sand without cohesion that holds on to itself: a little cohesion, often added for stability, ties "
        "grains.",
        sign="speed lost by two blocks that fly apart, over their speed",
        unit="",
        bound=0.01,
        source="nothing holds cohesionless blocks",
        remedy="cohesion = 0; the return to the cone's apex is exact, so that nothing else is needed",
        trials=(
            Trial("cohesion = 1 kPa", False, partial(speed_lost, sand_body(cohesion=1e3))),
            Trial("elastic", False, partial(speed_lost, None)),
            Trial("cohesion = 0", True, partial(speed_lost, sand_body()), default=True),
        ),
    ),
    Scene(
        name="opening-volume",
        mechanism="A law in rates that forgets how far sand has opened stresses it at the first touch: gaps become "
        "sand.",
        sign="area gained by layers thrown apart and fallen together",
        unit="",
        bound=0.01,
        source="mass is conserved, and so is closed volume",
        remedy="method.opening_strain = true, the default",
        trials=(
            Trial("opening_strain = false", False, partial(area_gained, False)),
            Trial("opening_strain = true", True, partial(area_gained, True), default=True),
        ),
        axes=("time (s)", "area over that at the start (-)"),
    ),
    Scene(
        name="opening-toe",
        mechanism="A lone grain ahead of the toe that has opened swells without end, since no stress says how large "
        "it is.",
        sign="largest volume ratio J in a collapse, a = 1",
        unit="",
        bound=1.5,
        source="sand of psi = 0 keeps its volume",
        remedy="method.opening_strain = true, the default",
        trials=(
            Trial("opening_strain = false, h = 5 mm", False, partial(toe, False, "5 mm")),
            Trial("opening_strain = false, h = 2 mm", False, partial(toe, False, "2 mm")),
            Trial("opening_strain = true, h = 5 mm", True, partial(toe, True, "5 mm"), default=True),
        ),
        slow=True,
    ),
)
