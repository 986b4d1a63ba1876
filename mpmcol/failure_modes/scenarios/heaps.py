"""Heaps steeper than they can stand, which nothing holds before the release."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from mpmcol.case import load_case
from mpmcol.failure_modes.scenario import Scenario, failing, passing
from mpmcol.simulation.run import run

COARSE = ("grid.spacing=0.02", "grid.points_per_cell=4", "stages.collapse.max_time_factor=0.05", "output.snapshots=1")


def lost_height(law: str) -> float:
    """Part of the height of the case `heap`, flanks of 40 degrees, that is lost before the release."""
    case = load_case("heap", [*COARSE, f"stages.equilibrate.law={law}"])
    with TemporaryDirectory() as folder:
        results = run(case, Path(folder) / "run", threads=1)
        return 1.0 - results.measure(0).height / case.geometry.h_i


SCENARIOS = (
    Scenario(
        name="heap-release",
        mechanism="A heap steeper than its friction angle is loaded with the law of the sand: no gate holds it, and it "
        "fails before the release, from which its collapse is measured.",
        metric="part of the height lost before the release",
        bound=0.01,
        source="chosen here: 1 %; the elastic heap settles by 0.02 %",
        remedy="stages.equilibrate.law = elastic (default without a gate)",
        trials=(
            failing("first stage with mohr-coulomb", partial(lost_height, "mohr-coulomb")),
            passing("elastic first stage", partial(lost_height, "elastic"), default=True),
        ),
    ),
)
