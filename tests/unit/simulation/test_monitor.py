"""Run-time checks: defects planted in a run are reported within one check with their cause; valid runs pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from zlib import crc32

import numpy as np
import pytest

import mpmcol
from mpmcol.errors import NumericalFailure
from mpmcol.io.results import Results
from mpmcol.mpm.grid import node_coordinates
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.lanes import OPENING, S_ZZ, VX, J, M, X, Y
from mpmcol.mpm.particles import BASE
from mpmcol.setup.model import build_model
from mpmcol.simulation.failure import identify_failure
from mpmcol.simulation.monitor import node_position, principal_stresses
from mpmcol.simulation.run import start
from mpmcol.simulation.stages import CHECKS_PER_FALL_TIME, Stages

MODELS = {
    "plane": ("coarse-channel", "grid.spacing=0.015"),
    "softening": ("lube-channel-dense", "grid.spacing=0.015"),
    "axisymmetric": ("lube-cylinder", "grid.spacing=0.0194"),
    "quarter": ("lube-quarter", "grid.spacing=0.0194", "geometry.aspect=0.4"),
    "full": ("lube-quarter", "grid.spacing=0.0194", "geometry.aspect=0.4", "geometry.model=full"),
}
OPTIONS = ("stages.initial_stress=k0", "output.snapshots=1")
VALID_CHECKS = 3  # before the defect is planted


class DefectiveRun:
    """A run at its release in which a defect is planted once, before a step or before a check.

    Time, point and position of the defect are recorded.
    """

    def __init__(
        self, model: str, folder: Path, plant: Callable[[Stages, int], Any], moment: str, seed: int = 0
    ) -> None:
        case = mpmcol.load_case(MODELS[model][0], [*MODELS[model][1:], *OPTIONS])
        self.stages = Stages(start(case, build_model(case), folder / "run"), self.between_steps)
        self.stages.release()
        self.plant, self.moment = plant, moment
        self.time, self.point, self.position = np.inf, -1, None
        self.random = np.random.default_rng(seed)
        self._record = self.stages.recorder.record
        self.stages.recorder.record = self.record  # type: ignore[method-assign]

    def between_steps(self) -> None:
        if self.moment == "step":
            self.plant_once()

    def record(self, stage: str) -> None:
        if self.moment == "check":
            self.plant_once()
        self._record(stage)

    def plant_once(self) -> None:
        if self.time < np.inf or self.stages.simulation.progress.checks < VALID_CHECKS:
            return
        points = self.stages.solver.points
        row = int(self.random.choice(np.flatnonzero(points.kind != BASE)))
        self.time, self.point = self.stages.solver.time, int(points.id[row])
        self.position = points.x[row].copy()
        self.plant(self.stages, row)

    def failure(self) -> dict[str, Any]:
        with pytest.raises(NumericalFailure) as stopped:
            self.stages.collapse()
        self.text = str(stopped.value)
        return stopped.value.failure


def put(lane: int, value: float, stages: Stages, row: int) -> None:
    stages.solver.points.rows[row, lane] = value


def history(stages: Stages, row: int) -> None:
    stages.solver.points.history[row, 0] = np.nan


def faster(factor: float, stages: Stages, row: int) -> None:
    stages.solver.points.v[row, 0] = factor * max(
        stages.solver.settings.free_speed, stages.solver.bodies[0].wave_speed2 ** 0.5
    )


def heavier(factor: float, stages: Stages, row: int) -> None:
    stages.solver.points.m[row] *= factor


def lifted(cells: float, stages: Stages, row: int) -> None:
    stages.solver.points.x[row, 1] += cells * stages.model.discretization.h


def outside(axis: int, stages: Stages, row: int) -> None:
    discretization = stages.model.discretization
    stages.solver.points.x[row, axis] = (
        discretization.length,
        discretization.cells_up * discretization.h - discretization.base,
        discretization.length,
    )[axis]
    stages.solver.sort()


def thrown(speed: float, stages: Stages, row: int) -> None:
    stages.solver.points.v[stages.solver.points.kind != BASE, 1] += speed


def gravity(factor: float, stages: Stages, row: int) -> None:
    stages.solver.settings = stages.solver.settings._replace(gravity_y=factor * stages.solver.settings.gravity_y)


def slow_clock(stages: Stages, row: int) -> None:
    stages.solver.clock[loop.DT] *= 1e-3


def strained(deviator: float, tension: float, stages: Stages, row: int) -> None:
    points = stages.solver.points
    sigma = points.sigma
    pressure = -1e3
    sigma[row] = tension + pressure * (1.0 + deviator * np.array([0.0, 1.0, -1.0, 0.0, 0.0, 0.0]))
    points.sigma = sigma


def node(lane: int, value: float, stages: Stages, row: int) -> None:
    solver = stages.solver
    records = solver.grid.nodes.reshape(-1, 8)
    tiles = [range(first // 8, (first + solver.grid.tile_doubles) // 8) for first in solver.tiles.active]
    heavy = max((k for tile in tiles for k in tile), key=lambda k: records[k, 0])
    records[heavy, lane] = value


def massless(stages: Stages, row: int) -> None:
    node(0, 0.0, stages, row)


class Defect(NamedTuple):
    name: str
    plant: Callable[[Stages, int], Any]
    check: str
    cause: str
    moment: str = "step"
    of_point: bool = True  # whether the failure names the defective point or one near it
    models: tuple[str, ...] = ("plane",)


NAN, FLAT, ALL = float("nan"), ("plane", "softening", "axisymmetric"), tuple(MODELS)
SOLID = ("plane", "quarter")
DEFECTS = (
    Defect("velocity NaN", partial(put, VX, NAN), "finite", "velocity", models=ALL),
    Defect("velocity inf", partial(put, VX, np.inf), "finite", "velocity"),
    Defect("position NaN", partial(put, X, NAN), "finite", "position", of_point=False, models=SOLID),
    Defect("height NaN", partial(put, Y, NAN), "finite", "position", of_point=False, models=("axisymmetric", "full")),
    Defect("stress NaN", partial(put, S_ZZ, NAN), "finite", "velocity", models=("axisymmetric", "quarter")),
    Defect("J NaN", partial(put, J, NAN), "finite", "volume ratio", models=SOLID),
    Defect("mass NaN", partial(put, M, NAN), "finite", "mass", models=SOLID),
    Defect("opening NaN", partial(put, OPENING, NAN), "finite", "not finite", of_point=False, models=SOLID),
    Defect("opening NaN before a check", partial(put, OPENING, NAN), "finite", "opening strain", "check", models=SOLID),
    Defect("history NaN", history, "finite", "not finite", models=("softening",)),
    Defect("history NaN before a check", history, "finite", "history of the law", "check", models=("softening",)),
    Defect("J near zero", partial(put, J, 1e-9), "volume", "volume ratio J", models=ALL),
    Defect("J negative", partial(put, J, -0.5), "volume", "volume ratio J"),
    Defect("J above its limit", partial(put, J, 80.0), "volume", "volume ratio J", models=SOLID),
    Defect("twice the allowed speed", partial(faster, 2.0), "speed", "faster than waves", models=ALL),
    Defect("enormous speed", partial(faster, 1e4), "volume", "volume ratio J", of_point=False, models=SOLID),
    Defect("out of the top", partial(outside, 1), "domain", "top of the domain", models=SOLID),
    Defect("out of the end", partial(outside, 0), "domain", "end of the domain", models=("axisymmetric", "full")),
    Defect("out of the far end", partial(outside, 2), "domain", "end of the domain", models=("quarter",)),
    Defect("energy added", partial(thrown, 1.0), "energy", "energy gain", of_point=False, models=ALL),
    Defect("mass added", partial(heavier, 3.0), "ledger", "does not close", of_point=False, models=FLAT),
    Defect("negative mass", partial(heavier, -1.0), "ledger", "does not close", of_point=False, models=SOLID),
    Defect("point lifted", partial(lifted, 0.3), "ledger", "does not close", of_point=False, models=ALL),
    Defect("gravity doubled", partial(gravity, 2.0), "ledger", "does not close", of_point=False),
    Defect("time step reduced", slow_clock, "time step", "collapsed", "check", of_point=False, models=SOLID),
    Defect("excessive shear", partial(strained, 0.95, 0.0), "yield surface", "outside", "check", models=ALL),
    Defect("tension", partial(strained, 0.0, 2e3), "yield surface", "outside", "check", models=ALL),
    Defect("node without mass", massless, "nodes", "a node", "check", of_point=False, models=SOLID),
    Defect("node of negative mass", partial(node, 0, -1.0), "nodes", "a node", "check", of_point=False, models=SOLID),
    Defect("node mass NaN", partial(node, 0, NAN), "nodes", "a node", "check", of_point=False),
    Defect("node velocity NaN", partial(node, 1, NAN), "nodes", "a node", "check", of_point=False, models=SOLID),
)
STEPS = [(cfl, model) for model in ("plane", "axisymmetric", "quarter") for cfl in (1.1, 1.5, 2.0, 4.0, 10.0)]
PLANTED = [pytest.param(defect, model, id=f"{defect.name}, {model}") for defect in DEFECTS for model in defect.models]


def test_there_are_enough_defects() -> None:
    assert len(PLANTED) + len(STEPS) >= 50


@pytest.mark.parametrize(("defect", "model"), PLANTED)
def test_a_defect_is_reported_within_one_check(defect: Defect, model: str, tmp_path: Path) -> None:
    planted = DefectiveRun(model, tmp_path, defect.plant, defect.moment, crc32(f"{defect.name}, {model}".encode()))
    failure, solver = planted.failure(), planted.stages.solver
    assert failure["check"] == defect.check and defect.cause in failure["cause"], failure
    assert failure["stage"] == "collapse" and failure["step"] == solver.steps
    interval = planted.stages.fall_time / CHECKS_PER_FALL_TIME
    assert planted.time <= failure["time"] <= planted.time + interval + 2.0 * solver.dt + 1e-3
    for text in ("likely cause: ", "remedy: ", f"step {failure['step']}", "stage collapse"):
        assert text in planted.text
    if defect.of_point:
        distance = np.abs(np.array(failure["position"]) - planted.position).max()
        assert failure["point"] == planted.point or distance < 4.0 * planted.stages.model.discretization.h
        assert f"point {failure['point']} at x = " in planted.text


@pytest.mark.parametrize(
    ("value", "opening_strain", "likely", "remedy"),
    [
        (80.0, True, "dilates", "dilatancy"),
        (80.0, False, "separate", "opening_strain"),
        (0.01, True, "crushes", "youngs"),
    ],
)
def test_a_slow_change_of_volume_is_not_attributed_to_the_time_step(
    value: float, opening_strain: bool, likely: str, remedy: str, tmp_path: Path
) -> None:
    def plant(stages: Stages, row: int) -> None:
        stages.solver.settings = stages.solver.settings._replace(opening_strain=opening_strain)
        put(J, value, stages, row)

    failure = DefectiveRun("plane", tmp_path, plant, "step").failure()
    assert likely in failure["likely"] and remedy in failure["remedy"] and not failure["smaller_step_helps"]


@pytest.mark.parametrize(("share", "likely"), [(0.4, "time step"), (0.6, "crushes")])
def test_a_sudden_loss_of_volume_of_soft_material_is_attributed_to_its_stiffness(
    share: float, likely: str, tmp_path: Path
) -> None:
    solver = DefectiveRun("plane", tmp_path, lambda stages, row: None, "step").stages.solver
    solver.settings = solver.settings._replace(free_speed=share * solver.bodies[0].wave_speed2 ** 0.5)
    solver.points.J[0] = 0.01
    solver.points.grad_v = -np.ones_like(solver.points.grad_v) / solver.dt
    assert likely in identify_failure(solver, 0).likely


@pytest.mark.parametrize(("cfl", "model"), STEPS)
def test_too_large_a_time_step_is_reported_within_a_few_checks(cfl: float, model: str, tmp_path: Path) -> None:
    """From the first step of the loading by gravity, with cause and remedy."""
    case = mpmcol.load_case(MODELS[model][0], [*MODELS[model][1:]])
    stages = Stages(start(case, build_model(case), tmp_path / "run"))
    stage = stages.model.equilibrate
    stages.solver.clock[loop.DT] *= cfl / stage.settings.cfl
    stages.model = replace(stages.model, equilibrate=replace(stage, settings=stage.settings._replace(cfl=cfl)))
    with pytest.raises(NumericalFailure, match="a time step beyond the stability limit") as stopped:
        stages.run()
    failure = stopped.value.failure
    assert failure["check"] in ("finite", "volume", "speed", "energy") and failure["smaller_step_helps"]
    assert failure["stage"] == "equilibrate" and "lower time.cfl" in failure["remedy"]
    assert stages.simulation.progress.valid_checks <= 3


VALID = (
    ("method.transfer=flip",),
    ("method.transfer=pic",),
    ("method.position_update=paper",),
    ("method.position_update=end",),
    ("method.opening_strain=false",),
    ("method.kernel_correction=false",),
    ("geometry.base=rigid",),
    ("stages.gate_speed=0.5",),
    ("stages.collapse.damping=0", "stages.equilibrate.damping=0"),
    ("material.youngs_modulus=1e8", "grid.points_per_cell=1"),
    ("material.youngs_modulus=2e5", "geometry.aspect=10"),
    ("material.poissons_ratio=0.45", "material.cohesion=200", "material.dilatancy_deg=10"),
)


@pytest.mark.parametrize("overrides", VALID, ids=" ".join)
def test_valid_runs_pass(overrides: tuple[str, ...], tmp_path: Path) -> None:
    """Including unfavourable choices of the method; the regression tests run the shipped cases."""
    case = mpmcol.load_case(
        "coarse-channel", ["grid.spacing=0.015", "stages.collapse.max_time_factor=2", *OPTIONS[1:], *overrides]
    )
    assert mpmcol.run(case, tmp_path / "run", threads=1).summary["status"] == "done"


def test_a_run_that_ends_in_nan_has_a_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With snapshots of the last valid state and of the failed one."""
    case = mpmcol.load_case("coarse-channel", ["grid.spacing=0.015", "output.snapshots=1"])
    check_collapse = Stages._check_collapse

    def spoil(stages: Stages, lifting_time: float) -> None:
        check_collapse(stages, lifting_time)
        if stages.simulation.progress.checks == 8:
            stages.solver.points.rows[:, VX] = NAN

    monkeypatch.setattr(Stages, "_check_collapse", spoil)
    with pytest.raises(NumericalFailure, match=r"(?s)not finite.*the last valid state \(snapshot 1\) and"):
        mpmcol.run(case, tmp_path / "run", threads=1)
    results = Results(tmp_path / "run")
    failure = results.summary["failure"]
    assert results.status == "failed" and failure["check"] == "finite" and failure["value"] is None
    assert np.isfinite(failure["position"]).all()
    assert [results.snapshot(k).stage for k in range(3)] == ["release", "last_valid", "failed"]
    assert np.isfinite(results.snapshot(1).x).all() and results.snapshot(1).time < failure["time"]
    assert failure["last_valid"] == 1


def test_detached_particles_are_reported_and_do_not_stop_the_run(tmp_path: Path) -> None:
    stages = DefectiveRun("plane", tmp_path, lambda stages, row: None, "never").stages
    top = stages.solver.points.id == stages.solver.points.id[stages.solver.points.kind != BASE].max()
    stages.solver.points.v[top, 0] = 0.9 * stages.solver.settings.free_speed
    stages.collapse()
    (warning,) = (text for text in stages.simulation.progress.warnings if text.startswith("detached particles"))
    row = stages.recorder.rows[-1]
    assert f"front_max {row['front_max']:.4g} m, front_connected {row['front_connected']:.4g} m" in warning


@pytest.mark.parametrize("model", ["plane", "quarter"])
def test_the_position_of_a_node_follows_from_its_address(model: str, tmp_path: Path) -> None:
    case = mpmcol.load_case(MODELS[model][0], [*MODELS[model][1:]])
    grid = build_model(case).grid
    i, j, k = 5, 3, 2 if grid.n_z > 1 else 0
    grid.nodes[grid.ax[i] + grid.ay[j] + grid.az[k]] = 7.0
    (address,) = np.flatnonzero(grid.nodes == 7.0)
    x = node_position(grid, int(address))
    axes = [axis.ravel() for axis in node_coordinates(grid)]
    assert x == pytest.approx([axis[n] for axis, n in zip(axes, (i, j, k), strict=False)])
    assert node_position(grid, grid.nodes.size) is None


@pytest.mark.parametrize("d", [2, 3])
def test_principal_stresses(d: int) -> None:
    """Against NumPy, for random stresses and for repeated principal values."""
    number = np.random.default_rng(d)
    sigma = number.normal(0.0, 1e3, (200, 6))
    sigma[:20, 3:], sigma[:5, :3], sigma[5:9, 1] = 0.0, -5.0, sigma[5:9, 0]
    if d == 2:
        sigma[:, 4:] = 0.0
    xx, yy, zz, xy, yz, xz = sigma.T
    known = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).transpose(2, 0, 1))
    np.testing.assert_allclose(np.array(principal_stresses(*sigma.T)).T, known[:, ::-1], atol=1e-4)
