"""Signals and readers that go away leave a complete state of a run; a full disk at stdout is reported."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import mpmcol
from mpmcol.errors import Interrupted
from mpmcol.io.results import Results
from mpmcol.simulation.interrupt import SIGNALS
from tests.support.cli import set_options, started
from tests.support.processes import handled_by, wait_until
from tests.support.runs import TINY, assert_equal_runs


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


@pytest.mark.parametrize("number", SIGNALS, ids=lambda number: number.name)
def test_every_signal_saves_the_state(number: signal.Signals, finished: Path, tmp_path: Path) -> None:
    def send(stage: str, fraction: float) -> None:
        if stage == "collapse" and fraction > 0.1:
            signal.raise_signal(number)

    case = mpmcol.load_case("coarse-channel", TINY)
    message = f"stopped by {number.name} at step .*repeat the command to resume"
    handler = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
    with handled_by(handler, number), pytest.raises(Interrupted, match=message) as caught:
        mpmcol.run(case, tmp_path / "run", progress=send)
    assert caught.value.exit_code == 75
    assert_equal_runs(finished, mpmcol.run(case, tmp_path / "run").folder)


def without_reader(command: list[str], folder: Path, lines: int, **streams: int) -> tuple[int, str]:
    """Exit code and stderr of `mpmcol` if the reader of its stdout ends after some lines."""
    environment = {**os.environ, "PYTHONPATH": str(Path(mpmcol.__file__).parents[1])}
    with (
        (folder / "stderr").open("w") as err,
        subprocess.Popen(
            [sys.executable, "-m", "mpmcol", *command], cwd=folder, env=environment, stdout=subprocess.PIPE,
            **{"stderr": err.fileno(), **streams},
        ) as process,
    ):  # fmt: skip
        assert process.stdout is not None
        for _ in range(lines):
            process.stdout.readline()
        process.stdout.close()
        return process.wait(120), (folder / "stderr").read_text()


@pytest.mark.parametrize(
    ("lines", "streams"), [(0, {}), (1, {"stderr": subprocess.STDOUT})], ids=["result", "messages and result"]
)
def test_a_run_whose_reader_goes_away_is_completed(
    lines: int, streams: dict[str, int], finished: Path, tmp_path: Path
) -> None:
    command = ["run", "coarse-channel", *set_options(TINY), "--out", "run"]
    code, err = without_reader(command, tmp_path, lines, **streams)
    assert (code, err.count("Error"), err.count("Traceback")) == (141, 0, 0), err
    assert_equal_runs(finished, tmp_path / "run")


def test_a_command_whose_reader_goes_away_ends_quietly(tmp_path: Path) -> None:
    assert without_reader(["cases"], tmp_path, 1) == (141, "")


@pytest.mark.parametrize("options", [["-u"], []], ids=["unbuffered", "buffered"])
def test_a_full_disk_at_the_standard_output_is_reported(options: list[str], tmp_path: Path) -> None:
    command = [sys.executable, *options, "-m", "mpmcol", "check", "coarse-channel"]
    with Path("/dev/full").open("w") as full:
        environment = {**os.environ, "PYTHONPATH": str(Path.cwd())}
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, cwd=tmp_path, env=environment)
    assert done.returncode == 5 and "stdout cannot be written: No space left" in done.stderr
    assert not list(tmp_path.iterdir())
