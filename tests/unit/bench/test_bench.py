"""The benchmark: plain loops agree with the kernels; the command prints and compares reports."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mpmcol.bench.cases import MODELS, make_solver
from mpmcol.bench.clock import seconds
from mpmcol.bench.machine import Machine
from mpmcol.bench.measure import QUICK, bytes_per_point, measure_case, plain_steps, transfer_seconds, vector_steps
from mpmcol.bench.plain_loops.common import plain_points, plain_state
from mpmcol.bench.report import BenchmarkCase, Report, Spread, compare, load_report, make_report
from mpmcol.errors import UsageError
from mpmcol.mpm.jit import driver
from tests.support.cli import invoke

compiles_plain_loops = pytest.mark.slow  # for 45 s of a core
PHASES = ("update_grid", "update_points", "p2g", "g2p", "stress", "step", "sort")


@pytest.fixture(scope="module")
def case() -> BenchmarkCase:
    return measure_case("plane", 2000, 2, 1, QUICK)


def slower(report: Report, phase: str, factor: float) -> Report:
    """The report with the times of one phase multiplied by `factor`."""

    def scaled(spread: Spread) -> Spread:
        return Spread(factor * spread.median, factor * spread.min, factor * spread.max)

    cases = [
        replace(c, rows=tuple(replace(r, vector=scaled(r.vector)) if r.phase == phase else r for r in c.rows))
        for c in report.cases
    ]
    return replace(report, cases=tuple(cases))


@compiles_plain_loops
@pytest.mark.parametrize("model", MODELS)
def test_plain_loops_agree_with_the_kernels(model: str) -> None:
    solver = make_solver(model, 2000)
    solver.advance(1.0, max_steps=30)
    solver.sort()
    state = plain_state(solver)
    vector_steps(solver, 20)
    plain_steps(solver, state, 20)
    expected = plain_points(solver.points)
    assert (expected.opening > 0.0).any() and (expected.opening == 0.0).any()
    for name in expected._fields:
        got, reference = getattr(state.points, name), getattr(expected, name)
        np.testing.assert_allclose(got, reference, rtol=0.0, atol=1e-11 * np.abs(reference).max(), err_msg=name)
    assert state.clock[1] == pytest.approx(solver.dt, rel=1e-13)


def test_timed_steps_equal_the_steps_of_the_solver() -> None:
    timed, usual = make_solver("plane", 2000), make_solver("plane", 2000)
    timed.sort()
    vector_steps(timed, 10)
    while usual.steps < 10:
        assert usual.advance(1.0, max_steps=10 - usual.steps) == -1
    np.testing.assert_array_equal(timed.points.rows, usual.points.rows)


def test_transfers_alone_leave_the_solver_unchanged() -> None:
    solver = make_solver("plane", 2000)
    solver.sort()
    before = solver.points.rows.copy()
    assert min(transfer_seconds(solver, 2)) > 0.0
    np.testing.assert_array_equal(solver.points.rows, before)


def test_the_case_has_the_requested_number_of_points() -> None:
    for points in (2000, 30_000):
        solver = make_solver("plane", points)
        assert len(solver.points) == pytest.approx(points, rel=0.1)
    assert 200.0 < bytes_per_point(make_solver("plane", 100_000)) < 250.0
    assert 270.0 < bytes_per_point(make_solver("quarter", 100_000)) < 400.0


def test_the_compiled_clock_is_the_monotonic_clock() -> None:
    compiled = driver(lambda: seconds())
    before = seconds()
    assert before <= compiled() <= seconds()


@compiles_plain_loops
def test_every_phase_is_reported(case: BenchmarkCase) -> None:
    assert tuple(row.phase for row in case.rows) == PHASES
    for row in case.rows:
        assert 0.0 < row.vector.min <= row.vector.median <= row.vector.max or row.phase == "stress"
        assert (row.plain is None) == (row.phase == "sort")


def test_the_bound_is_the_larger_of_traffic_and_arithmetic() -> None:
    slow_memory, slow_arithmetic = Machine(bandwidth=1.0, vector_rate=1e9), Machine(bandwidth=1e9, vector_rate=1.0)
    assert slow_memory.bounds(2, 0.0)["step"] == pytest.approx(2 * 24 * 8)
    assert slow_memory.bounds(3, 1.0)["step"] - slow_memory.bounds(3, 0.0)["step"] == pytest.approx(6 * 64)
    for dimension in (2, 3):
        bounds = slow_arithmetic.bounds(dimension, 0.5)
        phases = [bounds[phase] for phase in ("update_grid", "p2g", "g2p", "stress")]
        assert min(phases) > 0.0 and bounds["step"] == pytest.approx(sum(phases))


def test_the_case_has_the_requested_number_of_points_per_cell() -> None:
    for model, per_axis in (("plane", 4), ("quarter", 3)):
        solver = make_solver(model, 20_000, per_axis)
        column = solver.points.x[: len(solver.points) // 4]
        cells, counts = np.unique(np.floor(column / solver.grid.h), axis=0, return_counts=True)
        assert len(cells) > 50 and np.median(counts) == per_axis ** column.shape[1]


@compiles_plain_loops
def test_a_report_is_read_back_from_json(case: BenchmarkCase, tmp_path: Path) -> None:
    report = make_report([case])
    (tmp_path / "report.json").write_text(report.to_json())
    assert load_report(tmp_path / "report.json") == report
    assert {"cpu", "llvm_cpu", "cores", "numba", "llvm", "numpy", "python"} <= report.machine.keys()


@pytest.mark.parametrize("text", ["", "{}", '{"schema": 99}', "[1]"])
def test_other_files_are_rejected(text: str, tmp_path: Path) -> None:
    (tmp_path / "other.json").write_text(text)
    with pytest.raises(UsageError, match="mpmcol bench --out"):
        load_report(tmp_path / "other.json")


@compiles_plain_loops
def test_only_slowdowns_beyond_the_noise_are_reported(case: BenchmarkCase) -> None:
    report = make_report([case])
    assert compare(report, report) == []
    assert compare(report, slower(report, "p2g", 1.4)) == []
    found = compare(slower(report, "p2g", 1e-3), report)
    assert [slowdown.phase for slowdown in found] == ["p2g"]
    assert found[0].ratio == pytest.approx(1e3) and "plain loops: 1.00" in str(found[0])


@compiles_plain_loops
def test_the_command_prints_writes_and_compares(tmp_path: Path) -> None:
    arguments = ["--quick", "--model", "plane", "--points", "1000", "--threads", "1"]
    first = invoke("bench", *arguments, "--out", tmp_path / "new", "--json")
    assert first.exit_code == 0, first.output
    for phase in (*PHASES, "memory", "machine", "Python"):
        assert f"\n{phase} " in first.stderr
    assert json.loads(first.stdout)["schema"] == 4
    written = load_report(tmp_path / "new" / "bench.json")
    (tmp_path / "fast.json").write_text(slower(written, "p2g", 1e-3).to_json())
    (tmp_path / "slow.json").write_text(replace(slower(written, "p2g", 1e3), cases=()).to_json())
    slowed = invoke("bench", *arguments, "--against", tmp_path / "fast.json")
    assert slowed.exit_code == 1 and "p2g" in slowed.output
    unchanged = invoke("bench", *arguments, "--against", tmp_path / "slow.json")
    assert unchanged.exit_code == 0 and "No kernel is" in unchanged.output
    assert json.loads((tmp_path / "new" / "bench.json").read_text())["schema"] == 4


@pytest.mark.parametrize("arguments", [["--points", "0"], ["--points", "8k"], ["--threads", "1,,2"]])
def test_wrong_counts_are_rejected(arguments: list[str]) -> None:
    result = invoke("bench", *arguments)
    assert result.exit_code == 2 and "expected integers > 0" in result.output
