"""Runs in forked processes and in several threads of one process work with equal bits, or are refused in words."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import mpmcol
from mpmcol.cli.sweep_display import SweepDisplay
from mpmcol.errors import Interrupted, OutputError
from mpmcol.io.lock import is_locked
from mpmcol.simulation.interrupt import REPEATED, stop_request
from tests.support.processes import handled_by, wait_until
from tests.support.runs import TINY, assert_equal_runs

pytestmark = pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning")
needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")

PROGRAM = f"""
import multiprocessing, sys, time
import mpmcol

def run(folder):
    return mpmcol.run(mpmcol.load_case("coarse-channel", {TINY}), folder, threads=1).summary["state_sha256"]

def in_pool(folder):
    with multiprocessing.get_context("fork").Pool(1) as pool:
        return pool.apply_async(run, (folder,)).get(200.0)
"""
FORK_BEFORE_AND_AFTER = """
assert in_pool("a") == run("b")  # the fork precedes the first run of this process
started = time.monotonic()
try:
    in_pool("c")
except mpmcol.errors.UsageError as refusal:
    print(f"{time.monotonic() - started:.3f}", refusal)
"""
# The pool ends its processes by SIGTERM while one of them computes.
TERMINATED_POOL = """
from pathlib import Path

with multiprocessing.get_context("fork").Pool(1) as pool:
    pool.apply_async(run, ("a",))
    while not Path("a/case.resolved.toml").exists():
        time.sleep(0.01)
print("ended")
"""
TWO_THREADS = """
from concurrent.futures import ThreadPoolExecutor

with ThreadPoolExecutor(2) as threads:
    print(len(set(threads.map(run, ("a", "b")))))
"""


def executed(program: str, folder: Path, **variables: str) -> str:
    environment = {**os.environ, "PYTHONPATH": str(Path(mpmcol.__file__).parents[1]), **variables}
    command = [sys.executable, "-c", PROGRAM + program]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    return done.stdout


@needs_fork
def test_a_pool_forked_before_the_first_run_works_and_one_forked_after_it_is_refused_at_once(tmp_path: Path) -> None:
    seconds, _, message = executed(FORK_BEFORE_AND_AFTER, tmp_path).partition(" ")
    assert "this process was forked from one that had already computed" in message
    assert 'multiprocessing.get_context("spawn") or "forkserver"' in message
    assert float(seconds) < 10.0  # without load a few hundredths; it once waited for ever
    assert not (tmp_path / "c").exists()


@needs_fork
def test_a_pool_can_end_its_runs(tmp_path: Path) -> None:
    assert executed(TERMINATED_POOL, tmp_path) == "ended\n"
    assert not is_locked(tmp_path / "a")


@needs_fork
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGUSR2])
def test_a_child_forked_during_a_run_ends_by_the_signals_of_its_parent(number: signal.Signals) -> None:
    with handled_by(signal.SIG_DFL, number), stop_request():
        child = os.fork()
        if not child:
            signal.raise_signal(number)
            os._exit(0)  # the signal was ignored
        _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == -number


def test_a_handler_of_the_caller_is_called_after_the_run_and_stays() -> None:
    received: list[int] = []

    def handler(number: int, frame: object) -> None:
        received.append(number)

    with handled_by(handler, signal.SIGTERM):
        with stop_request() as request:
            signal.raise_signal(signal.SIGTERM)
            assert request.reason == "SIGTERM" and received == []
        assert received == [signal.SIGTERM] and signal.getsignal(signal.SIGTERM) is handler


def test_signals_that_are_sent_repeatedly_stop_a_run_once_and_others_abort_it() -> None:
    with handled_by(signal.SIG_DFL, *REPEATED), stop_request() as request:
        signal.raise_signal(signal.SIGHUP)
        signal.raise_signal(signal.SIGHUP)
        signal.raise_signal(signal.SIGXCPU)
        assert request.reason == "SIGHUP"
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)


@pytest.mark.parametrize("ignored", [signal.SIGHUP, signal.SIGTERM])
def test_a_signal_that_the_caller_ignores_stays_ignored(ignored: signal.Signals) -> None:
    with handled_by(signal.SIG_IGN, ignored):
        with stop_request() as request:
            signal.raise_signal(ignored)
            assert request.reason == ""
        assert signal.getsignal(ignored) is signal.SIG_IGN


def test_a_closed_terminal_stops_the_runs_of_a_sweep_and_does_not_abort_them(tmp_path: Path) -> None:
    with handled_by(signal.SIG_DFL, *REPEATED):
        with pytest.raises(Interrupted, match="stopped with checkpoints"), SweepDisplay(tmp_path, quiet=True):
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGHUP)
            signal.raise_signal(signal.SIGHUP)  # while the runs write their checkpoints
            raise KeyboardInterrupt
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_DFL


# ------------------------------------------------------------------------------------ threads of one process


def test_two_threads_run_two_cases_with_the_bits_of_single_runs(tmp_path: Path) -> None:
    cases = {a: mpmcol.load_case("coarse-channel", [*TINY, f"geometry.aspect={a}"]) for a in ("1.0", "1.5")}
    together = threading.Barrier(2, timeout=60.0)

    def run(name: str) -> None:
        together.wait()
        mpmcol.run(cases[name], tmp_path / "together" / name, threads=1)

    for name, case in cases.items():
        mpmcol.run(case, tmp_path / name, threads=1)
    with ThreadPoolExecutor(2) as threads:
        list(threads.map(run, cases))
    for name in cases:
        assert_equal_runs(tmp_path / name, tmp_path / "together" / name)
        mine, other = (folder / name / "snapshots/000001.vtkhdf" for folder in (tmp_path, tmp_path / "together"))
        assert mine.read_bytes() == other.read_bytes()


@pytest.mark.slow
def test_threads_take_turns_where_the_threading_layer_requires_it(tmp_path: Path) -> None:
    """The layer workqueue ends the process if two threads use it at a time."""
    assert executed(TWO_THREADS, tmp_path, NUMBA_THREADING_LAYER="workqueue") == "1\n"


def test_of_two_threads_with_one_folder_one_is_refused(tmp_path: Path) -> None:
    case = mpmcol.load_case("coarse-channel", TINY)
    refused = threading.Event()

    def wait(stage: str, fraction: float) -> None:
        refused.wait(60.0)

    with ThreadPoolExecutor(1) as threads:
        first = threads.submit(mpmcol.run, case, tmp_path, threads=1, progress=wait)
        wait_until(lambda: is_locked(tmp_path))
        try:
            with pytest.raises(OutputError, match="another run is writing here"):
                mpmcol.run(case, tmp_path, threads=1)
        finally:
            refused.set()
        assert first.result().summary["status"] == "done"
