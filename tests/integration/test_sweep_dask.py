"""A sweep on a real dask cluster whose workers are killed in the middle, with the runs that they had in hand."""

from __future__ import annotations

import os
import signal
import threading
import time
from pathlib import Path

import pytest

from mpmcol.errors import OutputError, UsageError
from mpmcol.sweep.axes import parse_axes
from mpmcol.sweep.dask_engine import FileHalt, dask_pool
from mpmcol.sweep.runner import run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_runs

distributed = pytest.importorskip("distributed")
psutil = pytest.importorskip("psutil")

pytestmark = pytest.mark.filterwarnings("ignore")  # theirs are not ours to mend
TINY = ("grid.spacing=0.0194", "stages.collapse.max_time_factor=0.5", "output.snapshots=40")


def make_runs(out: Path) -> list[PlannedRun]:
    return plan_runs("lube-cylinder", parse_axes("2,3,4", TINY)[0], out)


def kill(cluster: distributed.LocalCluster, out: Path, killed: list[int]) -> None:
    """Kill both workers and their runs, once both have something to show."""
    while len(list(out.glob("*/run.vtkhdf"))) < 2:
        time.sleep(0.02)
    for worker in [psutil.Process(worker.pid) for worker in cluster.workers.values()]:
        for process in [*worker.children(recursive=True), worker]:
            os.kill(process.pid, signal.SIGKILL)
            killed.append(process.pid)


def test_workers_that_are_killed_lose_no_point(tmp_path: Path) -> None:
    points, killed = make_runs(tmp_path), []
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        killer = threading.Thread(target=kill, args=(cluster, tmp_path, killed))
        killer.start()
        outcomes = run_sweep(points, tmp_path, scheduler=cluster.scheduler_address)
        killer.join()
    assert len(killed) >= 4
    assert [outcome.status for outcome in outcomes] == ["done"] * 3


def test_halting_reaches_the_workers(tmp_path: Path) -> None:
    halt = FileHalt(tmp_path / "halt")
    assert halt() == 0
    halt.stop(1)
    assert FileHalt(tmp_path / "halt")() == 1
    halt.stop(2)
    assert halt() == 2
    halt.stop(0)
    assert halt() == 0 and list(tmp_path.iterdir()) == []


def test_no_scheduler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mpmcol.sweep.dask_engine.CONNECT_SECONDS", 0.5)
    with (
        pytest.raises(OutputError, match="no dask scheduler answers at tcp://127.0.0.1:1"),
        dask_pool("tcp://127.0.0.1:1", tmp_path),
    ):
        pass
    with pytest.raises(UsageError, match="expected an address such as"), dask_pool("nonsense://x", tmp_path):
        pass
