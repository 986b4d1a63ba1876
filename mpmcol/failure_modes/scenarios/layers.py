"""Layers of the column that are thinner than what the grid resolves."""

from __future__ import annotations

from functools import partial
from math import cos, radians, sin
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from mpmcol.case import load_case
from mpmcol.failure_modes.scenario import Observation, Scenario, failing, passing
from mpmcol.simulation.run import run

CELL, HEIGHT, SLOPE_DEG, WEAK_DEG = 0.005, 0.06, 20.0, 10.0  # m, m, degrees
BLOCK = (
    f"geometry.outline=[[0.1,0],[0.4,0],[0.4,{HEIGHT}],[0.1,{HEIGHT}]]", "stages.gate=false", "geometry.base=rigid",
    f"geometry.slope_deg={SLOPE_DEG}", f"grid.spacing={CELL}", "grid.points_per_cell=4", "material.cohesion=1e4",
    "material.youngs_modulus=2e6", "method.wall_impulse=true", "stages.initial_stress=k0",
    "stages.collapse.max_time_factor=1", "stages.collapse.end=time", "output.snapshots=1",
)  # fmt: skip  # of cohesive material that does not fail; the floor is without slip


def missing_slide(cells: float) -> Observation:
    """Difference of the displacement of a block on a weak layer of so many cells from that of a rigid one, over it."""
    layer = f"layers=[{{from=0, to={cells * CELL}, material={{friction_deg={WEAK_DEG}, cohesion=0}}}}]"
    with TemporaryDirectory() as folder:
        last = run(load_case("channel", [*BLOCK, layer]), Path(folder) / "run", threads=1).snapshot(-1)
    upper = (last.x - last.arrays["displacement"][:, :2])[:, 1] > HEIGHT / 2.0
    slid = float(np.median(last.arrays["displacement"][upper, 0]))
    slope = radians(SLOPE_DEG)
    acceleration = 9.81 * (sin(slope) - cos(slope) * sin(radians(WEAK_DEG)))  # shear mobilises sin(phi) without psi
    expected = acceleration * last.time**2 / 2.0
    return Observation(abs(slid / expected - 1.0), f"slid {1e3 * slid:.2g} of {1e3 * expected:.2g} mm")


SCENARIOS = (
    Scenario(
        name="layer-thin",
        mechanism="A weak layer is thinner than the support of the shape functions: its points have the strain rates "
        "of the strong material beside it, which carries the shear, and nothing slides.",
        metric=f"difference in the slide of a block on a weak layer, slope of {SLOPE_DEG:g} degrees, over its value",
        bound=0.25,
        source="chosen here: 25 %; a rigid block slides by g (sin(slope) - sin(phi) cos(slope)) t^2 / 2, of which the "
        "edges of a layer of four cells, which is squeezed out, change a fifth",
        remedy="a grid.spacing with two or more cells in each of [[layers]]; a run with a thinner one has a note",
        trials=(
            failing("layer of half a cell", partial(missing_slide, 0.5)),
            failing("layer of one cell", partial(missing_slide, 1.0)),
            passing("layer of two cells", partial(missing_slide, 2.0)),
            passing("layer of four cells", partial(missing_slide, 4.0)),
        ),
    ),
)
