"""Open ends of the domain: they stop the run when the flow arrives, and arrest single particles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.errors import NumericalFailure
from mpmcol.mpm.particles import BASE
from mpmcol.setup.model import build_model
from mpmcol.simulation.run import start
from mpmcol.simulation.stages import Stages

RADIUS, LENGTH, SPEED = 0.097, 0.36, 8.0  # m, m, m/s
COARSE = ("grid.spacing=0.0194", "stages.equilibrate.law=mohr-coulomb", "stages.initial_stress=k0")
SMALL = (f"geometry.domain_length={LENGTH}", "geometry.aspect=0.4", "output.snapshots=1")
SHORT = "stages.collapse.max_time_factor=0.5"  # twice the time that a point needs to the end of the domain
ENDS = {
    "low x": ((-1.0, 0.0, 0.1), 0),
    "high x": ((1.0, 0.0, 0.1), 0),
    "low z": ((0.1, 0.0, -1.0), 2),
    "high z": ((-0.1, 0.0, 1.0), 2),
    "top": ((0.0, 1.0, 0.0), 1),
}


def thrown(model: str, direction: tuple[float, ...], folder: Path, *overrides: str) -> Stages:
    """A coarse run at its release, with a velocity of the column in the given direction."""
    case = mpmcol.load_case("lube-quarter", [f"geometry.model={model}", *COARSE, *SMALL, *overrides])
    stages = Stages(start(case, build_model(case), folder / "run"))
    stages.release()
    stages.solver.points.v[stages.solver.points.kind != BASE] = SPEED * np.array(direction)
    restart_energy_ledger(stages)
    return stages


def restart_energy_ledger(stages: Stages) -> None:
    """The kinetic energy added by the test is part of the initial energy."""
    stages.recorder.rows.clear()
    stages.recorder.start_ledger()


@pytest.mark.parametrize(("direction", "axis"), ENDS.values(), ids=ENDS)
def test_each_end_of_the_full_domain_stops_the_run(direction: tuple[float, ...], axis: int, tmp_path: Path) -> None:
    stages = thrown("full", direction, tmp_path)
    with pytest.raises(NumericalFailure) as stopped:
        stages.collapse()
    failure, text, h = stopped.value.failure, str(stopped.value), stages.model.discretization.h
    x, y, z = failure["position"]
    assert f"at x = {x:.5g} m, y = {y:.5g} m, z = {z:.5g} m" in text
    assert failure["value"] == failure["position"][axis]
    assert f"point {failure['point']} " in text and "stage collapse" in text
    if axis == 1:
        top = (stages.model.discretization.cells_up - 2) * h - stages.model.discretization.base
        assert "reached the top of the domain" in text and "set a larger geometry.domain_height" in text
        assert top <= y < top + 0.5 * h
    else:
        length = stages.model.discretization.length
        assert "reached the end of the domain" in text and "set a larger geometry.domain_length" in text
        assert f"{length - 5.0 * h:.4g} m are usable, five cells less" in text and f"{1.5 * length:.4g} m" in text
        assert length - 5.0 * h <= np.sign(direction[axis]) * failure["value"] < length - 2.0 * h


@pytest.mark.parametrize("axis", [0, 2], ids="xz")
def test_the_open_ends_of_a_quarter_stop_the_run(axis: int, tmp_path: Path) -> None:
    stages = thrown("quarter", tuple(np.eye(3)[axis]), tmp_path)
    with pytest.raises(NumericalFailure, match="reached the end of the domain") as stopped:
        stages.collapse()
    assert stopped.value.failure["value"] == stopped.value.failure["position"][axis] > LENGTH - 0.1


@pytest.mark.parametrize(
    "direction", [(1.0, 0.0, 0.0), pytest.param((0.0, 0.0, -1.0), marks=pytest.mark.slow)], ids=["x", "z"]
)
def test_a_single_particle_is_arrested_at_the_end_with_a_warning(direction: tuple[float, ...], tmp_path: Path) -> None:
    """It is detached ahead of the flow, and the run continues."""
    stages = thrown("full", (0.0, 0.0, 0.0), tmp_path, SHORT)
    points, discretization = stages.solver.points, stages.model.discretization
    single = points.id[np.flatnonzero(points.kind != BASE)[-1]]
    (row,) = np.flatnonzero(points.id == single)
    points.x[row] = 0.24 * np.array(direction) + (0.0, 2.5 * discretization.h, 0.0)
    points.v[row] = SPEED * np.array(direction)
    stages.solver.sort()
    restart_energy_ledger(stages)
    stages.collapse()
    reach = float(points.x[points.id == single][0] @ np.array(direction))
    assert discretization.length - 5.0 * discretization.h < reach < discretization.length - 2.0 * discretization.h
    assert "1 particle was arrested at the domain boundary" in stages.simulation.progress.warnings[-1]


def test_planes_of_symmetry_do_not_stop_the_run(tmp_path: Path) -> None:
    """A quarter column is thrown against them."""
    stages = thrown("quarter", (-0.2, 0.0, -0.2), tmp_path)
    while stages.solver.time < 0.5 * stages.fall_time:
        assert stages.solver.advance(0.5 * stages.fall_time) == -1
    assert 0.0 < stages.solver.points.x[:, ::2].min() < 0.5 * stages.model.discretization.h


def test_base_points_near_the_ends_do_not_stop_the_run(tmp_path: Path) -> None:
    """The base fills the domain up to its ends."""
    stages = thrown("full", (0.0, 0.0, 0.0), tmp_path)
    base = stages.solver.points.x[stages.solver.points.kind == BASE]
    assert np.abs(base[:, ::2]).max() > stages.model.discretization.length - stages.model.discretization.h
    assert stages.solver.advance(np.inf, max_steps=5) == -1
