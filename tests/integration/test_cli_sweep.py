"""`mpmcol sweep` and `mpmcol status` with small, short runs: repeated, killed, interrupted."""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from mpmcol.io.lock import is_locked
from mpmcol.io.results import Results
from mpmcol.io.run_status import read_status
from mpmcol.sweep.progress import MOST_PROGRESS
from tests.support.cli import invoke, set_options, started
from tests.support.processes import child_processes, wait_until
from tests.support.sweeps import final_positions, measured_table

pytestmark = pytest.mark.usefixtures("in_empty_folder")
TINY = set_options(("grid.spacing=0.0194", "stages.collapse.max_time_factor=0.5", "output.snapshots=2"))
ENDLESS = set_options(
    (
        *("grid.spacing=0.0194", "stages.collapse.max_time_factor=10000"),
        *("stages.collapse.end=time", "output.snapshots=20000"),
    )
)
SWEEP = ("sweep", "--aspect", "1,2", *TINY)


def status_of(out: Path) -> dict[str, Any]:
    """The record of `mpmcol status --json`."""
    record: dict[str, Any] = json.loads(invoke("status", out, "--json").stdout)
    return record


def modified(folder: Path) -> dict[str, int]:
    return {str(path): path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}


def test_files_of_a_sweep_and_its_repetition() -> None:
    out = Path("sweeps/x")
    first = invoke(*SWEEP, "--out", out, "--jobs", "2")
    assert first.exit_code == 0, first.output
    assert "2 runs: 2 runs at a time, 1 thread per run" in first.stderr
    assert "a1 done" in first.stderr and "a2 done" in first.stderr
    assert first.stdout.splitlines()[1].split()[0] == "a1" and "not at rest" in first.stdout
    assert f"in {out}: table.csv, table.h5, zeta.png, beta.png" in first.stdout
    (one, two) = measured_table(out)
    assert (one["geometry.aspect"], two["a"], one["status"]) == ("1.0", "2.0", "done")
    run = Results(out / one["folder"])
    assert float(one["zeta.front_max"]) == run.summary["zeta"]["front_max"]
    assert one["version.mpmcol"] == run.summary["versions"]["mpmcol"]
    with h5py.File(out / "table.h5") as file:
        assert file["beta"][0] == run.summary["beta"]
    before = modified(out)
    again = invoke(*SWEEP, "--out", out, "--jobs", "2", "--json")
    assert again.exit_code == 0 and modified(out) == before
    assert "2 already finished: nothing to run" in again.stderr
    record = json.loads(again.stdout)
    assert [row["zeta.front_max"] for row in record["runs"]] == [float(row["zeta.front_max"]) for row in (one, two)]
    more = invoke("sweep", "--aspect", "1,2,1.5", *TINY, "--out", out, "--quiet")
    assert (more.exit_code, more.output) == (0, "")
    assert {path: time for path, time in modified(out).items() if path in before and "/a" in path} == {
        path: time for path, time in before.items() if "/a" in path
    }
    state = invoke("status", out)
    assert state.exit_code == 0 and "3 done" in state.stdout and "left" not in state.stdout


def test_runs_that_leave_the_table_are_named() -> None:
    def sweep(aspect: str, *options: str) -> str:
        done = invoke("sweep", "--aspect", aspect, *TINY, "--out", "out", *options)
        assert done.exit_code == 0, done.output
        return done.stderr

    assert "table" not in sweep("1,2", "--report")
    left = next(row["folder"] for row in measured_table(Path("out")) if row["a"] == "2.0")
    assert "table" not in sweep("1,2")
    changed = sweep("1,1.5")
    assert "note: 1 of the 2 runs in out/table.csv is not part of this sweep, which replaces" in changed
    assert f"runs: {left}; use --out" in changed and Path("out", left, "result.json").exists()
    assert "note: out/report.html is older than the table" in changed
    assert "table" not in sweep("1,1.5", "--report") and "table" not in sweep("1,1.5")


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="finds the runs through /proc")
def test_a_killed_sweep_completes_with_equal_results() -> None:
    arguments = ("sweep", "--aspect", "2,3", *TINY[:-1], "output.snapshots=40")
    killed, whole = Path("killed"), Path("whole")
    with started(*arguments, "--jobs", "2", "--out", str(killed)) as sweep:
        wait_until(lambda: list(killed.glob("*/run.vtkhdf")))
        runs = child_processes(sweep.pid)
        os.kill(sweep.pid, signal.SIGKILL)
        for run in runs:
            os.kill(run, signal.SIGKILL)
    wait_until(lambda: not any(map(is_locked, killed.glob("a*"))))
    states = [read_status(path).name for path in killed.glob("a*")]
    assert runs and "unfinished" in states, states
    status = invoke("status", killed)
    assert status.exit_code == 0 and "no run is being executed; repeat the command" in status.stdout
    for out in (killed, whole):
        done = invoke(*arguments, "--jobs", "1", "--out", out)
        assert done.exit_code == 0, done.output
    assert measured_table(killed) == measured_table(whole)
    for mine, other in zip(final_positions(killed), final_positions(whole), strict=True):
        assert np.array_equal(mine, other)


@pytest.mark.parametrize(
    "number", [pytest.param(n, marks=pytest.mark.slow) for n in (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1)]
)
def test_signals_stop_the_runs_of_a_sweep(number: signal.Signals) -> None:
    out = Path("out")
    with started("sweep", "--aspect", "3,4", *ENDLESS, "--jobs", "2", "--out", str(out)) as sweep:
        wait_until(lambda: len(list(out.glob("*/run.vtkhdf"))) == 2)
        wait_until(lambda: all(run["progress"] > 0.0 for run in status_of(out)["runs"]))
        state = status_of(out)
        assert state["counts"] == {"running": 2}
        assert all(0.0 < run["progress"] <= MOST_PROGRESS and run["seconds"] > 0.0 for run in state["runs"])
        (run,) = {path.parent for path in out.glob("a3-*/run.vtkhdf")}
        assert "running" in invoke("status", run).stdout
        sweep.send_signal(number)
        _, err = sweep.communicate(timeout=60)
    assert sweep.returncode == 75 and "Traceback" not in err
    assert "stopping the runs" in err and "repeat the command to complete the runs" in err
    assert [read_status(path).name for path in out.glob("a*")] == ["stopped", "stopped"]
    assert Results(run).snapshot(-1).stage == "stopped"


@pytest.mark.slow
def test_two_sweeps_in_one_folder_at_once() -> None:
    command = (*SWEEP, "--out", "out", "--jobs", "2")
    with started(*command) as first, started(*command) as second:
        outputs = [sweep.communicate(timeout=300) for sweep in (first, second)]
    assert (first.returncode, second.returncode) == (0, 0), outputs
    assert len(measured_table(Path("out"))) == 2


@pytest.mark.slow
def test_a_run_that_diverges_does_not_stop_the_others() -> None:
    arguments = ("sweep", "--aspect", "2", *TINY, "--set", "time.cfl=0.5,1.9", "--out", "out")
    for attempt in range(2):
        done = invoke(*arguments)
        assert done.exit_code == 3, done.output
        assert "cfl1.9-" in done.stdout and " failed: " in done.stdout and "lower time.cfl" in done.stdout
        assert ("2 already finished" in done.stderr) == (attempt == 1)
    quiet = invoke(*arguments, "--quiet")
    assert (quiet.exit_code, quiet.stdout) == (3, "") and " failed: " in quiet.stderr
    good, bad = measured_table(Path("out"))
    assert (good["status"], bad["status"], bad["zeta.front_max"]) == ("done", "failed", "")
    assert "1 done, 1 failed" in invoke("status", "out").stdout


@pytest.mark.slow
def test_commands_have_copies_of_their_cases_and_run_in_a_shell() -> None:
    Path("mine.toml").write_text('extends = "lube-cylinder"\n')
    arguments = ("sweep", "mine.toml", "--aspect", "1,2", *TINY, "--out", "out")
    printed = invoke(*arguments, "--engine", "commands", "--threads", "1")
    assert printed.exit_code == 0, printed.output
    lines = printed.stdout.splitlines()
    assert Path("out/commands.sh").read_text().splitlines() == lines
    slurm = Path("out/slurm.sh").read_text()
    assert "#SBATCH --array=1-2\n" in slurm and "#SBATCH --cpus-per-task=1\n" in slurm
    Path("mine.toml").write_text("changed = true\n")
    done = subprocess.run(["bash", "-c", slurm], env={**os.environ, "SLURM_ARRAY_TASK_ID": "2"}, capture_output=True)
    assert done.returncode == 0, done.stderr
    assert subprocess.run(shlex.split(lines[0]), capture_output=True).returncode == 0
    Path("mine.toml").write_text('extends = "lube-cylinder"\n')
    done = invoke(*arguments)
    assert done.exit_code == 0 and "2 already finished" in done.stderr
    assert "all runs are finished" in invoke(*arguments, "--engine", "commands").stderr


def test_a_dry_run_writes_nothing() -> None:
    done = invoke(*SWEEP, "--dry-run", "--out", "out")
    assert done.exit_code == 0, done.output
    assert "a1 " in done.stdout and "at a time, 1 thread per run" in done.stdout and "nothing was run" in done.stdout
    record = json.loads(invoke(*SWEEP, "--dry-run", "--json").stdout)
    assert record["threads"] == 1 and [run["points"] for run in record["runs"]] == [188, 304]
    assert list(Path().iterdir()) == []


def test_json_of_infinite_values_is_valid() -> None:
    done = invoke("sweep", "--aspect", "1", *TINY, "--set", "stages.gate_speed=inf,2", "--dry-run", "--json")
    record = json.loads(done.stdout, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert [run["inputs"]["stages.gate_speed"] for run in record["runs"]] == ["inf", 2.0]


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("sweep",), 2, "no key to vary"),
        (("sweep", "--aspect", "7:1"), 2, "--aspect 7:1: 7:1: the end of a range must be greater than its start"),
        (("sweep", "--aspect", "1", "--engine", "dask"), 2, "--engine dask requires --scheduler ADDRESS"),
        (
            ("sweep", "--aspect", "1", "--scheduler", "tcp://x:1"),
            2,
            "--engine dask requires --scheduler ADDRESS",
        ),
        (("sweep", "--aspect", "1", "--engine", "commands", "--jobs", "2"), 2, "--jobs requires --engine local"),
        (("sweep", "--aspect", "1", "--engine", "commands", "--json"), 2, "--engine commands runs nothing"),
        (("sweep", "quikstart", "--aspect", "1"), 2, 'did you mean the shipped case "quickstart"?'),
        (("sweep", "--aspect", "1", "--out", "full"), 2, "full: the folder is not empty and contains no sweep"),
        (("status", "full"), 5, "full: expected the folder of a sweep (with sweep.json) or of a run"),
    ],
)
def test_invalid_commands_are_refused(arguments: tuple[str, ...], code: int, message: str) -> None:
    Path("full").mkdir()
    Path("full/other").touch()
    result = invoke(*arguments)
    assert (result.exit_code, result.stdout) == (code, "") and message in result.stderr
    assert {path.name for path in Path().iterdir()} == {"full"}
