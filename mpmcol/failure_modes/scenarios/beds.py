"""Granular beds that are thinner than what the flow erodes."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from mpmcol.case import load_case
from mpmcol.failure_modes.scenario import Observation, Scenario, failing, passing
from mpmcol.simulation.run import run

CELL = 0.01125  # m: r_i / 8
WEAK_BED = (
    "geometry.aspect=1", "base_material.friction_deg=25", f"grid.spacing={CELL}", "grid.points_per_cell=4",
    "stages.collapse.max_time_factor=4", "output.snapshots=1",
)  # fmt: skip


def eroded_share(cells: int) -> Observation:
    """Eroded depth over the thickness of a bed of so many cells, of the case `granular-bed` with a weak bed."""
    thickness = cells * CELL
    case = load_case("granular-bed", [*WEAK_BED, f"geometry.base_thickness={thickness}"])
    with TemporaryDirectory() as folder:
        erosion = run(case, Path(folder) / "run", threads=1).summary["erosion"]
    return Observation(erosion["eroded_depth"] / thickness, f"{erosion['eroded_mass']:.3g} kg/m moved")


SCENARIOS = (
    Scenario(
        name="bed-thin",
        mechanism="A bed is thinner than the flow erodes: the floor below it stops the erosion, and less of it moves.",
        metric="eroded depth over the thickness of the bed",
        bound=0.9,
        source="chosen here: 90 %; beds of two to six cells are all eroded to one cell",
        remedy="geometry.base_thickness of four cells or more; a run reports a bed that moves down to the floor",
        trials=(
            failing("bed of one cell", partial(eroded_share, 1)),
            passing("bed of four cells", partial(eroded_share, 4)),
        ),
    ),
)
