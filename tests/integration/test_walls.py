"""Runs with walls in the way of the flow: forces, moments and pressures, overtopping, and results."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians, sin
from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.io.results import Results

G, RHO, H_I, R_I, PHI = 9.81, 2650.0, 0.09, 0.09, radians(33.0)
K_ACTIVE = (1.0 - sin(PHI)) / (1.0 + sin(PHI))
WEIGHT = RHO * G * H_I * R_I


def run(folder: Path, *overrides: str) -> Results:
    return mpmcol.run(mpmcol.load_case("dam", [*overrides, "output.snapshots=1"]), folder, threads=1)


@dataclass(frozen=True)
class Runs:
    dam: Results
    end: Results  # a smooth end wall


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Runs:
    folder = tmp_path_factory.mktemp("walls")
    return Runs(run(folder / "dam"), run(folder / "end", "walls=[{from=0.135, name='end'}]"))


def pressures(results: Results, wall: str, face: str, state: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions (m), forces (N/m) and pressures (Pa) of the rows of a face."""
    table = results.wall_pressure
    rows = (table["wall"] == wall) & (table["face"] == face) & (table["state"] == state)
    return table["position"][rows], table["force"][rows], table["pressure"][rows]


def test_the_ledger_closes_and_the_column_comes_to_rest(runs: Runs) -> None:
    for results in (runs.dam, runs.end):
        summary = results.summary
        assert summary["at_rest"] and abs(summary["ledger"]["residual"]) < 1e-12 * summary["ledger"]["potential"]
        assert not any("detached" in text or "arrested" in text for text in summary["warnings"])


def test_a_deposit_that_ends_at_a_wall_is_noted(runs: Runs, tmp_path: Path) -> None:
    (note,) = [line for line in runs.dam.summary["warnings"] if "ends at" in line]
    assert note == "the deposit ends at the wall dam: runout and angle of repose depend on it"
    for name, wall in (("far", "{from=0.4, to=0.42, height=0.05}"), ("low", "{from=0.12, to=0.135, height=0.015}")):
        free = run(tmp_path / name, f"walls=[{wall}]")
        assert free.came_to_rest and not any("ends at" in line for line in free.summary["warnings"])


def test_no_point_is_in_the_dam_and_walls_have_no_published_runout(runs: Runs) -> None:
    x = runs.dam.snapshot(-1).x
    assert not ((x[:, 0] > 0.15) & (x[:, 0] < 0.18) & (x[:, 1] < 0.03)).any()
    assert all(error["error"] is None and "walls" in error["comment"] for error in runs.dam.summary["errors"])


def test_the_deposit_presses_on_an_end_wall_between_its_active_and_passive_state(runs: Runs) -> None:
    x = runs.end.snapshot(-1).x
    height = x[x[:, 0] > 0.135 - 0.0075, 1].max() + 0.25 * 0.0075
    force, hydrostatic = runs.end.summary["wall_forces"]["end"]["at_end"], 0.5 * RHO * G * height**2
    assert K_ACTIVE < force / hydrostatic < 1.0 / K_ACTIVE
    assert runs.end.summary["wall_forces"]["end"]["peak"] > force


@pytest.mark.parametrize("name", ["dam", "end"])
def test_profiles_are_the_forces_of_the_last_rows(runs: Runs, name: str) -> None:
    """The sum of the rows of all vertical faces is the mean force; the top of the dam has a small friction."""
    results: Results = getattr(runs, name)
    time, force = results.history["time"], results.history[f"force.{name}.x"]
    steps = np.diff(time)[-10:]
    mean = steps @ force[-10:] / steps.sum()
    low, high = (pressures(results, name, face, "end")[1] for face in ("low_x", "high_x"))
    assert low.sum() - high.sum() == pytest.approx(mean, rel=1e-9 if name == "end" else 2e-3)


def test_the_gate_has_the_active_pressure_and_its_moment(runs: Runs) -> None:
    """Pressures of gate and back wall are K_a rho g (H - y) within 5 % of that at the foot, the arm is H / 3."""
    for wall, face in (("gate", "low_x"), ("back_wall", "high_x")):
        y, _, pressure = pressures(runs.dam, wall, face, "release")
        exact = K_ACTIVE * RHO * G * np.maximum(H_I - y, 0.0)
        np.testing.assert_allclose(pressure, exact, atol=0.12 * exact.max())
        inside = (y > 0.02) & (y < 0.08)
        np.testing.assert_allclose(pressure[inside], exact[inside], atol=0.02 * exact.max())
        forces = runs.dam.summary["wall_forces"][wall]
        assert forces["moment_at_release"] / forces["at_release"] == pytest.approx(H_I / 3.0, rel=0.03)


def test_the_floor_carries_the_weight_of_the_column(runs: Runs) -> None:
    x, force, pressure = pressures(runs.dam, "floor", "top", "release")
    assert force.sum() == pytest.approx(WEIGHT, rel=1e-3)
    inside = x < 0.07
    np.testing.assert_allclose(pressure[inside], RHO * G * H_I, rtol=0.06)


def test_a_low_dam_is_overtopped_and_a_high_one_is_not(runs: Runs, tmp_path: Path) -> None:
    def beyond(results: Results, x: float) -> float:
        snapshot = results.snapshot(-1)
        return float(snapshot.arrays["mass"][snapshot.x[:, 0] > x].sum()) / (RHO * H_I * R_I)

    near = ("walls.0.from=0.12", "walls.0.to=0.15", "walls.0.height=0.015")
    low = run(tmp_path / "low", *near, "friction.floor=0.1", "stages.collapse.max_time_factor=4")
    assert beyond(low, 0.15) > 0.02 and beyond(runs.dam, 0.18) == 0.0
    assert low.history["force.dam.y"].min() < 0.0
    x = low.snapshot(-1).x
    assert not ((x[:, 0] > 0.12) & (x[:, 0] < 0.15) & (x[:, 1] < 0.015)).any()


def test_runs_with_walls_have_equal_bits_with_two_threads(runs: Runs, tmp_path: Path) -> None:
    case = mpmcol.load_case("dam", ["output.snapshots=1"])
    two = mpmcol.run(case, tmp_path / "two", threads=2).summary
    assert two["state_sha256"] == runs.dam.summary["state_sha256"]
    assert two["wall_forces"] == runs.dam.summary["wall_forces"]


@pytest.mark.parametrize(
    ("case", "overrides"),
    [
        (
            "quickstart",
            ("grid.spacing=0.0097", "grid.points_per_cell=4", "geometry.aspect=1", "output.wall_forces=true"),
        ),
        (
            "quarter",
            ("grid.spacing=0.0194", "geometry.aspect=0.5", "stages.initial_stress=k0", "geometry.base=rigid",
             "method.wall_impulse=true", "output.wall_forces=true"),
        ),
    ],
    ids=["ring wall", "quarter"],
)  # fmt: skip
def test_walls_in_axisymmetry_and_three_dimensions(case: str, overrides: tuple[str, ...], tmp_path: Path) -> None:
    width = ", half_width=0.0776" if case == "quarter" else ""
    walls = f"walls=[{{from=0.1358, to=0.194, height=0.0582{width}}}]"
    end = ("stages.collapse.max_time_factor=3", "output.snapshots=1")
    results = mpmcol.run(mpmcol.load_case(case, [*overrides, *end, walls]), tmp_path / "run", threads=1)
    summary, x = results.summary, results.snapshot(-1).x
    assert abs(summary["ledger"]["residual"]) < 1e-11 * summary["ledger"]["potential"]
    assert summary["wall_forces"]["wall-1"]["peak"] > 0.0 and summary["wall_forces"]["wall-1"]["moment"] > 0.0
    inside = (x[:, 0] > 0.1358) & (x[:, 0] < 0.194) & (x[:, 1] < 0.0582)
    assert not (inside & (x[:, 2] < 0.0776) if case == "quarter" else inside).any()


AT_REST = (  # before the release in the active state, on a smooth floor
    "geometry.base=rigid", "method.wall_impulse=true", "stages.initial_stress=k0", "friction.floor=0",
    "stages.equilibrate.law=mohr-coulomb", "output.wall_forces=true", "output.snapshots=1",
    "stages.collapse.max_time_factor=0.2", "geometry.aspect=0.8",
)  # fmt: skip
R_I_ROUND, H_I_ROUND = 0.097, 0.0776


def gate_at_rest(case: str, folder: Path, *overrides: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Positions (m), forces (N) and pressures (Pa) of the rows of the gate, and the moment on it (N m)."""
    results = mpmcol.run(mpmcol.load_case(case, [*AT_REST, *overrides]), folder, threads=1)
    face = "side" if results.shape.dimension == 3 else "low_x"
    moment = results.summary["wall_forces"]["gate"]["moment_at_release"]
    return *pressures(results, "gate", face, "release"), moment


@pytest.mark.parametrize(
    ("case", "overrides", "length"),
    [
        ("quickstart", ("grid.points_per_cell=4",), R_I_ROUND),
        ("quarter", ("geometry.section=box", "geometry.depth=0.0582"), R_I_ROUND + 0.0582),
    ],
    ids=["axisymmetric", "box"],
)
def test_the_gate_around_a_column_has_the_active_pressure(
    case: str, overrides: tuple[str, ...], length: float, tmp_path: Path
) -> None:
    """Thrust 1/2 K_a rho g H^2 per length within 3 %, arm H / 3, pressures K_a rho g (H - y)."""
    y, force, pressure, moment = gate_at_rest(case, tmp_path / "run", "grid.spacing=0.0097", *overrides)
    thrust = 0.5 * K_ACTIVE * RHO * G * H_I_ROUND**2 * length
    assert force.sum() == pytest.approx(thrust, rel=0.03)
    assert moment == pytest.approx(force.sum() * H_I_ROUND / 3.0, rel=0.02)
    inside = (y > 0.005) & (y < 0.9 * H_I_ROUND)
    exact = K_ACTIVE * RHO * G * (H_I_ROUND - y)
    np.testing.assert_allclose(pressure[inside], exact[inside], atol=0.02 * exact.max())


def test_the_gate_of_a_full_cylinder_has_four_times_the_force_of_a_quarter(tmp_path: Path) -> None:
    """Moment and forces are outward: they do not cancel around the column. The moment is that of the rows."""
    y, quarter, pressure, moment = gate_at_rest("quarter", tmp_path / "quarter", "grid.spacing=0.0194")
    _, full, same, whole = gate_at_rest("quarter", tmp_path / "full", "grid.spacing=0.0194", "geometry.model=full")
    np.testing.assert_allclose(full, 4.0 * quarter, atol=2e-3 * full.max())
    np.testing.assert_allclose(same, pressure, atol=2e-3 * same.max())
    assert whole == pytest.approx(4.0 * moment, rel=5e-3)
    assert moment == pytest.approx(y @ quarter, rel=0.01)
    assert moment / quarter.sum() == pytest.approx(H_I_ROUND / 3.0, rel=0.06)
