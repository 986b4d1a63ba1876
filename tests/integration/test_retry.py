"""`--on-instability retry`: return to a valid state with half the time step; equal bits after interruptions."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mpmcol
from mpmcol.errors import NumericalFailure
from mpmcol.io.results import Results
from mpmcol.mpm.lanes import VX
from mpmcol.simulation import run, stages
from mpmcol.simulation.stages import Stages
from tests.support.cli import invoke, set_options

TINY = ("grid.spacing=0.015", "output.snapshots=8", "stages.collapse.max_time_factor=1.0")
HARSH = (*TINY, "time.cfl=1.0")  # fails during the loading


def case_of(*overrides: str) -> mpmcol.Case:
    return mpmcol.load_case("coarse-channel", overrides)


def fail_above(cfl: float, monkeypatch: pytest.MonkeyPatch, lane: int = VX, value: float = np.nan) -> None:
    """Make a point invalid from the 13th check of the collapse on, if the time step is larger than that of `cfl`."""
    check_collapse = Stages._check_collapse

    def spoil(stages: Stages, lifting_time: float) -> None:
        check_collapse(stages, lifting_time)
        if stages.simulation.progress.checks >= 13 and stages.solver.settings.cfl > cfl:
            stages.solver.points.rows[50, lane] = value

    monkeypatch.setattr(Stages, "_check_collapse", spoil)


def test_a_run_that_fails_by_default_completes_with_half_the_time_step(tmp_path: Path) -> None:
    command = ("run", "coarse-channel", *set_options(HARSH), "--out", tmp_path / "a")
    stopped = invoke(*command)
    assert stopped.exit_code == 3 and "energy gain" in stopped.stderr
    done = invoke(*command, "--on-instability", "retry")
    assert done.exit_code == 0 and "with time.cfl = 0.5 (retry 1 of at most 4)" in done.stderr
    (retry,) = Results(tmp_path / "a").summary["retries"]
    assert retry["cfl"] == 1.0 and retry["new_cfl"] == 0.5 and retry["check"] == "energy"
    assert retry["stage"] == "equilibrate" and retry["from_step"] < retry["step"] and retry["from_time"] < retry["time"]


def test_a_retry_from_the_start_equals_the_run_with_half_the_time_step(tmp_path: Path) -> None:
    retried = mpmcol.run(case_of(*HARSH), tmp_path / "a", threads=1, on_instability="retry")
    plain = mpmcol.run(case_of(*TINY), tmp_path / "b", threads=1)
    assert retried.summary["retries"][0]["from_step"] == 0
    assert (tmp_path / "a/history.csv").read_bytes() == (tmp_path / "b/history.csv").read_bytes()
    assert np.array_equal(retried.snapshot(-1).x, plain.snapshot(-1).x)


def test_a_run_without_failure_has_the_same_bits(tmp_path: Path) -> None:
    asked = mpmcol.run(case_of(*TINY), tmp_path / "a", threads=1, on_instability="retry")
    plain = mpmcol.run(case_of(*TINY), tmp_path / "b", threads=1)
    assert (tmp_path / "a/history.csv").read_bytes() == (tmp_path / "b/history.csv").read_bytes()
    assert asked.summary["retries"] == plain.summary["retries"] == []


def test_a_retry_starts_some_checks_before_the_failure_and_discards_later_output(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fail_above(0.2, monkeypatch)
    results = mpmcol.run(case_of(*TINY), tmp_path / "a", threads=1, on_instability="retry")
    first, second = results.summary["retries"]
    assert (first["cfl"], second["cfl"], second["new_cfl"]) == (0.5, 0.25, 0.125)
    checks = (first["time"] - first["from_time"]) / np.sqrt(0.09 / 9.81) * stages.CHECKS_PER_FALL_TIME
    assert stages.CHECKS_PER_STATE <= checks <= 2 * stages.CHECKS_PER_STATE
    history = results.history
    flow = history["stage"] == "collapse"
    assert np.all(np.diff(history["time"][flow]) > 0.0) and np.all(np.diff(history["step"]) >= 0)
    assert history["dt"][-1] == pytest.approx(0.25 * history["dt"][0], rel=0.1)
    times = [results.snapshot(k).time for k in range(len(results.snapshots))]
    assert len(times) == 9 and times == sorted(set(times))


def test_there_are_four_retries_at_most(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fail_above(0.0, monkeypatch)
    with pytest.raises(NumericalFailure, match="not finite") as stopped:
        mpmcol.run(case_of(*TINY), tmp_path / "a", threads=1, on_instability="retry")
    text, summary = str(stopped.value), Results(tmp_path / "a").summary
    assert [retry["cfl"] for retry in summary["retries"]] == [0.5, 0.25, 0.125, 0.0625]
    assert all(f"tried with time.cfl = {cfl}: " in text for cfl in (0.5, 0.25, 0.125, 0.0625))
    assert summary["status"] == "failed" and summary["failure"]["check"] == "finite"
    stage_names = [Results(tmp_path / "a").snapshot(k).stage for k in range(len(Results(tmp_path / "a").snapshots))]
    assert stage_names[-1] == "failed" and "failed" not in stage_names[:-1]


def test_a_failure_that_no_time_step_prevents_is_not_retried(tmp_path: Path) -> None:
    case = case_of(*TINY, "geometry.domain_length=0.165", "stages.collapse.max_time_factor=4")
    with pytest.raises(NumericalFailure, match="end of the domain"):
        mpmcol.run(case, tmp_path / "a", on_instability="retry")
    assert Results(tmp_path / "a").summary["retries"] == []


@pytest.mark.parametrize("calls", [3, 12, 16, 22])
def test_a_killed_run_with_retries_ends_with_equal_bits(
    calls: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Killed before the failure, immediately before it, after the first retry, and after the second."""
    fail_above(0.2, monkeypatch)
    whole = mpmcol.run(case_of(*TINY), tmp_path / "whole", threads=1, on_instability="retry")
    count = 0

    def kill(stage: str, share: float) -> None:
        nonlocal count
        count += stage == "collapse"
        if count == calls:
            raise ZeroDivisionError

    options: dict[str, Any] = {"threads": 1, "on_instability": "retry", "checkpoint_seconds": 0.0}
    with pytest.raises(ZeroDivisionError):
        mpmcol.run(case_of(*TINY), tmp_path / "cut", progress=kill, **options)
    cut = mpmcol.run(case_of(*TINY), tmp_path / "cut", **options)
    assert len(cut.summary["resumed"]) == 1
    assert (tmp_path / "whole/history.csv").read_bytes() == (tmp_path / "cut/history.csv").read_bytes()
    assert json.dumps(whole.summary["retries"]) == json.dumps(cut.summary["retries"])
    assert [path.name for path in whole.snapshots] == [path.name for path in cut.snapshots]
    for k in range(len(whole.snapshots)):
        for name, array in whole.snapshot(k).arrays.items():
            assert np.array_equal(array, cut.snapshot(k).arrays[name]), (k, name)


def test_other_values_are_refused(tmp_path: Path) -> None:
    with pytest.raises(mpmcol.errors.UsageError, match='on_instability = "again": expected "stop" or "retry"'):
        run.run(case_of(*TINY), tmp_path / "a", on_instability="again")  # type: ignore[arg-type]
