"""A run that is stopped and resumed ends with the same bits as an uninterrupted one."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import mpmcol
from mpmcol.errors import Interrupted, UsageError
from mpmcol.io.names import CHECKPOINT_FILES
from mpmcol.io.results import Results
from mpmcol.mpm import solver
from mpmcol.simulation import run
from mpmcol.simulation.interrupt import StopRequest
from tests.support.cli import invoke
from tests.support.runs import SMALL_CASES, assert_equal_runs, small_case

QUICK = (
    "plane", "softening", "slope", "vertical sides", "outline", "granular bed", "layers", "quarter", "friction",
    "walls",
)  # fmt: skip


@pytest.fixture
def stop_after(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Sets after how many calls of the compiled loop, of a few steps each, further runs are asked to stop."""
    monkeypatch.setattr(solver, "CALL_SECONDS", 0.003)
    left = [0]

    class Counted(StopRequest):
        @property
        def reason(self) -> str:
            left[0] -= 1
            return "the test" if left[0] < 0 else ""

    @contextmanager
    def counted(max_wall: float) -> Iterator[StopRequest]:
        yield Counted(max_wall)

    monkeypatch.setattr(run, "stop_request", counted)

    def set_left(calls: int) -> None:
        left[0] = calls

    return set_left


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in SMALL_CASES]
)
def test_a_run_stopped_repeatedly_ends_with_equal_bits(name: str, stop_after: Any, tmp_path: Path) -> None:
    case, whole, cut = small_case(name), tmp_path / "whole", tmp_path / "cut"
    stop_after(10**9)
    mpmcol.run(case, whole, threads=1)
    stops, calls = 0, 2
    while True:
        stop_after(calls)
        try:
            mpmcol.run(case, cut, threads=1 + stops % 2)
            break
        except Interrupted:
            stops, calls = stops + 1, calls + 5
            assert Results(cut).status == "stopped" and Results(cut).snapshot(-1).stage == "stopped"
    assert stops >= 3
    assert_equal_runs(whole, cut)
    steps = [entry["step"] for entry in Results(cut).summary["resumed"]]
    assert len(steps) == stops and steps == sorted(set(steps))
    assert not any((cut / file).exists() for file in CHECKPOINT_FILES)


def test_a_killed_run_resumes_from_the_last_valid_checkpoint(stop_after: Any, tmp_path: Path) -> None:
    """Output after the checkpoint is written again; if the newest checkpoint is damaged, the previous one is used."""
    case, whole, cut = small_case("plane"), tmp_path / "whole", tmp_path / "cut"
    stop_after(10**9)
    mpmcol.run(case, whole)
    steps = 0

    def kill(stage: str, share: float) -> None:
        nonlocal steps
        steps += stage == "collapse"
        if steps == 15:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        mpmcol.run(case, cut, checkpoint_seconds=0.0, progress=kill)
    newest = max((cut / file for file in CHECKPOINT_FILES), key=lambda path: path.stat().st_mtime_ns)
    newest.write_bytes(newest.read_bytes()[:-5])
    messages: list[str] = []
    mpmcol.run(case, cut, notify=messages.append)
    assert f"note: {newest} is damaged; resuming from the previous one" in messages
    assert any(line.startswith("resuming from step ") for line in messages)
    assert_equal_runs(whole, cut)


def test_another_case_or_code_is_refused_with_the_difference(
    stop_after: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stop_after(3)
    with pytest.raises(Interrupted, match=r"stopped by the test at step \d+, t = .*repeat the command to resume"):
        mpmcol.run(small_case("plane"), tmp_path)
    stop_after(10**9)
    other = small_case("plane", "stages.collapse.damping=0.1", 'title="another"')
    with pytest.raises(
        UsageError, match=r"damping: 0.05 in the checkpoint, 0.1 in this case\n(.*)--fresh(.*)--out(.*)--force-resume"
    ):
        mpmcol.run(other, tmp_path)
    with pytest.raises(UsageError, match="another number of material points than this case"):
        mpmcol.run(small_case("plane", "grid.points_per_cell=9"), tmp_path, force_resume=True)
    for module in ("checkpointer", "restart"):
        monkeypatch.setattr(f"mpmcol.simulation.{module}.code_version", lambda: "0+other")
    with pytest.raises(UsageError, match=r"made by mpmcol .*, this is 0\+other"):
        mpmcol.run(small_case("plane"), tmp_path)
    done = mpmcol.run(other, tmp_path, force_resume=True).summary
    assert done["status"] == "done" and done["resumed"][0]["version"] == "0+other"


def test_without_a_valid_checkpoint_a_run_restarts_from_scratch(stop_after: Any, tmp_path: Path) -> None:
    stop_after(3)
    with pytest.raises(Interrupted):
        mpmcol.run(small_case("plane"), tmp_path)
    for file in CHECKPOINT_FILES:
        (tmp_path / file).write_bytes(b"")
    stop_after(10**9)
    assert mpmcol.run(small_case("plane"), tmp_path).summary["resumed"] == []


def test_the_wall_clock_limit_and_the_exit_codes(tmp_path: Path) -> None:
    command = ("run", "coarse-channel", "--set", "grid.spacing=0.01", "--out", tmp_path / "run")
    first = invoke(*command, "--max-wall", "0.001s", "--quiet")
    assert first.exit_code == 75 and "stopped by the wall-clock limit at step" in first.stderr
    assert invoke(*command, "--max-wall", "0.001s", "--requeue-code", "99").exit_code == 99
    done = invoke(*command, "--json")
    assert done.exit_code == 0 and len(json.loads(done.stdout)["resumed"]) == 2


@pytest.mark.parametrize("text", ["5 years", "-1s", "0", "nan", ""])
def test_a_time_is_a_number_with_a_unit(text: str) -> None:
    done = invoke("run", "coarse-channel", "--max-wall", text)
    assert done.exit_code == 2 and "expected a time > 0, for example 90s, 5min, 2h, 1.5d or 01:30:00" in done.output
