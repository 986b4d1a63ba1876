"""A sweep on a dask cluster whose workers and runs are killed."""

from __future__ import annotations

import os
import signal
import threading
import time
from pathlib import Path

import pytest

from mpmcol.errors import OutputError, UsageError
from mpmcol.sweep.axes import parse_axes
from mpmcol.sweep.dask_engine import FileStopRequest, dask_pool
from mpmcol.sweep.runner import run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_runs

distributed = pytest.importorskip("distributed")
psutil = pytest.importorskip("psutil")

pytestmark = pytest.mark.filterwarnings("ignore")  # warnings of dask
TINY = ("grid.spacing=0.0194", "stages.collapse.max_time_factor=0.5", "output.snapshots=40")


def make_runs(out: Path) -> list[PlannedRun]:
    return plan_runs("lube-cylinder", parse_axes("2,3,4", TINY)[0], out)


def kill(cluster: distributed.LocalCluster, out: Path, killed: list[int]) -> None:
    """Kill both workers and their runs, once both runs have written a snapshot."""
    while len(list(out.glob("*/run.vtkhdf"))) < 2:
        time.sleep(0.02)
    for worker in [psutil.Process(worker.pid) for worker in cluster.workers.values()]:
        for process in [*worker.children(recursive=True), worker]:
            os.kill(process.pid, signal.SIGKILL)
            killed.append(process.pid)


def test_killed_workers_lose_no_run(tmp_path: Path) -> None:
    runs, killed = make_runs(tmp_path), []
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        killer = threading.Thread(target=kill, args=(cluster, tmp_path, killed))
        killer.start()
        outcomes = run_sweep(runs, tmp_path, scheduler=cluster.scheduler_address)
        killer.join()
    assert len(killed) >= 4
    assert [outcome.status for outcome in outcomes] == ["done"] * 3


def test_a_stop_request_reaches_the_workers(tmp_path: Path) -> None:
    stop = FileStopRequest(tmp_path / "stop")
    assert stop() == 0
    stop.set_level(1)
    assert FileStopRequest(tmp_path / "stop")() == 1
    stop.set_level(2)
    assert stop() == 2
    stop.set_level(0)
    assert stop() == 0 and list(tmp_path.iterdir()) == []


def test_no_scheduler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mpmcol.sweep.dask_engine.CONNECT_SECONDS", 0.5)
    with (
        pytest.raises(OutputError, match="no dask scheduler answers at tcp://127.0.0.1:1"),
        dask_pool("tcp://127.0.0.1:1", tmp_path),
    ):
        pass
    with pytest.raises(UsageError, match="expected an address such as"), dask_pool("nonsense://x", tmp_path):
        pass
