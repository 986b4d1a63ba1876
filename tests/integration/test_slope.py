"""Collapses on an inclined base: energies, runout, messages, charts, and flows that do not stop."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.errors import NumericalFailure
from mpmcol.io.results import Results
from mpmcol.measure import friction_from_repose
from mpmcol.plotting.captions import heading_of, heading_of_snapshot
from mpmcol.plotting.comparison import chart_comparison
from mpmcol.plotting.render.frame import read_for_rendering
from tests.support.cli import invoke

COARSE = ("grid.spacing=0.02", "output.snapshots=3")


def run_on(folder: Path, degrees: float, *overrides: str) -> Results:
    case = mpmcol.load_case("inclined-channel", [*COARSE, f"geometry.slope_deg={degrees}", *overrides])
    return mpmcol.run(case, folder, threads=1)


@pytest.fixture(scope="module")
def slope(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """A column at rest on a slope of 10 degrees."""
    return run_on(tmp_path_factory.mktemp("slope") / "run", 10.0)


@pytest.fixture(scope="module")
def level(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """The same column on a horizontal base."""
    return run_on(tmp_path_factory.mktemp("level") / "run", 0.0)


def test_the_energies_balance_with_the_work_of_gravity_along_the_slope(slope: Results) -> None:
    first, last = slope.snapshot(0), slope.snapshot(-1)
    moved = (first.arrays["position"] - last.arrays["position"]) @ slope.case.geometry.gravity_vector
    released = -float(np.sum(first.arrays["mass"] * moved))
    flow = slope.history["stage"] != "equilibrate"
    potential, residual = slope.history["potential"][flow], slope.history["residual"][flow]
    assert potential[0] - potential[-1] == pytest.approx(released, rel=1e-5)  # float32 positions
    assert slope.summary["dissipation"]["released"] == pytest.approx(released, rel=1e-5)
    assert np.abs(residual).max() < 1e-11 * released


def test_the_column_runs_farther_down_a_slope_and_comes_to_rest(slope: Results, level: Results) -> None:
    assert slope.came_to_rest and level.came_to_rest
    on_slope, on_level = (run.measure().zeta["front_height"] for run in (slope, level))
    assert 1.4 < on_slope / on_level < 2.2  # 1.6 by the law of the front, with tan(delta) = sin(phi)
    assert slope.summary["time_over_tau"] > level.summary["time_over_tau"]


def test_the_least_slope_agrees_with_a_horizontal_base(level: Results, tmp_path: Path) -> None:
    almost = run_on(tmp_path / "run", 1e-9)
    for name, front in level.measure().front.items():
        assert almost.measure().front[name] == pytest.approx(front, rel=0.03)


def test_assigned_stress_is_equilibrated_behind_the_gate(slope: Results) -> None:
    """By few steps, to the tolerance; the shear stress at the floor carries a part of the weight along the slope."""
    loading = slope.history["stage"] == "equilibrate"
    assert slope.history["unbalanced"][loading][-1] < slope.case.stages.equilibrate.tolerance
    assert slope.history["front_max"][loading][-1] == pytest.approx(0.2, abs=1e-3)
    arrays, (x, y) = slope.snapshot(0).arrays, slope.snapshot(0).x.T
    lowest = (y < 0.02) & (x > 0.05) & (x < 0.15)
    shear = float(arrays["stress"][lowest, 3].mean())
    assert 0.0 < shear < 1550.0 * 9.81 * np.sin(np.radians(10.0)) * 0.14


def test_laws_of_a_horizontal_base_are_not_compared(slope: Results) -> None:
    assert {entry["error"] for entry in slope.summary["errors"]} == {None}
    assert slope.summary["profile_scores"] == []
    printed = invoke("measure", str(slope.folder)).output
    assert "r_i = 200 mm, slope 10 deg" in printed
    assert "for a horizontal base; here it slopes by 10 deg" in printed
    angle = slope.measure().repose_angle_deg
    assert angle is not None and f"{angle:.1f} deg to the base, {angle + 10.0:.1f} deg to the horizontal" in printed
    record = json.loads(invoke("measure", str(slope.folder), "--json").stdout)
    assert record["friction_from_repose_deg"] == friction_from_repose(angle + 10.0)
    assert record["friction_from_repose_bias_deg"] is None
    assert f"friction from repose {record['friction_from_repose_deg']:9.1f} deg" in printed
    again = invoke("run", "inclined-channel", *(f"--set={one}" for one in COARSE), "--out", str(slope.folder)).output
    assert "Lube et al. 2007: for a horizontal base; here it slopes by 10 deg" in again
    assert "against" not in again and "--accuracy" not in again


def test_charts_and_renderings_state_the_slope(slope: Results, level: Results, tmp_path: Path) -> None:
    _, meta = read_for_rendering(slope.snapshots[-1])
    for heading in (heading_of(slope.case, slope.shape), heading_of_snapshot(meta)):
        assert r"base inclined by 10$\degree$" in heading.caption
    assert "inclined" not in heading_of(level.case, level.shape).caption
    assert len(chart_comparison([slope, level], out=tmp_path / "charts")) == 3
    rendered = invoke("render", str(slope.folder), "--out", str(tmp_path / "side.png"))
    assert rendered.exit_code == 0, rendered.output


def test_a_flow_that_does_not_stop_is_reported_as_such(tmp_path: Path) -> None:
    text = "the flow does not stop on this slope, since the friction of the material in shear is 25.5 degrees"
    steep = run_on(tmp_path / "a", 30.0, "stages.collapse.max_time_factor=2")
    before, after = [warning for warning in steep.summary["warnings"] if text in warning]
    assert before.startswith("geometry.slope_deg = 30: ") and 'stages.collapse.end = "time"' in before
    assert after.startswith("the column still moved at the time limit") and "twice as many" not in after
    with pytest.raises(NumericalFailure, match="end of the domain") as stopped:
        run_on(tmp_path / "b", 30.0, "geometry.domain_length=0.42")
    assert text in stopped.value.failure["likely"]
    timed = run_on(tmp_path / "c", 30.0, "stages.collapse.max_time_factor=0.5", "stages.collapse.end=time")
    assert not any(text in warning for warning in timed.summary["warnings"])


def test_a_full_column_runs_farther_downslope(tmp_path: Path) -> None:
    keys = ("geometry.model=full", "geometry.section=box", "grid.points_per_cell=8", "grid.spacing=0.04")
    results = run_on(tmp_path / "run", 20.0, *keys, "geometry.domain_length=0.6", "stages.collapse.max_time_factor=1.5")
    upslope, downslope = results.measure().zeta_range["front_connected"]
    assert downslope > upslope + 0.2
    last = results.snapshot(-1).arrays
    mean = np.average(last["position"], axis=0, weights=last["mass"])
    assert mean[0] > 0.01 and abs(mean[2]) < 1e-6
    assert abs(results.summary["ledger"]["residual"]) < 1e-9 * results.summary["dissipation"]["released"]
    printed = invoke("measure", str(results.folder)).output
    assert f"{upslope:.3f} to {downslope:.3f} from upslope to downslope" in printed
    assert r"base inclined by 20$\degree$ along x" in heading_of(results.case, results.shape).caption


def test_the_slopes_of_a_sweep() -> None:
    planned = json.loads(invoke("sweep", "--slope", "0:10:5", "--dry-run", "--json").stdout)["runs"]
    assert [run["inputs"]["geometry.slope_deg"] for run in planned] == [0.0, 5.0, 10.0]
    assert [run["folder"].partition("-")[0] for run in planned] == ["slope0deg", "slope5deg", "slope10deg"]
    steps = [run["steps"] for run in planned]
    assert steps == sorted(steps)
    refused = invoke("sweep", "cylinder", "--slope", "5", "--dry-run")
    assert refused.exit_code == 2 and 'must be 0 with geometry.model = "axisymmetric"' in refused.output
    twice = invoke("sweep", "--slope", "5", "--set", "geometry.slope_deg=5", "--dry-run")
    assert twice.exit_code == 2 and "geometry.slope_deg is given twice" in twice.output


def test_a_column_with_vertical_sides_on_the_least_slope_is_the_usual_one(level: Results, tmp_path: Path) -> None:
    almost = run_on(tmp_path / "run", 1e-9, "geometry.sides=vertical")
    for name, front in level.measure().front.items():
        assert almost.measure().front[name] == pytest.approx(front, rel=0.03)


def test_a_column_with_vertical_sides_comes_to_rest_below_repose(slope: Results, tmp_path: Path) -> None:
    """It has less material, whose centre is farther upslope, so that its front ends before that of the other."""
    run = run_on(tmp_path / "run", 10.0, "geometry.sides=vertical")
    assert run.came_to_rest
    assert (
        run.measure().profile_y[0] > 0.0
        and 0.0 < run.measure().zeta["front_height"] < slope.measure().zeta["front_height"]
    )
    first, last = run.history["potential"][0], run.history["potential"][-1]
    assert np.abs(run.history["residual"]).max() < 1e-11 * abs(first - last)
    released = run.snapshot(0)
    farthest = released.arrays["position"][released.column][:, :2]
    lean = np.tan(np.radians(10.0))
    assert (farthest[:, 0] + lean * farthest[:, 1]).max() < 0.2 + 0.5 * 0.02 / 3
