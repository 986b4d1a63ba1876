"""Points may be faster than the waves of their material, but not faster than gravity can cause."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.mpm.particles import BASE
from mpmcol.setup.model import build_model, free_speed
from mpmcol.simulation.failure import diagnose
from mpmcol.simulation.run import start
from mpmcol.simulation.stages import Stages

SOFT = ("grid.spacing=0.015", "material.youngs_modulus=0.002 MPa", "stages.initial_stress=k0")


def falling(folder: Path, share: float) -> Stages:
    """A soft column at its release, with one point moving up at `share` times the speed that gravity can cause."""
    case = mpmcol.load_case("coarse-channel", SOFT)
    stages = Stages(start(case, build_model(case), folder / "run"))
    stages.release()
    points, waves = stages.solver.points, np.sqrt(stages.solver.bodies[0].wave_speed2)
    speed = share * stages.solver.settings.free_speed
    assert speed > 1.1 * waves
    (row,) = np.flatnonzero(points.id == points.id[points.kind != BASE].max())  # at the top, next to the free surface
    points.v[row, 1] = speed
    return stages


def test_the_limit_is_twice_the_speed_of_free_fall_from_the_top_of_the_column_to_the_floor(tmp_path: Path) -> None:
    discretization = falling(tmp_path, 0.9).model.discretization
    assert discretization.base > 0.0
    assert free_speed(9.81, discretization.h_i + discretization.base) == pytest.approx(
        2.0 * np.sqrt(19.62 * (0.09 + discretization.base))
    )


@pytest.mark.parametrize(("share", "is_fault"), [(0.98, False), (1.2, True)])
def test_a_point_faster_than_its_waves_is_invalid_only_beyond_the_speed_of_gravity(
    share: float, is_fault: bool, tmp_path: Path
) -> None:
    stages = falling(tmp_path, share)
    fault = stages.solver.advance(np.inf, max_steps=1)
    assert (fault >= 0) == is_fault
    if is_fault:
        cause = diagnose(stages.solver, fault, "collapse")["cause"]
        assert "faster than waves in its material" in cause and "than the limit for free fall" in cause
