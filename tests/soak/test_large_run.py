"""A signal ends a run of 300 thousand points within two seconds, and a checkpoint is kept."""

from __future__ import annotations

import signal
import time
from pathlib import Path

import pytest

import mpmcol
from mpmcol.io.checkpoint import read_checkpoints
from mpmcol.io.results import Results
from mpmcol.setup.discretization import discretize
from tests.soak.commands import STOPPED, start, stop

TIME_LIMIT = 2.0  # s of CPU time
PATIENCE = 300.0
CASES = {
    "plane": ["lube-channel", "--set", "grid.spacing=0.0007"],
    "quarter": ["lube-quarter", "--set", "grid.spacing=0.0045", "--set", "geometry.aspect=0.9"],
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_signal_ends_a_large_run(name: str, tmp_path: Path) -> None:
    source, *values = CASES[name]
    assert discretize(mpmcol.load_case(source, values[1::2])).most_points > 300_000
    run = start(["run", source, *values, "--out", str(tmp_path), "--checkpoint", "3s"], {"NUMBA_NUM_THREADS": "1"})
    deadline = time.monotonic() + PATIENCE
    while not (tmp_path / "checkpoint-1.npz").exists() and time.monotonic() < deadline:
        time.sleep(0.1)
    messages, seconds = stop(run, signal.SIGTERM)
    assert run.returncode == STOPPED, messages
    assert seconds < TIME_LIMIT, f"{seconds:.2f} s"
    found, damaged = read_checkpoints(tmp_path)
    assert found and not damaged
    assert Results(tmp_path).snapshot(-1).stage == "stopped"
