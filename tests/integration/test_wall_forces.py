"""Forces on floor, back wall and gate of a run."""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import cos, radians, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.cli.run_summary import summary_table
from mpmcol.io.results import Results
from mpmcol.measure.wall_forces import peak_forces, wall_force_summary
from mpmcol.report.measures import energy_measures
from mpmcol.report.runs import comparison_page, run_page
from mpmcol.report.walls import compared_forces, force_tables
from tests.support.cli import invoke

G, RHO, H_I, PHI = 9.81, 2650.0, 0.09, radians(33.0)
K_ACTIVE = (1.0 - sin(PHI)) / (1.0 + sin(PHI))
COARSE = ("grid.spacing=0.0075", "output.snapshots=1")


def run(folder: Path, *overrides: str) -> Results:
    return mpmcol.run(mpmcol.load_case("frictional-floor", [*COARSE, *overrides]), folder, threads=1)


@dataclass(frozen=True)
class Runs:
    """The shipped case on a coarse grid, and without recorded forces."""

    forces: Results
    plain: Results


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Runs:
    folder = tmp_path_factory.mktemp("walls")
    return Runs(run(folder / "forces"), run(folder / "plain", "output.wall_forces=false"))


def test_recording_forces_does_not_change_a_run(runs: Runs) -> None:
    assert runs.forces.summary["state_sha256"] == runs.plain.summary["state_sha256"]
    assert runs.plain.summary["wall_forces"] is None
    assert not any(name.startswith("force.") for name in runs.plain.history)
    header = (runs.forces.folder / "history.csv").read_text().partition("\n")[0]
    forces = "force.floor.y [N/m],force.back_wall.x [N/m],force.back_wall.y [N/m],force.gate.x [N/m],force.gate.y [N/m]"
    assert header.endswith(f"{forces},moment.floor [N m/m],moment.back_wall [N m/m],moment.gate [N m/m]")


def test_the_gate_carries_the_active_thrust_before_it_opens(runs: Runs) -> None:
    """1/2 K_a rho g H^2 within 3 %, and the back wall as much; the floor carries the weight."""
    thrust, forces = 0.5 * K_ACTIVE * RHO * G * H_I**2, runs.forces.summary["wall_forces"]
    assert forces["gate"]["at_release"] == pytest.approx(thrust, rel=0.03)
    assert forces["back_wall"]["at_release"] == pytest.approx(thrust, rel=0.03)
    assert forces["floor"]["at_release"] == pytest.approx(RHO * G * 0.09 * H_I, rel=0.001)
    assert forces["gate"]["at_end"] == 0.0


def test_the_moment_on_the_floor_is_that_of_the_weight_and_of_the_back_wall(runs: Runs) -> None:
    """At release of r_i / 2, since gate and back wall balance; at the end of the centre of mass of the deposit."""
    forces, last = runs.forces.summary["wall_forces"], runs.forces.snapshot(-1)
    assert forces["floor"]["moment_at_release"] == pytest.approx(RHO * G * 0.09 * H_I * 0.045, rel=0.01)
    weight, mass = RHO * G * 0.09 * H_I, last.arrays["mass"]
    centre = float(np.average(last.arrays["position"][:, 0], weights=mass))
    assert forces["floor"]["moment_at_end"] == pytest.approx(
        weight * centre + forces["back_wall"]["moment_at_end"], rel=0.01
    )
    assert 0.06 < centre < 0.09  # it has moved
    text = summary_table(runs.forces)
    assert "force on floor: at most" in text and "force on back_wall: at most" in text


def test_measure_gives_the_same_forces_as_the_run(runs: Runs) -> None:
    lines = [line for line in summary_table(runs.forces).splitlines() if line.startswith("force on ")]
    assert len(lines) == 2
    assert [line for line in invoke("measure", runs.forces.folder).stdout.splitlines() if line in lines] == lines
    record = json.loads(invoke("measure", runs.forces.folder, "--json").stdout)
    assert record["wall_forces"] == runs.forces.summary["wall_forces"]
    assert "force on" not in invoke("measure", runs.forces.folder, "--snapshot", "0").stdout  # of the whole collapse
    assert "force on" not in invoke("measure", runs.plain.folder).stdout
    assert json.loads(invoke("measure", runs.plain.folder, "--json").stdout)["wall_forces"] is None


def test_a_report_has_a_table_of_forces(runs: Runs) -> None:
    (table,) = force_tables(runs.forces)
    rows = {row[0]: dict(zip(table.columns, row, strict=True)) for row in table.rows}
    floor = runs.forces.summary["wall_forces"]["floor"]
    assert list(rows) == ["floor", "back wall", "gate"]
    for column, name in {"peak (N/m)": "peak", "end of the peak (s)": "time", "at release (N/m)": "at_release"}.items():
        assert rows["floor"][column] == f"{floor[name]:.3g}"
    assert rows["floor"][table.columns[-1]] == f"{floor['moment']:.3g}" and "(N m/m)" in table.columns[-1]
    assert force_tables(runs.plain) == []
    (section,) = [one for one in run_page(runs.forces).sections if one.title == "Measurements"]
    assert table in section.tables


def test_runs_are_compared_by_their_largest_forces(runs: Runs) -> None:
    page = comparison_page([runs.plain, runs.forces])
    (table,) = [one for section in page.sections for one in section.tables if one.caption.startswith("Forces on walls")]
    assert table.caption.endswith("(not recorded: plain)")
    rows = {row[0]: row[1:] for row in table.rows}
    peak = runs.forces.summary["wall_forces"]["back_wall"]["peak"]
    assert rows["Force on back wall, peak"] == ["none", f"{peak:.3g} N/m"]
    assert len(rows) == 6 and not any("gate" in name for name in rows)  # nothing presses on a gate that is gone
    assert compared_forces(["a", "b"], [runs.plain, runs.plain]) == []


def test_shares_of_points_without_stress_have_one_precision(runs: Runs) -> None:
    (share,) = [one.text for one in energy_measures(runs.forces) if one.name.endswith("without stress")]
    assert f"points inside without stress: {share}" in summary_table(runs.forces)


def test_the_moment_on_the_floor_below_a_cylinder_is_at_two_thirds_of_its_radius(tmp_path: Path) -> None:
    options = ["grid.spacing=0.0097", "grid.points_per_cell=4", "geometry.aspect=0.8", "geometry.base=rigid"]
    options += ["method.wall_impulse=true", "stages.initial_stress=k0", "friction.floor=0", "output.wall_forces=true"]
    case = mpmcol.load_case("quickstart", [*options, "stages.collapse.max_time_factor=0.2", "output.snapshots=1"])
    forces = mpmcol.run(case, tmp_path, threads=1).summary["wall_forces"]["floor"]
    assert forces["moment_at_release"] == pytest.approx(forces["at_release"] * 2.0 / 3.0 * case.geometry.r_i, rel=0.01)


def test_the_deposit_presses_on_the_back_wall_between_its_active_and_passive_state(runs: Runs) -> None:
    """0.288 rho g h^2 / 2: less than K_a of a level surface, more than Coulomb's K of one that falls from the wall."""
    force, height = runs.forces.summary["wall_forces"]["back_wall"]["at_end"], runs.forces.summary["height"]
    slope = radians(runs.forces.summary["repose_angle_deg"])
    falling = (cos(PHI) / (1.0 + sqrt(sin(PHI) * sin(PHI + slope) / cos(slope)))) ** 2
    assert falling < K_ACTIVE
    assert falling < force / (0.5 * RHO * G * height**2) < 1.0 / K_ACTIVE


def test_forces_weight_and_damping_change_the_momentum(runs: Runs) -> None:
    """Without damping the mean force on the floor over the collapse is the weight, since the column ends at rest."""
    history = runs.forces.history
    flow = history["stage"] == "collapse"
    steps = np.diff(history["time"][flow], prepend=0.0)
    mean = steps @ history["force.floor.y"][flow] / steps.sum()
    assert mean == pytest.approx(-RHO * G * 0.09 * H_I, rel=0.01)
    push = steps @ history["force.back_wall.x"][flow]
    drag = steps @ history["force.floor.x"][flow]
    assert push < 0.0 < drag and drag == pytest.approx(-push, rel=0.1)


def test_friction_on_the_floor_is_in_the_ledger(runs: Runs) -> None:
    summary = runs.forces.summary
    assert 0.05 < summary["dissipation"]["wall_friction"] < 0.3
    assert abs(summary["dissipation"]["walls"]) < 0.01
    assert abs(summary["ledger"]["residual"]) < 1e-12 * summary["ledger"]["potential"]
    assert np.all(np.diff(runs.forces.history["wall_friction"][runs.forces.history["stage"] == "collapse"]) > -1e-9)


def test_the_peak_is_that_of_the_mean_over_the_window() -> None:
    time = np.arange(11.0)
    force = np.where(time == 4.0, 10.0, 1.0)
    history = {"stage": np.array(["release", *10 * ["collapse"]]), "time": time, "force.gate.x": -force}
    assert peak_forces(history, 0.5) == {
        "gate": {"at_release": 1.0, "peak": 10.0, "time": 4.0, "window": 1.0, "at_end": 1.0}
    }
    wide = peak_forces(history, 2.5)
    assert wide is not None and wide["gate"]["peak"] == pytest.approx(4.0) and wide["gate"]["window"] == 3.0
    assert peak_forces(history, 20.0) is None
    assert peak_forces({name: history[name] for name in ("stage", "time")}, 0.5) is None


def test_the_sustained_force_is_that_over_a_time_that_does_not_depend_on_the_grid() -> None:
    time = np.arange(11.0)
    force = np.where(time == 4.0, 10.0, 1.0)
    history = {"stage": np.array(["release", *10 * ["collapse"]]), "time": time, "force.gate.x": -force}
    for window in (0.5, 1.0):
        summary = wall_force_summary(history, window, fall_time=12.5)
        assert summary is not None and summary["gate"]["peak"] == 10.0
        assert summary["gate"]["sustained"] == pytest.approx(4.0)
    short = wall_force_summary(history, 0.5, fall_time=100.0)
    assert short is not None and short["gate"]["sustained"] is None
    assert wall_force_summary({name: history[name] for name in ("stage", "time")}, 0.5, 12.5) is None
