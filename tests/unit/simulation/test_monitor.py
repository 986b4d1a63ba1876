"""Runs that are made to fail are stopped within one look, with the right cause and place; sound ones are not."""

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
from mpmcol.simulation.failure import fault_of
from mpmcol.simulation.monitor import node_position, principal
from mpmcol.simulation.run import set_up
from mpmcol.simulation.stages import CHECKS_PER_TAU, Run

MODELS = {
    "plane": ("quickstart", "grid.spacing=0.015"),
    "softening": ("lube-channel-dense", "grid.spacing=0.015"),
    "axisymmetric": ("lube-cylinder", "grid.spacing=0.0194"),
    "quarter": ("lube-quarter", "grid.spacing=0.0194", "geometry.aspect=0.4"),
    "full": ("lube-quarter", "grid.spacing=0.0194", "geometry.aspect=0.4", "geometry.model=full"),
}
ALWAYS = ("stages.initial_stress=k0", "output.snapshots=1")
SOUND_LOOKS = 3  # before the damage is done


class Saboteur:
    """A run at its release that does damage once, before a step or before a look, and notes when and where."""

    def __init__(self, model: str, folder: Path, damage: Callable[[Run, int], Any], moment: str, seed: int = 0) -> None:
        case = mpmcol.load_case(MODELS[model][0], [*MODELS[model][1:], *ALWAYS])
        self.run = set_up(case, build_model(case), folder / "run", 1, lambda stage, share: None, lambda line: None)
        self.run.release()
        self.damage, self.moment = damage, moment
        self.time, self.point, self.place = np.inf, -1, None
        self.number = np.random.default_rng(seed)
        self._record = self.run.recorder.record
        self.run.recorder.record = self.record  # type: ignore[method-assign]

    def pause(self) -> None:
        if self.moment == "step":
            self.act()

    def record(self, stage: str) -> Any:
        if self.moment == "look":
            self.act()
        return self._record(stage)

    def act(self) -> None:
        if self.time < np.inf or self.run.course.checks < SOUND_LOOKS:
            return
        points = self.run.solver.points
        row = int(self.number.choice(np.flatnonzero(points.kind != BASE)))
        self.time, self.point = self.run.solver.time, int(points.id[row])
        self.place = points.x[row].copy()
        self.damage(self.run, row)

    def failure(self) -> dict[str, Any]:
        with pytest.raises(NumericalFailure) as stopped:
            self.run.collapse(self.pause)
        self.text = str(stopped.value)
        return stopped.value.failure


def put(lane: int, value: float, run: Run, row: int) -> None:
    run.solver.points.rows[row, lane] = value


def history(run: Run, row: int) -> None:
    run.solver.points.history[row, 0] = np.nan


def faster(factor: float, run: Run, row: int) -> None:
    run.solver.points.v[row, 0] = factor * max(run.solver.settings.free_speed, run.solver.bodies[0].wave_speed2 ** 0.5)


def heavier(factor: float, run: Run, row: int) -> None:
    run.solver.points.m[row] *= factor


def lifted(cells: float, run: Run, row: int) -> None:
    run.solver.points.x[row, 1] += cells * run.model.discretization.h


def outside(axis: int, run: Run, row: int) -> None:
    discretization = run.model.discretization
    run.solver.points.x[row, axis] = (
        discretization.length,
        discretization.cells_up * discretization.h - discretization.base,
        discretization.length,
    )[axis]
    run.solver.sort()


def thrown(speed: float, run: Run, row: int) -> None:
    run.solver.points.v[run.solver.points.kind != BASE, 1] += speed


def gravity(factor: float, run: Run, row: int) -> None:
    run.solver.settings = run.solver.settings._replace(gravity_y=factor * run.solver.settings.gravity_y)


def slow_clock(run: Run, row: int) -> None:
    run.solver.clock[loop.DT] *= 1e-3


def strained(deviator: float, tension: float, run: Run, row: int) -> None:
    points = run.solver.points
    sigma = points.sigma
    pressure = -1e3
    sigma[row] = tension + pressure * (1.0 + deviator * np.array([0.0, 1.0, -1.0, 0.0, 0.0, 0.0]))
    points.sigma = sigma


def node(lane: int, value: float, run: Run, row: int) -> None:
    solver = run.solver
    records = solver.grid.nodes.reshape(-1, 8)
    tiles = [range(first // 8, (first + solver.grid.tile_doubles) // 8) for first in solver.tiles.active]
    heavy = max((k for tile in tiles for k in tile), key=lambda k: records[k, 0])
    records[heavy, lane] = value


def massless(run: Run, row: int) -> None:
    node(0, 0.0, run, row)


class Case(NamedTuple):
    name: str
    damage: Callable[[Run, int], Any]
    check: str
    cause: str
    moment: str = "step"
    of_point: bool = True  # whether the damaged point or one near it is named; what has no place spoils another one
    models: tuple[str, ...] = ("plane",)
    looks: int = 1


NAN, FLAT, ALL = float("nan"), ("plane", "softening", "axisymmetric"), tuple(MODELS)
SOLID = ("plane", "quarter")
DAMAGE = (
    Case("velocity NaN", partial(put, VX, NAN), "finite", "velocity", models=ALL),
    Case("velocity inf", partial(put, VX, np.inf), "finite", "velocity"),
    Case("position NaN", partial(put, X, NAN), "finite", "position", of_point=False, models=SOLID),
    Case("height NaN", partial(put, Y, NAN), "finite", "position", of_point=False, models=("axisymmetric", "full")),
    Case("stress NaN", partial(put, S_ZZ, NAN), "finite", "velocity", models=("axisymmetric", "quarter")),
    Case("J NaN", partial(put, J, NAN), "finite", "volume ratio", models=SOLID),
    Case("mass NaN", partial(put, M, NAN), "finite", "mass", models=SOLID),
    Case("opening NaN", partial(put, OPENING, NAN), "finite", "not finite", of_point=False, models=SOLID),
    Case("opening NaN, just now", partial(put, OPENING, NAN), "finite", "opening strain", "look", models=SOLID),
    Case("history NaN", history, "finite", "not finite", models=("softening",)),
    Case("history NaN, just now", history, "finite", "history of the law", "look", models=("softening",)),
    Case("J to nothing", partial(put, J, 1e-9), "volume", "J left", models=ALL),
    Case("J negative", partial(put, J, -0.5), "volume", "J left"),
    Case("J beyond bounds", partial(put, J, 80.0), "volume", "J left", models=SOLID),
    Case("twice too fast", partial(faster, 2.0), "speed", "faster than waves", models=ALL),
    Case("thrown out", partial(faster, 1e4), "volume", "J left", of_point=False, models=SOLID),
    Case("out of the top", partial(outside, 1), "domain", "top of the domain", models=SOLID),
    Case("out of the end", partial(outside, 0), "domain", "end of the domain", models=("axisymmetric", "full")),
    Case("out of the far end", partial(outside, 2), "domain", "end of the domain", models=("quarter",)),
    Case("energy planted", partial(thrown, 1.0), "energy", "came from nowhere", of_point=False, models=ALL),
    Case("mass planted", partial(heavier, 3.0), "ledger", "does not add up", of_point=False, models=FLAT),
    Case("negative mass", partial(heavier, -1.0), "ledger", "does not add up", of_point=False, models=SOLID),
    Case("point lifted", partial(lifted, 0.3), "ledger", "does not add up", of_point=False, models=ALL),
    Case("gravity doubled", partial(gravity, 2.0), "ledger", "does not add up", of_point=False),
    Case("time step lost", slow_clock, "time step", "collapsed", "look", of_point=False, models=SOLID),
    Case("sheared too far", partial(strained, 0.95, 0.0), "yield surface", "outside", "look", models=ALL),
    Case("tension", partial(strained, 0.0, 2e3), "yield surface", "outside", "look", models=ALL),
    Case("node without mass", massless, "nodes", "a node", "look", of_point=False, models=SOLID),
    Case("node of negative mass", partial(node, 0, -1.0), "nodes", "a node", "look", of_point=False, models=SOLID),
    Case("node mass NaN", partial(node, 0, NAN), "nodes", "a node", "look", of_point=False),
    Case("node velocity NaN", partial(node, 1, NAN), "nodes", "a node", "look", of_point=False, models=SOLID),
)
STEPS = [(cfl, model) for model in ("plane", "axisymmetric", "quarter") for cfl in (1.1, 1.5, 2.0, 4.0, 10.0)]
SCENES = [pytest.param(case, model, id=f"{case.name}, {model}") for case in DAMAGE for model in case.models]


def test_there_are_enough_scenes() -> None:
    assert len(SCENES) + len(STEPS) >= 50


@pytest.mark.parametrize(("case", "model"), SCENES)
def test_damage_is_found_within_one_look_and_named(case: Case, model: str, tmp_path: Path) -> None:
    scene = Saboteur(model, tmp_path, case.damage, case.moment, crc32(f"{case.name}, {model}".encode()))
    failure, solver = scene.failure(), scene.run.solver
    assert failure["check"] == case.check and case.cause in failure["cause"], failure
    assert failure["stage"] == "collapse" and failure["step"] == solver.steps
    assert scene.time <= failure["time"] <= scene.time + scene.run.tau / CHECKS_PER_TAU + 2.0 * solver.dt + 1e-3
    for word in ("likely cause: ", "remedy: ", f"step {failure['step']}", "stage collapse"):
        assert word in scene.text
    if case.of_point:
        near = np.abs(np.array(failure["position"]) - scene.place).max() < 4.0 * scene.run.model.discretization.h
        assert failure["point"] == scene.point or near
        assert f"point {failure['point']} at x = " in scene.text


@pytest.mark.parametrize(
    ("value", "opening_strain", "likely", "remedy"),
    [
        (80.0, True, "dilates", "dilatancy"),
        (80.0, False, "pulled apart", "opening_strain"),
        (0.01, True, "crushes", "youngs"),
    ],
)
def test_a_volume_that_leaves_its_bounds_slowly_is_not_put_down_to_the_time_step(
    value: float, opening_strain: bool, likely: str, remedy: str, tmp_path: Path
) -> None:
    def damage(run: Run, row: int) -> None:
        run.solver.settings = run.solver.settings._replace(opening_strain=opening_strain)
        put(J, value, run, row)

    failure = Saboteur("plane", tmp_path, damage, "step").failure()
    assert likely in failure["likely"] and remedy in failure["remedy"] and not failure["smaller_step_helps"]


@pytest.mark.parametrize(("share", "likely"), [(0.4, "time step"), (0.6, "crushes")])
def test_a_volume_lost_at_once_is_put_down_to_the_softness_of_what_falls(
    share: float, likely: str, tmp_path: Path
) -> None:
    solver = Saboteur("plane", tmp_path, lambda run, row: None, "step").run.solver
    solver.settings = solver.settings._replace(free_speed=share * solver.bodies[0].wave_speed2 ** 0.5)
    solver.points.J[0] = 0.01
    solver.points.grad_v = -np.ones_like(solver.points.grad_v) / solver.dt
    assert likely in fault_of(solver, 0).likely


@pytest.mark.parametrize(("cfl", "model"), STEPS)
def test_a_time_step_too_long_is_found_within_a_few_looks(cfl: float, model: str, tmp_path: Path) -> None:
    """Loading under gravity, from the first step on; what it comes from is said, and what helps."""
    case = mpmcol.load_case(MODELS[model][0], [*MODELS[model][1:]])
    run = set_up(case, build_model(case), tmp_path / "run", 1, lambda stage, share: None, lambda line: None)
    stage = run.model.equilibrate
    run.solver.clock[loop.DT] *= cfl / stage.settings.cfl
    run.model = replace(run.model, equilibrate=replace(stage, settings=stage.settings._replace(cfl=cfl)))
    with pytest.raises(NumericalFailure, match="a time step too long") as stopped:
        run.go()
    failure = stopped.value.failure
    assert failure["check"] in ("finite", "volume", "speed", "energy") and failure["smaller_step_helps"]
    assert failure["stage"] == "equilibrate" and "lower time.cfl" in failure["remedy"]
    assert run.course.sound <= 3


SOUND = (
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


@pytest.mark.parametrize("overrides", SOUND, ids=" ".join)
def test_sound_runs_are_let_be(overrides: tuple[str, ...], tmp_path: Path) -> None:
    """Also such as do badly what they do; the shipped cases are run by the regression tests."""
    case = mpmcol.load_case(
        "quickstart", ["grid.spacing=0.015", "stages.collapse.max_time_factor=2", *ALWAYS[1:], *overrides]
    )
    assert mpmcol.run(case, tmp_path / "run", threads=1).summary["status"] == "done"


def test_a_run_that_ends_in_no_numbers_still_has_its_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Snapshots of the last good state and of the last one, and a result that can be read."""
    case, looks = mpmcol.load_case("quickstart", ["grid.spacing=0.015", "output.snapshots=1"]), [0]
    look = Run._look

    def spoil(run: Run, lifting: float) -> None:
        look(run, lifting)
        looks[0] += 1
        if looks[0] == 8:
            run.solver.points.rows[:, VX] = NAN

    monkeypatch.setattr(Run, "_look", spoil)
    with pytest.raises(NumericalFailure, match=r"(?s)not finite.*last good state, snapshot 1, and"):
        mpmcol.run(case, tmp_path / "run", threads=1)
    results = Results(tmp_path / "run")
    failure = results.summary["failure"]
    assert results.status == "failed" and failure["check"] == "finite" and failure["value"] is None
    assert np.isfinite(failure["position"]).all()
    assert [results.snapshot(k).stage for k in range(3)] == ["release", "last_valid", "failed"]
    assert np.isfinite(results.snapshot(1).x).all() and results.snapshot(1).time < failure["time"]
    assert failure["last_valid"] == 1


def test_grains_far_ahead_are_told_of_and_no_fault(tmp_path: Path) -> None:
    run = Saboteur("plane", tmp_path, partial(faster, 0.9), "step").run
    top = run.solver.points.id == run.solver.points.id[run.solver.points.kind != BASE].max()
    run.solver.points.v[top, 0] = 0.9 * run.solver.settings.free_speed
    run.collapse()
    (told,) = run.course.warnings[-1:]
    row = run.recorder.rows[-1]
    assert f"front_max {row['front_max']:.4g} m, front_connected {row['front_connected']:.4g} m" in told


@pytest.mark.parametrize("model", ["plane", "quarter"])
def test_a_node_is_found_by_its_address(model: str, tmp_path: Path) -> None:
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
    """Against a library's; random ones, and such as are equal to each other."""
    number = np.random.default_rng(d)
    sigma = number.normal(0.0, 1e3, (200, 6))
    sigma[:20, 3:], sigma[:5, :3], sigma[5:9, 1] = 0.0, -5.0, sigma[5:9, 0]
    if d == 2:
        sigma[:, 4:] = 0.0
    xx, yy, zz, xy, yz, xz = sigma.T
    known = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).transpose(2, 0, 1))
    np.testing.assert_allclose(np.array(principal(*sigma.T)).T, known[:, ::-1], atol=1e-4)
