"""The cleanest experiment, Bui's aluminium rods (doi:10.1002/nag.688), at a coarse spacing, with a negative control.

The band: surface within 3.5 mm RMS of a 100 mm column, front within the 10 % that separate
one experiment from another. It must reject angles of friction that are not the rods'.
"""

from __future__ import annotations

from pathlib import Path

import pytest

import mpmcol
from mpmcol.experiments import find_experiment, profile_score

SURFACE_MM, FRONT = 3.5, 0.10


@pytest.mark.parametrize(("friction_deg", "accepted"), [(14.0, False), (19.8, True), (25.0, False), (30.0, False)])
def test_only_the_rods_friction_fits_the_rods(friction_deg: float, accepted: bool, tmp_path: Path) -> None:
    rods = find_experiment("bui-2008", "plane")
    case = mpmcol.load_case("bui-rods", ["grid.spacing=0.005", f"material.friction_deg={friction_deg}"])
    measured = mpmcol.run(case, tmp_path / "run").measure()
    surface = profile_score(measured.profile_x, measured.profile_y, rods)
    expected = rods.expected("zeta", case.geometry.a)
    assert surface is not None and expected is not None
    error = measured.zeta["front_height"] / expected[0] - 1.0
    fits = surface.rms_mm <= SURFACE_MM and abs(error) <= FRONT
    assert fits is accepted, f"RMS {surface.rms_mm:.2f} mm, front {error:+.1%}"
