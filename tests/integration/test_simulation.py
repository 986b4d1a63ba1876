"""`mpmcol run`: results folder, messages, exit codes and failures."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import mpmcol
from mpmcol.case import load_case
from mpmcol.errors import NumericalFailure, OutputError, UsageError
from mpmcol.io.lock import locked
from mpmcol.io.results import HISTORY, Results, measure_stop_time
from mpmcol.io.snapshot import read_meta
from mpmcol.setup.discretization import discretize
from mpmcol.setup.memory import grid_bytes, memory_bytes, require_memory_for
from mpmcol.setup.model import build_model
from mpmcol.simulation.stages import Stages
from tests.support.cli import invoke, set_options
from tests.support.runs import TINY


def tiny(*more: str) -> list[str]:
    return set_options((*TINY, *more))


def test_the_results_folder_is_complete(finished: Path) -> None:
    for name in ("case.resolved.toml", "result.json", "history.csv", "run.vtkhdf", "run.vtkhdf.series"):
        assert (finished / name).is_file(), name
    results = Results(finished)
    assert len(results.snapshots) == 4  # release, two on the way, rest
    meta = read_meta(results.snapshots[0])
    assert {"case", "mpmcol", "numba", "threads", "spacing"} <= set(meta)
    assert mpmcol.load_case(finished / "case.resolved.toml") == results.case


def test_the_result_has_all_keys(finished: Path) -> None:
    summary = json.loads((finished / "result.json").read_text())
    expected = {
        "schema", "status", "zeta", "front", "beta", "height", "errors", "points", "steps", "wall_s",
        "ns_per_point_step", "ledger", "worst_J", "versions", "threads", "case_hash",
    }  # fmt: skip
    assert expected <= set(summary)
    assert summary["status"] == "done"
    assert set(summary["wall_s"]) == {"compile", "equilibrate", "collapse", "output"}


def test_the_result_equals_what_measure_computes_from_the_files(finished: Path) -> None:
    """The final state is measured in memory, in the precision of the stored snapshot."""
    summary, results = json.loads((finished / "result.json").read_text()), Results(finished)
    measured = json.loads(json.dumps(results.measure().scalars()))
    assert {name: summary[name] for name in measured} == measured
    stop_time = measure_stop_time(results.history, results.shape.spacing, (0.09 / 9.81) ** 0.5)
    assert summary["stop_time"] == (stop_time if summary["at_rest"] else None)


def test_snapshots_start_undisplaced_and_move_outward(finished: Path) -> None:
    results = Results(finished)
    assert np.abs(results.snapshot(0).arrays["displacement"]).max() == 0.0
    last = results.snapshot(-1)
    assert last.arrays["displacement"][last.column, 0].max() > 0.01
    assert results.measure(-1).zeta["front_max"] > results.measure(0).zeta["front_max"] == pytest.approx(0.0, abs=2e-3)
    assert results.measure(0).beta == pytest.approx(1.0, abs=0.01)


def test_history_can_be_read_between_snapshots(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mpmcol.simulation.recorder.WRITE_INTERVAL", 0.0)
    lengths = []
    overrides = ["grid.spacing=0.015", "output.snapshots=1", "stages.collapse.max_time_factor=0.2"]
    folder = tmp_path / "run"

    def count_rows(stage: str, fraction: float) -> None:
        path = folder / "history.csv"
        lengths.append(len(path.read_text().splitlines()) if path.exists() else 0)

    mpmcol.run(load_case("coarse-channel", overrides), folder, progress=count_rows)
    assert len(set(lengths)) > 10


def test_the_history_is_ordered_and_its_energies_balance(finished: Path) -> None:
    history = Results(finished).history
    assert tuple(history) == HISTORY
    flow = history["stage"] == "collapse"
    assert np.all(np.diff(history["time"][flow]) > 0.0)
    assert np.all(history["time"][history["stage"] == "equilibrate"] <= 0.0)
    total = sum(
        history[name][flow]
        for name in ("kinetic", "potential", "elastic", "plastic", "filter", "damping", "walls", "transfer")
    )
    start = total - history["residual"][flow]
    np.testing.assert_allclose(start, start[0], rtol=1e-9)


def test_a_finished_run_is_not_replaced(finished: Path) -> None:
    before = (finished / "result.json").read_bytes()
    assert invoke("run", "coarse-channel", *tiny(), "--out", str(finished)).exit_code == 0  # its result is printed
    again = invoke("run", "coarse-channel", *tiny("geometry.aspect=0.5"), "--out", str(finished))
    assert again.exit_code == 2
    assert "--fresh" in again.output and "Traceback" not in again.output
    assert (finished / "result.json").read_bytes() == before


def test_a_folder_with_other_files_is_refused(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    result = invoke("run", "coarse-channel", *tiny(), "--out", str(tmp_path))
    assert result.exit_code == 2
    assert (tmp_path / "thesis.txt").read_text() == "mine"


def test_fresh_replaces_a_run_with_equal_bits(finished: Path, tmp_path: Path) -> None:
    case = mpmcol.load_case("coarse-channel", TINY)
    mpmcol.run(case, tmp_path / "a")
    first = Results(tmp_path / "a").snapshot(-1)
    again = mpmcol.run(case, tmp_path / "a", fresh=True).snapshot(-1)
    for name, values in first.arrays.items():
        np.testing.assert_array_equal(values, again.arrays[name], err_msg=name)
    np.testing.assert_array_equal(first.x, Results(finished).snapshot(-1).x)


def test_fresh_removes_the_charts_of_the_old_run(tmp_path: Path) -> None:
    case, pictures = mpmcol.load_case("coarse-channel", TINY), ("snapshot-000003.png", "front.svg", "collapse.gif")
    mpmcol.run(case, tmp_path)
    for name in (*pictures, "mine.png"):
        (tmp_path / name).write_bytes(b"")
    mpmcol.run(case, tmp_path, fresh=True)
    assert {path.name for path in tmp_path.iterdir()} & {*pictures, "mine.png"} == {"mine.png"}


def test_json_is_one_line(tmp_path: Path) -> None:
    result = invoke("run", "coarse-channel", *tiny(), "--out", str(tmp_path / "a"), "--json")
    assert json.loads(result.stdout)["status"] == "done"
    assert result.stdout.count("\n") == 1


def test_quiet_prints_nothing(tmp_path: Path) -> None:
    assert invoke("run", "coarse-channel", *tiny(), "--out", str(tmp_path / "a"), "--quiet").output == ""


def test_dry_run_estimates_and_writes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = invoke("run", "coarse-channel", *tiny(), "--dry-run")
    assert result.exit_code == 0
    for text in ("material points", "grid nodes", "useful threads", "time step", "steps", "memory", "disk", "time"):
        assert text in result.output
    assert list(tmp_path.iterdir()) == []
    estimate = json.loads(invoke("run", "coarse-channel", *tiny(), "--dry-run", "--json").stdout)
    assert estimate["column_points"] == 144
    assert invoke("run", "coarse-channel", "--set", "grid.spacng=1", "--dry-run").exit_code == 2


def test_divergence_is_reported_with_position_cause_and_remedy(tmp_path: Path) -> None:
    result = invoke("run", "coarse-channel", *tiny("time.cfl=1.9"), "--out", str(tmp_path / "a"))
    assert result.exit_code == 3, result.output
    for text in ("stage", "step", "t =", "point", "x =", "remedy", "time.cfl"):
        assert text in result.output
    results = Results(tmp_path / "a")
    assert results.summary["status"] == "failed"
    assert set(results.summary["failure"]) == {
        "check", "cause", "likely", "stage", "step", "time", "point", "position", "value", "limit", "remedy",
        "smaller_step_helps", "last_valid",
    }  # fmt: skip
    assert results.snapshot(-1).stage == "failed"
    again = invoke("run", "coarse-channel", *tiny("time.cfl=1.9"), "--out", str(tmp_path / "a"))
    assert again.exit_code == 3 and "is replaced" not in again.output
    corrected = invoke("run", "coarse-channel", *tiny(), "--out", str(tmp_path / "a"))
    assert corrected.exit_code == 0 and "note: an incomplete run of another case" in corrected.output


def test_flow_that_reaches_the_end_of_the_domain_stops_the_run(tmp_path: Path) -> None:
    case = mpmcol.load_case(
        "coarse-channel", [*TINY, "geometry.domain_length=0.165", "stages.collapse.max_time_factor=4.0"]
    )
    with pytest.raises(NumericalFailure, match=r"end of the domain.*\n.*\n.*\n.*geometry\.domain_length"):
        mpmcol.run(case, tmp_path / "a")
    with pytest.raises(UsageError, match=r"geometry\.domain_length = 0\.1 m is too small"):
        mpmcol.run(mpmcol.load_case("coarse-channel", [*TINY, "geometry.domain_length=0.1"]), tmp_path / "b")


def test_rounding_of_the_spacing_is_reported(tmp_path: Path) -> None:
    result = invoke("run", "coarse-channel", *tiny("grid.spacing=0.016"), "--out", str(tmp_path / "a"))
    assert "grid.spacing became 0.015 m (-6.25%)" in result.output


def test_a_folder_without_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="expected the results folder of a run"):
        Results(tmp_path)
    assert invoke("measure", str(tmp_path)).exit_code == 5


def fronts_of(tmp_path: Path, speed: str, *more: str) -> tuple[np.ndarray, np.ndarray, dict]:
    case = mpmcol.load_case("coarse-channel", [*TINY, f"stages.gate_speed={speed}", *more])
    results = mpmcol.run(case, tmp_path / speed)
    flow = results.history["stage"] == "collapse"
    return results.history["time"][flow], results.history["front_max"][flow], results.summary


def test_lifted_gate_delays_the_front(tmp_path: Path) -> None:
    (t, gone, _), (t_slow, slow, _) = fronts_of(tmp_path, "inf"), fronts_of(tmp_path, "0.5")
    assert np.interp(0.08, t_slow, slow) < np.interp(0.08, t, gone) - 0.002


def test_a_very_fast_gate_equals_no_gate(tmp_path: Path) -> None:
    (_, gone, _), (_, fast, _) = fronts_of(tmp_path, "inf"), fronts_of(tmp_path, "200")
    assert fast[-1] == pytest.approx(gone[-1], abs=0.002)


def test_a_column_behind_a_slow_gate_is_not_at_rest(tmp_path: Path) -> None:
    t, _, summary = fronts_of(tmp_path, "0.1", "stages.collapse.max_time_factor=6")
    assert t[-1] > 0.9 + 0.09  # lifted after 0.9 s
    assert summary["zeta"]["front_max"] > 0.3


def test_snapshots_are_written_at_the_given_times(tmp_path: Path) -> None:
    times = (0.01, 0.0101, 0.0105, 0.05, 3.0)
    case = mpmcol.load_case("coarse-channel", [*TINY, f"output.times={list(times)}"])
    results = mpmcol.run(case, tmp_path / "run")
    got = [results.snapshot(i).time for i in range(1, len(results.snapshots) - 1)]
    assert np.allclose(got, times[:-1], atol=1.2e-4)  # at the first step that reaches them
    assert any("output.times" in warning for warning in results.summary["warnings"])


def test_a_column_that_moves_at_the_time_limit_is_reported(finished: Path) -> None:
    (warning,) = [text for text in Results(finished).summary["warnings"] if "still moved" in text]
    assert "at the time limit, 1 sqrt(h_i/g)" in warning and "stages.collapse.max_time_factor = 2 allows" in warning


@pytest.mark.parametrize(
    ("limit", "usual", "now", "times"),
    [
        (6.0, 6.0, 0.0, [2.0, 4.0]),
        (10.0, 6.0, 0.0, [2.0, 4.0, 6.0, 8.0]),
        (10.0, 6.0, 4.5, [6.0, 8.0]),
        (1.5, 1.5, 0.0, [0.5, 1.0]),
    ],
)
def test_snapshots_beyond_the_usual_duration_follow_at_the_same_interval(
    limit: float, usual: float, now: float, times: list[float]
) -> None:
    output = SimpleNamespace(times=None, snapshots=3)
    stages: Any = SimpleNamespace(case=SimpleNamespace(output=output), solver=SimpleNamespace(time=now))
    assert list(Stages._snapshot_times(stages, limit, usual)) == pytest.approx(times)


def test_fresh_removes_nothing_if_the_case_is_refused(finished: Path) -> None:
    before = sorted(path.name for path in finished.rglob("*"))
    result = invoke("run", "coarse-channel", *tiny("geometry.domain_length=0.1"), "--out", str(finished), "--fresh")
    assert result.exit_code == 2
    assert sorted(path.name for path in finished.rglob("*")) == before


def test_two_runs_cannot_share_a_folder(tmp_path: Path) -> None:
    with locked(tmp_path / "run"):
        result = invoke("run", "coarse-channel", *tiny(), "--out", str(tmp_path / "run"))
    assert result.exit_code == 5 and "another run is writing here" in result.output


def test_a_failed_run_prints_its_result_as_json(tmp_path: Path) -> None:
    result = invoke("run", "coarse-channel", *tiny("time.cfl=1.9"), "--out", str(tmp_path / "a"), "--json")
    assert result.exit_code == 3
    assert json.loads(result.stdout)["failure"]["remedy"]


def test_an_assigned_initial_stress_saves_steps(tmp_path: Path) -> None:
    by_gravity = mpmcol.run(mpmcol.load_case("coarse-channel", TINY), tmp_path / "gravity")
    assigned = mpmcol.run(mpmcol.load_case("coarse-channel", [*TINY, "stages.initial_stress=k0"]), tmp_path / "k0")
    assert assigned.summary["steps"] < by_gravity.summary["steps"]
    assert assigned.summary["zeta"]["front_height"] == pytest.approx(
        by_gravity.summary["zeta"]["front_height"], rel=0.05
    )


def test_a_two_sided_release_equals_its_half_model(tmp_path: Path) -> None:
    one, two = (
        mpmcol.run(mpmcol.load_case("coarse-channel", [*TINY, f"geometry.release={side}"]), tmp_path / side)
        for side in ("one-sided", "two-sided")
    )
    assert one.summary["zeta"] == two.summary["zeta"]


def test_implausible_units_are_reported(tmp_path: Path) -> None:
    result = invoke("run", "coarse-channel", *tiny("geometry.radius=90"), "--out", str(tmp_path / "a"))
    assert result.exit_code == 2 and "in mm instead of m" in result.output
    checked = invoke("check", "coarse-channel", "--set", "geometry.radius=90")
    assert checked.exit_code == 2 and "in mm instead of m" in checked.output
    soft = invoke("run", "coarse-channel", *tiny("material.youngs_modulus=1e5"), "--out", str(tmp_path / "b"))
    assert "shortening of the column under its own weight, rho g h_i / (2 E_oed), is 1.1%" in soft.output


@pytest.mark.parametrize(
    "overrides", [[], ["geometry.model=full"], ["geometry.section=box", "geometry.depth=0.4"]], ids=str
)
def test_the_estimated_number_of_points_is_an_upper_bound(overrides: list[str]) -> None:
    case = load_case("lube-quarter", ["grid.spacing=0.02", *overrides])
    made, counted = len(build_model(case).points), discretize(case).most_points
    assert made <= counted < 1.25 * made


def test_a_grid_larger_than_the_memory_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    case = load_case("lube-quarter", ["geometry.base=rigid", "geometry.domain_length=2"])
    discretization = discretize(case)
    require_memory_for(discretization)
    assert memory_bytes(discretization) < grid_bytes(discretization)
    monkeypatch.setattr("mpmcol.setup.memory.machine_memory", lambda: grid_bytes(discretization) - 1)
    with pytest.raises(UsageError, match=r"increase grid\.spacing"):
        build_model(case)
