"""The state of a simulation: copies, restoring, checkpoints and the retry with half the time step."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mpmcol
from mpmcol.io.checkpoint import read_checkpoints, write_checkpoint
from mpmcol.io.names import CASE_FILE
from mpmcol.io.snapshot import list_snapshots, read_snapshot
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.particles import BASE
from mpmcol.mpm.solver import Solver
from mpmcol.setup.model import build_model
from mpmcol.simulation.checkpointer import make_checkpoint
from mpmcol.simulation.derived import history_of_laws
from mpmcol.simulation.failure import finite_fields
from mpmcol.simulation.recorder import Recorder
from mpmcol.simulation.restart import resume
from mpmcol.simulation.retry import MAX_RETRIES, halve_time_step
from mpmcol.simulation.run import _write_last_valid_state, start
from mpmcol.simulation.stages import Stages
from mpmcol.simulation.state import STATES_FOR_RETRY, Simulation
from mpmcol.simulation.summary import state_checksum
from tests.support.runs import TINY

FAILURE: dict[str, Any] = {
    "check": "speed", "cause": "too fast", "stage": "collapse", "step": 9, "time": 0.1, "smaller_step_helps": True
}  # fmt: skip


def case() -> mpmcol.Case:
    return mpmcol.load_case("coarse-channel", [*TINY, "stages.initial_stress=k0"])


def released(folder: Path, retry: bool = False) -> Simulation:
    """A small run immediately after its release."""
    simulation = start(case(), build_model(case()), folder, retry=retry)
    Stages(simulation).release()
    return simulation


def advance(simulation: Simulation, duration: float = 0.02) -> None:
    end = simulation.solver.time + duration
    while simulation.solver.time < end:
        assert simulation.solver.advance(end) == -1


def test_a_recorder_writes_nothing_before_it_is_opened(tmp_path: Path) -> None:
    model = build_model(case())
    stage = model.equilibrate
    solver = Solver(model.points, model.grid, stage.settings, stage.column, model.base, model.scheme, model.contacts)
    recorder = Recorder(case(), model, solver, tmp_path / "run", threads=1)
    assert not (tmp_path / "run").exists()
    recorder.open()
    assert [path.name for path in (tmp_path / "run").iterdir()] == [CASE_FILE]


def test_a_run_continues_from_a_copy_of_its_state_with_equal_bits(tmp_path: Path) -> None:
    simulation = released(tmp_path)
    advance(simulation)
    state = simulation.state().copy()
    advance(simulation)
    first = state_checksum(simulation.solver)
    simulation.set_state(state)
    advance(simulation)
    assert state_checksum(simulation.solver) == first


def test_a_checkpoint_restores_state_and_valid_states(tmp_path: Path) -> None:
    simulation = released(tmp_path / "one", retry=True)
    advance(simulation)
    simulation.keep_valid_state()
    advance(simulation)
    write_checkpoint(tmp_path, make_checkpoint(simulation, serial=1))
    (checkpoint,), damaged = read_checkpoints(tmp_path)
    (tmp_path / "one" / "snapshots").rename(tmp_path / "snapshots")
    resumed = start(case(), build_model(case()), tmp_path, retry=True)
    resume(resumed, checkpoint)
    assert not damaged and state_checksum(resumed.solver) == state_checksum(simulation.solver)
    assert len(resumed.valid_states) == STATES_FOR_RETRY
    for mine, other in zip(resumed.valid_states, simulation.valid_states, strict=True):
        np.testing.assert_array_equal(mine.points, other.points)
        assert mine.progress == other.progress


def test_a_retry_returns_to_the_older_valid_state_with_half_the_time_step(tmp_path: Path) -> None:
    simulation = released(tmp_path, retry=True)
    older = simulation.valid_states[0]
    advance(simulation)
    simulation.keep_valid_state()
    advance(simulation)
    assert halve_time_step(simulation, FAILURE)
    assert simulation.solver.time == older.time and simulation.progress.cfl_factor == 0.5
    assert simulation.solver.dt == 0.5 * older.clock[loop.DT]
    assert list(simulation.valid_states) == [older] and len(simulation.progress.retries) == 1


@pytest.mark.parametrize("reason", ["off", "of no use", "exhausted"])
def test_without_retry_the_state_is_unchanged(reason: str, tmp_path: Path) -> None:
    simulation = released(tmp_path, retry=reason != "off")
    if reason == "exhausted":
        simulation.progress.retries = [FAILURE] * MAX_RETRIES
    advance(simulation)
    before = state_checksum(simulation.solver)
    assert not halve_time_step(simulation, FAILURE | {"smaller_step_helps": reason != "of no use"})
    assert state_checksum(simulation.solver) == before


def test_further_retries_from_one_state_halve_the_time_step_again(tmp_path: Path) -> None:
    simulation = released(tmp_path, retry=True)
    first = simulation.valid_states[0].clock[loop.DT]
    for number in range(1, MAX_RETRIES + 1):
        advance(simulation, 0.005)
        assert halve_time_step(simulation, FAILURE)
        assert simulation.solver.dt == 0.5**number * first


def test_a_snapshot_after_the_last_check_is_not_the_last_valid_state(tmp_path: Path) -> None:
    simulation = released(tmp_path)
    recorder, failure = simulation.recorder, dict(FAILURE)
    recorder.open()
    simulation.valid_states.clear()
    advance(simulation)
    simulation.keep_valid_state()
    recorder.record("collapse")
    advance(simulation, 0.005)
    recorder.write_snapshot("collapse")
    recorder.record("collapse")  # the check that fails
    _write_last_valid_state(simulation, failure)
    assert recorder.snapshot_times[failure["last_valid"]] == simulation.valid_states[-1].time
    assert read_snapshot(list_snapshots(recorder.folder)[failure["last_valid"]]).stage == "last_valid"


def test_history_of_the_law_of_a_bed_is_stored_and_checked(tmp_path: Path) -> None:
    angles = [f"{name}_{end}_deg=30" for name in ("friction", "dilatancy") for end in ("peak", "residual")]
    bed = ("law=mohr-coulomb-softening", "softening_rate=2", *angles)
    sand = mpmcol.load_case("granular-bed", ["grid.spacing=0.015", *(f"base_material.{key}" for key in bed)])
    simulation = start(sand, build_model(sand), tmp_path)
    points = simulation.solver.points
    points.history[:, 0] = 0.5
    stored = history_of_laws(sand, points)["plastic_shear_strain"]
    assert np.array_equal(stored, np.where(points.kind == BASE, 0.5, 0.0))
    points.history[points.kind == BASE, 0] = np.nan
    assert not finite_fields(simulation.solver)["history of the law"][points.kind == BASE].any()
