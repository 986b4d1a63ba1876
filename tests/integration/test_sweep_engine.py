"""The engine of sweeps with simulated child processes: order, retries, failures, locks, stopping.

Real runs are in test_cli_sweep.py.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mpmcol.cli.worker import execute as execute_in_worker
from mpmcol.errors import OutputError
from mpmcol.io.lock import is_locked, locked
from mpmcol.io.names import GIVEN_CASE_FILE
from mpmcol.io.results import Results
from mpmcol.io.run_status import read_status, time_reached
from mpmcol.provenance import code_version
from mpmcol.simulation.summary import peak_memory
from mpmcol.sweep import task, worker
from mpmcol.sweep.axes import parse_axes
from mpmcol.sweep.commands import write_commands
from mpmcol.sweep.compile_cache import smallest_per_variant
from mpmcol.sweep.engine import Outcome, execute_runs, exit_code, local_pool
from mpmcol.sweep.plan import Plan, PlanEntry, read_plan, write_plan
from mpmcol.sweep.progress import ProgressTracker, count_by_status, find_plan, time_left, total_progress
from mpmcol.sweep.runner import overview, run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_runs, write_case
from mpmcol.sweep.scheduling import Allocation
from mpmcol.sweep.task import Task, TaskResult, execute_task, execute_with, run_command
from mpmcol.sweep.worker import COMPILE, CONTINUE, Worker
from tests.support.cli import invoke
from tests.support.processes import wait_until

# A worker whose runs behave as its argument states, by the name of their folder.
WORKER = """
import fcntl, json, os, signal, sys, time
from pathlib import Path
chosen, answers = json.loads(sys.argv[1]), os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
def execute(folder, what):
    lock = (folder / ".lock").open("w")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return print("another run is writing here") or 1
    with lock:
        return behave(folder, what)
def end(folder, status, code, **more):
    result = {"schema": 1, "status": status, "wall_s": {"collapse": 1.0}, **more}
    (folder / "result.json").write_text(json.dumps(result))
    return code
def behave(folder, what):
    tries = folder / "tries"
    tries.write_text(str(int(tries.read_text()) + 1 if tries.exists() else 1))
    with (folder / "process").open("a") as processes:
        print(os.getpid(), file=processes)
    if what == "killed" or (what == "killed once" and tries.read_text() == "1"):
        os.kill(os.getpid(), signal.SIGKILL)
    if what == "diverges":
        return end(folder, "failed", 3, failure={"cause": "a run is too fast", "remedy": "lower time.cfl"})
    if what == "disk":
        print("note: ...", "result.json: cannot be written: No space left", sep="\\n")
        return 5
    if what == "refuses":
        print("it does not fit")
        return 2
    if what == "waits":
        stopped = []
        signal.signal(signal.SIGTERM, lambda *_: stopped.append(1))
        (folder / "begun").touch()
        while not stopped:
            time.sleep(0.05)
        return end(folder, "stopped", 75)
    if what == "ignores SIGTERM":
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        (folder / "begun").touch()
        time.sleep(60)
    time.sleep(0.2)
    return end(folder, "done", 0)
for line in sys.stdin:
    arguments = json.loads(line)
    if arguments[0] == "compile":
        print(0, 0, file=answers, flush=True)
        continue
    assert (arguments[0], arguments[-1]) == ("run", "--quiet")
    folder = Path(arguments[arguments.index("--out") + 1])
    what = chosen.get(folder.name.partition("-")[0], "is done")
    code = execute(folder, what)
    sys.stdout.flush()
    print(code, 300_000_000 if what == "leaves memory" else 200_000_000, file=answers, flush=True)
"""
DONE = json.dumps({"schema": 1, "status": "done", "wall_s": {"compile": 9.0, "collapse": 2.0}})

Acts = Callable[..., None]


@pytest.fixture
def acts(monkeypatch: pytest.MonkeyPatch) -> Acts:
    """Sets the behaviour of the runs with these aspect ratios; all others are done at once."""
    chosen: dict[str, str] = {}

    monkeypatch.setattr(worker, "worker_command", lambda: [sys.executable, "-c", WORKER, json.dumps(chosen)])
    return lambda **what: chosen.update(what)


def make_runs(out: Path, aspect: str = "1,2,3") -> list[PlannedRun]:
    return plan_runs("lube-cylinder", parse_axes(aspect, ["grid.spacing=0.02"])[0], out)


def endings(outcomes: list[Outcome]) -> dict[str, tuple[str, int]]:
    return {outcome.run.name: (outcome.status, outcome.result.attempts) for outcome in outcomes}


def tries(run: PlannedRun) -> int:
    path = run.folder / "tries"
    return int(path.read_text()) if path.exists() else 0


def test_largest_first_one_at_a_time(tmp_path: Path, acts: Acts) -> None:
    outcomes = list(execute_runs(make_runs(tmp_path), Allocation(1, 1)))
    assert [outcome.run.name for outcome in outcomes] == ["a3", "a2", "a1"]
    assert exit_code(outcomes) == 0


def test_the_prescribed_number_of_runs_is_concurrent(tmp_path: Path, acts: Acts) -> None:
    acts(a1="waits", a2="waits", a3="waits")
    runs = make_runs(tmp_path)
    begun: list[int] = []

    def count() -> None:
        begun.append(sum((run.folder / "begun").exists() for run in runs))
        if begun[-1] == 2 and begun[-5:] == [2] * 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(execute_runs(runs, Allocation(2, 1), tick=count))
    assert max(begun) == 2


def processes(run: PlannedRun) -> list[str]:
    """The process of each attempt."""
    return (run.folder / "process").read_text().split()


def test_a_process_executes_one_run_after_another(tmp_path: Path, acts: Acts, monkeypatch: pytest.MonkeyPatch) -> None:
    """After a failure, and if it has much memory, a new one follows."""
    acts(**{"a3": "killed once", "a2": "diverges", "a1.4": "leaves memory"})
    runs = make_runs(tmp_path, "1,1.2,1.4,1.6,1.8,2,3,4,5")
    list(execute_runs(runs, Allocation(1, 1)))
    used = [one for run in reversed(runs) for one in processes(run)]  # the largest is the first: a5, a4, ...
    order = [used.index(one) for one in used]
    assert order == [0, 0, 0, 3, 3, 5, 5, 5, 8, 8]
    assert not any(is_running(int(one)) for one in used)


def is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def test_finished_runs_are_not_repeated(tmp_path: Path, acts: Acts) -> None:
    runs = make_runs(tmp_path)
    first = list(execute_runs(runs, Allocation(2, 1)))
    messages: list[str] = []
    second = list(execute_runs(runs, Allocation(2, 1), notify=messages.append))
    assert [tries(run) for run in runs] == [1, 1, 1]
    assert set(endings(first).values()) == {("done", 1)} and set(endings(second).values()) == {("done", 0)}
    assert messages == []


def test_a_run_that_fails_does_not_stop_the_others(tmp_path: Path, acts: Acts) -> None:
    acts(a1="killed", a2="diverges", a3="disk", a4="killed once")
    runs = make_runs(tmp_path, "1,2,3,4,5")
    outcomes = list(execute_runs(runs, Allocation(2, 1)))
    assert endings(outcomes) == {
        "a1": ("error", 3), "a2": ("failed", 1), "a3": ("error", 3), "a4": ("done", 2), "a5": ("done", 1),
    }  # fmt: skip
    messages = {outcome.run.name: outcome.result.message for outcome in outcomes}
    assert messages["a1"].startswith("killed by SIGKILL, 3 times (")
    assert messages["a2"] == "a run is too fast; lower time.cfl"
    assert messages["a3"].startswith("exit code 5, 3 times: result.json: cannot be written: No space left (")
    assert exit_code(outcomes) == 5


def test_a_divergence_is_reported_again_but_not_repeated(tmp_path: Path, acts: Acts) -> None:
    acts(a2="diverges")
    runs = make_runs(tmp_path)
    for attempts in (1, 0):
        outcomes = list(execute_runs(runs, Allocation(1, 1)))
        assert endings(outcomes)["a2"] == ("failed", attempts)
        assert exit_code(outcomes) == 3
    assert tries(runs[1]) == 1


def test_a_refusal_is_not_retried(tmp_path: Path, acts: Acts) -> None:
    acts(a1="refuses")
    (outcome,) = execute_runs(make_runs(tmp_path, "1"))
    assert (outcome.status, outcome.result.attempts) == ("error", 1)
    assert "it does not fit" in outcome.result.message and exit_code([outcome]) == 2


@pytest.mark.parametrize(
    ("codes", "expected"), [([0], 0), ([0, 1], 1), ([-9], 1), ([1, 3], 3), ([3, 5], 5), ([5, 75], 75)]
)
def test_exit_codes(tmp_path: Path, codes: list[int], expected: int) -> None:
    (run,) = make_runs(tmp_path, "1")
    assert exit_code([Outcome(run, TaskResult("error" if code else "done", 1, code)) for code in codes]) == expected


def test_a_damaged_result_is_replaced(tmp_path: Path) -> None:
    (run,) = make_runs(tmp_path, "1")
    run.folder.mkdir()
    (run.folder / "result.json").write_text("{")
    assert read_status(run.folder).name == "damaged"
    assert run_command(run.folder, 2, fresh=True)[-3:] == ["--threads", "2", "--fresh"]


def test_an_interruption_stops_the_runs_gracefully(tmp_path: Path, acts: Acts) -> None:
    acts(a1="waits", a2="waits")
    runs = make_runs(tmp_path, "1,2,3")
    messages: list[str] = []

    def interrupt() -> None:
        if all((run.folder / "begun").exists() for run in runs[:2]) and read_status(runs[2].folder).has_ended:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(execute_runs(runs, Allocation(3, 1), notify=messages.append, tick=interrupt))
    assert [read_status(run.folder).name for run in runs] == ["stopped", "stopped", "done"]
    assert messages[-1] == "stopping the runs (press Ctrl-C again to abort) ..."


def test_a_run_that_does_not_end_is_killed(tmp_path: Path, acts: Acts, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker, "GRACE", 0.5)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell ignores it in commands in the background
    acts(a1="ignores SIGTERM")
    (run,) = make_runs(tmp_path, "1")
    outcomes = execute_runs([run], Allocation(1, 1), tick=lambda: None)
    with closing(outcomes):
        threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            next(outcomes)
    assert read_status(run.folder).name == "missing" and not is_locked(run.folder)


def test_leaving_the_loop_stops_the_runs(tmp_path: Path, acts: Acts) -> None:
    acts(a1="waits")
    runs = make_runs(tmp_path)
    with closing(execute_runs(runs, Allocation(3, 1))) as outcomes:
        next(outcomes)
        wait_until(lambda: (runs[0].folder / "begun").exists())
    assert read_status(runs[0].folder).name == "stopped"


def test_a_run_of_another_process_is_waited_for(tmp_path: Path, acts: Acts) -> None:
    (run,) = make_runs(tmp_path, "1")
    held = threading.Event()

    def other() -> None:
        with locked(run.folder):
            held.set()
            time.sleep(0.6)
            (run.folder / "result.json").write_text(DONE)

    thread = threading.Thread(target=other)
    thread.start()
    held.wait()
    assert read_status(run.folder).name == "running"
    (outcome,) = execute_runs([run])
    thread.join()
    assert (outcome.status, outcome.result.attempts, tries(run)) == ("done", 0, 0)


def test_two_sweeps_in_one_folder_execute_every_run_once(tmp_path: Path, acts: Acts) -> None:
    runs, found = make_runs(tmp_path, "1,2,3,4,5,6"), []
    for run in runs:
        write_case(run)
    sweeps = [threading.Thread(target=lambda: found.extend(execute_runs(runs, Allocation(2, 1)))) for _ in range(2)]
    for sweep in sweeps:
        sweep.start()
    for sweep in sweeps:
        sweep.join()
    assert [outcome.status for outcome in found] == ["done"] * 12
    assert [tries(run) for run in runs] == [1] * 6


def test_a_worker_with_another_version_of_the_code_runs_nothing(tmp_path: Path, acts: Acts) -> None:
    (run,) = make_runs(tmp_path, "1")
    ending = execute_task(Task(run.folder, 1, "0.0.0+12345678"))
    assert (ending.status, ending.exit_code) == ("error", 2)
    assert f"the worker has mpmcol {code_version()}, expected 0.0.0+12345678" in ending.message


def test_an_executor_that_loses_a_task(tmp_path: Path, acts: Acts) -> None:
    runs = make_runs(tmp_path)
    with local_pool(1) as pool:

        class Losing(type(pool.executor)):
            def submit(self, function, given, *rest):
                if given.folder == runs[1].folder.resolve():
                    return super().submit(lambda: 1 / 0)
                return super().submit(function, given, *rest)

        with Losing(1) as executor:
            outcomes = list(execute_runs(runs, Allocation(1, 1), pool=replace(pool, executor=executor)))
    assert {name: status for name, (status, _) in endings(outcomes).items()} == {
        "a1": "done",
        "a2": "error",
        "a3": "done",
    }
    assert (
        "ZeroDivisionError: division by zero"
        in next(outcome for outcome in outcomes if outcome.status == "error").result.message
    )


def test_a_folder_that_cannot_be_written(tmp_path: Path, acts: Acts) -> None:
    (run,) = make_runs(tmp_path, "1")
    run.folder.write_text("a file is in the way")
    with pytest.raises(OutputError, match="file of that name is in the way"):
        list(execute_runs([run]))


def test_the_plan_is_written_into_the_folder(tmp_path: Path, acts: Acts) -> None:
    acts(a2="diverges")
    runs = make_runs(tmp_path / "out")
    assert overview(runs, runs, Allocation(2, 1)).startswith("3 runs: 2 runs at a time, 1 thread per run, on ")
    outcomes = run_sweep(runs, tmp_path / "out", jobs=2)
    assert [outcome.run.name for outcome in outcomes] == ["a1", "a2", "a3"]
    plan = read_plan(tmp_path / "out")
    assert (plan.version, plan.jobs, plan.runs[2].inputs["geometry.aspect"]) == (code_version(), 2, 3.0)
    tracked = ProgressTracker(tmp_path / "out", plan).runs()
    assert count_by_status(tracked) == {"done": 2, "failed": 1} and total_progress(tracked) == 1.0
    assert overview(runs, [], Allocation(2, 1)) == "3 runs, 3 already finished: nothing to run"


def test_the_command_runs_the_case_in_the_folder(tmp_path: Path) -> None:
    (run,) = make_runs(tmp_path, "1")
    assert run_command(run.folder, 3)[3:] == [
        "run", str(run.folder / GIVEN_CASE_FILE), "--out", str(run.folder), "--threads", "3",
    ]  # fmt: skip


def write_run(folder: Path, time_reached: float | None, result: str | None = None) -> None:
    folder.mkdir(parents=True)
    (folder / "case.resolved.toml").touch()
    if time_reached is not None:
        (folder / "history.csv").write_text(f"stage,step,time,dt\nrelease,9,0.0,1\ncollapse,10,{time_reached},1\n")
    if result:
        (folder / "result.json").write_text(result)


def test_time_left_follows_from_the_mean_speed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = ("done", "half", "cut", "stopped", "none")
    write_run(tmp_path / "done", 1.0, DONE)
    write_run(tmp_path / "half", 0.5)
    write_run(tmp_path / "cut", None)
    write_run(tmp_path / "stopped", 0.7, '{"schema": 1, "status": "stopped"}')
    plan = Plan("", code_version(), 2, 1, tuple(PlanEntry(name, {}, 100.0, 1.0) for name in names))
    monkeypatch.setattr("mpmcol.sweep.progress.running_for", lambda folder: 4.0)
    with locked(tmp_path / "half"):
        tracked = ProgressTracker(tmp_path, plan).runs()
    assert [run.status.name for run in tracked] == ["done", "running", "unfinished", "stopped", "missing"]
    assert [run.progress for run in tracked] == [1.0, 0.5, 0.0, 0.0, 0.0]
    assert total_progress(tracked) == pytest.approx(1.5 / 5)
    assert time_left(tracked, 2) == pytest.approx((2.0 + 4.0) / 150.0 * 350.0 / 2)  # without compilation
    assert time_left(tracked, 8) == pytest.approx((2.0 + 4.0) / 150.0 * 100.0)  # a run is never split
    assert time_left(tracked[2:], 2) is None


def test_time_left_of_a_resumed_run_follows_from_the_speed_since_then(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From 0.4 to 0.5 in 4 s: 20 s for the other half."""
    write_run(tmp_path / "resumed", 0.5)
    (tmp_path / "resumed" / "case.resolved.toml").write_text("title = 'a'\n\n# derived:\n# resumed_at = 0.4\n")
    plan = Plan("", code_version(), 1, 1, (PlanEntry("resumed", {}, 100.0, 1.0),))
    monkeypatch.setattr("mpmcol.sweep.progress.running_for", lambda folder: 4.0)
    with locked(tmp_path / "resumed"):
        tracked = ProgressTracker(tmp_path, plan).runs()
    assert (tracked[0].progress, tracked[0].resumed) == (0.5, 0.4)
    assert time_left(tracked, 1) == pytest.approx(20.0)
    (tmp_path / "resumed" / "history.csv").unlink()  # nothing is known of the speed yet
    with locked(tmp_path / "resumed"):
        tracked = ProgressTracker(tmp_path, plan).runs()
    assert tracked[0].progress == 0.4 and time_left(tracked, 1) is None


def test_a_folder_without_a_sweep(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="expected the folder of a sweep"):
        find_plan(tmp_path)
    (tmp_path / "sweep.json").write_text('{"schema": 99}')
    with pytest.raises(OutputError, match="written by another version of mpmcol"):
        find_plan(tmp_path)


def test_kernels_are_compiled_before_the_first_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    commands: list[list[str]] = []

    def execute(self: Worker, arguments: list[str], *rest: object) -> tuple[int, str]:
        commands.append(arguments)
        return 1, ""

    monkeypatch.setattr(Worker, "execute", execute)
    monkeypatch.setattr(worker, "worker_command", lambda: [sys.executable, "-c", ""])
    monkeypatch.setattr(task, "RETRIES", 0)
    runs = plan_runs(
        "lube-cylinder", parse_axes("1,2", ["grid.spacing=0.02", "geometry.model=axisymmetric,plane"])[0], tmp_path
    )
    list(execute_runs(runs, Allocation(2, 1)))
    list(execute_runs(runs, Allocation(1, 1)))
    assert [command[0] for command in commands] == ["compile", *(8 * ["run"])]
    assert len(commands[0]) == 2 and "/a1-" in commands[0][1]  # both models use the same kernels


def test_a_worker_executes_runs_like_the_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second run has the bits of a first one, and a refused case leaves its message."""
    monkeypatch.setattr(worker, "PROCESS_BYTES", np.inf)  # the kernels may have been compiled in this process
    short = ["grid.spacing=0.02", "stages.collapse.max_time_factor=0.1", "stages.equilibrate.max_time_factor=0.5"]
    first, second = plan_runs("lube-cylinder", parse_axes("1,1.5", short)[0], tmp_path / "one")
    (alone,) = plan_runs("lube-cylinder", parse_axes("1.5", short)[0], tmp_path / "other")
    missing = str(tmp_path / "missing.toml")
    with closing(Worker()) as both:
        assert both.execute([COMPILE, str(write_case(first))], 1) == (0, "")
        process = both.start(1)
        for run in (first, second):
            write_case(run)
            assert execute_with(both, Task(run.folder, 1, code_version()), lambda: CONTINUE).status == "done"
        assert both.start(1) is process
        code, printed = both.execute(["run", missing], 1)
        assert (code, missing in printed, "Traceback" in printed) == (2, True, False)
        assert both.execute([COMPILE, missing], 1)[0] == 2
        assert both.start(1) is not process and process.poll() is not None
    write_case(alone)
    assert execute_task(Task(alone.folder, 1, code_version())).status == "done"
    states = [Results(run.folder).summary["state_sha256"] for run in (second, alone)]
    assert states[0] == states[1]


@pytest.mark.skipif(not Path("/proc/self/clear_refs").exists(), reason="only Linux can reset the peak")
def test_the_peak_memory_of_a_run_is_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    large = np.ones(30_000_000)
    before = peak_memory()
    size = large.nbytes
    del large
    assert execute_in_worker(["cases"]) == 0 and "quickstart" in capsys.readouterr().out
    assert peak_memory() < before - 0.9 * size


@pytest.mark.parametrize(
    ("axis", "sets"),
    [
        ("method.transfer=flip,pic,tpic,taylor-flip", 1),
        ("method.transfer=tpic,apic", 2),
        ("method.stress_order=usl,usf,musl", 3),
        ("method.basis=linear,quadratic,cubic", 3),
    ],
)
def test_schemes_have_different_kernels(axis: str, sets: int, tmp_path: Path) -> None:
    runs = plan_runs("lube-cylinder", parse_axes("1", ["grid.spacing=0.02", axis])[0], tmp_path)
    assert len(smallest_per_variant(runs)) == sets


@pytest.mark.parametrize(("stage", "time", "share"), [("equilibrate", 0.3, None), ("collapse", 0.3, 0.3)])
def test_time_before_the_release_does_not_count(stage: str, time: float, share: float | None, tmp_path: Path) -> None:
    (tmp_path / "history.csv").write_text(f"stage,step,time\nequilibrate,1,0.1\n{stage},9,{time}\n")
    assert time_reached(tmp_path) == share


def test_the_status_of_a_stopped_run_has_the_end_of_its_history(tmp_path: Path) -> None:
    entries = tuple(PlanEntry(name, {}, 1.0, 1.0) for name in ("stopped", "killed", "empty"))
    write_plan(tmp_path, Plan("", code_version(), 1, 1, entries))
    write_run(tmp_path / "stopped", 0.25, '{"schema": 1, "status": "stopped"}')
    write_run(tmp_path / "killed", 0.5)
    write_run(tmp_path / "empty", None)
    stopped, killed, empty = invoke("status", tmp_path).stdout.splitlines()[1:4]
    assert stopped.endswith("by a signal or the wall-clock limit, after step 10 at t = 0.25 s (collapse)")
    assert killed.endswith("the process was killed, after step 10 at t = 0.5 s (collapse)")
    assert empty.endswith("the process was killed")


def test_fresh_discards_finished_runs(tmp_path: Path, acts: Acts) -> None:
    runs = make_runs(tmp_path / "out")
    run_sweep(runs, tmp_path / "out", jobs=2)
    (runs[0].folder / "mine.txt").write_text("kept")
    run_sweep(runs, tmp_path / "out", jobs=2, fresh=True)
    assert [tries(run) for run in runs] == [2, 2, 2]
    assert (runs[0].folder / "mine.txt").exists()


def test_what_a_run_printed_before_its_log_is_added_to_it(tmp_path: Path, acts: Acts) -> None:
    acts(a1="refuses")
    (run,) = make_runs(tmp_path, "1")
    list(execute_runs([run]))
    assert (run.folder / "run.log").read_text() == "it does not fit\n"


def test_commands_and_the_slurm_script_quote_their_paths(tmp_path: Path) -> None:
    out = tmp_path / "my sweep, 50 %"
    lines = write_commands(make_runs(out), 2, out)
    assert all(Path(shlex.split(line)[4]).is_file() for line in lines)
    script = (out / "slurm.sh").read_text()
    options = dict(re.findall(r"^#SBATCH --([\w-]+)=(.+)$", script, re.MULTILINE))
    assert shlex.split(options["output"]) == [f"{tmp_path}/my sweep, 50 %%/slurm-%a.log"]  # %% is a % in Slurm
    assert shlex.split(options["job-name"]) == ["mpmcol-my sweep, 50 %"]
    found = subprocess.run(
        ["bash", "-c", script.replace("eval", "echo")],
        env={**os.environ, "SLURM_ARRAY_TASK_ID": "2"}, capture_output=True, text=True,
    )  # fmt: skip
    assert found.stdout.strip() == lines[1], found.stderr
