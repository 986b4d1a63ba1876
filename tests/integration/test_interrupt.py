"""Ctrl-C during a run stops it promptly with a snapshot of its state; a full disk at stdout is reported."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from mpmcol.io.results import Results
from tests.support.cli import started
from tests.support.processes import wait_until


def test_an_interrupt_saves_the_state(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    with started("run", "lube-channel", "--out", folder, "--threads", "1") as run:
        wait_until(lambda: (folder / "case.resolved.toml").exists())
        time.sleep(2.0)
        run.send_signal(signal.SIGINT)
        sent = time.monotonic()
        _, err = run.communicate(timeout=60)
    assert run.returncode == 75, err
    assert time.monotonic() - sent < 20.0
    assert "stopped by SIGINT at step" in err and "Traceback" not in err
    results = Results(folder)
    assert results.summary["status"] == "stopped"
    assert results.snapshot(-1).stage == "stopped"


def test_a_full_disk_at_the_standard_output_is_reported(tmp_path: Path) -> None:
    command = [sys.executable, "-u", "-m", "mpmcol", "check", "quickstart"]
    with Path("/dev/full").open("w") as full:
        environment = {**os.environ, "PYTHONPATH": str(Path.cwd())}
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, cwd=tmp_path, env=environment)
    assert done.returncode == 5 and "stdout cannot be written: No space left" in done.stderr
    assert not list(tmp_path.iterdir())
