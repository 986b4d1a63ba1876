"""Commands of mpmcol in processes of their own, and reference runs that nothing disturbed."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from mpmcol.io.names import CHECKPOINT_FILES
from mpmcol.io.results import Results
from mpmcol.io.run_status import read_status
from tests.soak.runner.promise import PACKAGE, digest
from tests.support.cli import set_options
from tests.support.runs import SHORT, SMALL_CASES, assert_equal_runs

ROOT = PACKAGE.parent
CACHE = ROOT / "build" / "soak" / "cache"
PATIENCE = 600.0  # s: kernels may have to be compiled
STOPPED = 75  # exit code
ONE_THREAD = {"NUMBA_NUM_THREADS": "1"}


def cached_folder(name: str, fill: Callable[[Path], object]) -> Path:
    """A folder that `fill` fills once for the present code; later trials find it there."""
    folder = CACHE / digest(PACKAGE) / name
    if not folder.exists():
        temporary = folder.with_name(f"{folder.name}.{os.getpid()}")
        shutil.rmtree(temporary, ignore_errors=True)  # of an attempt that failed
        temporary.mkdir(parents=True)
        fill(temporary)
        try:
            temporary.rename(folder)
        except OSError:  # another process was first
            shutil.rmtree(temporary)
    return folder


def run_arguments(name: str) -> list[str]:
    """The arguments that run the small case of this name, without --out."""
    source, *values = SMALL_CASES[name]
    return ["run", source, *set_options((*values, *SHORT))]


def start(
    arguments: list[str], environment: Mapping[str, str] = ONE_THREAD, before: Callable[[], None] | None = None
) -> subprocess.Popen[str]:
    """Start `mpmcol` with its stderr in a pipe; `before` is called in the new process."""
    return subprocess.Popen(
        [sys.executable, "-m", "mpmcol", *arguments], env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, preexec_fn=before,
    )  # fmt: skip


def complete(arguments: list[str], environment: Mapping[str, str] = ONE_THREAD) -> tuple[int, str]:
    """Run `mpmcol` to its end; return its exit code and stderr."""
    process = start(arguments, environment)
    try:
        _, messages = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
    return process.returncode, messages


def child_cpu_time() -> float:
    """CPU time of the child processes that have ended, s; independent of other programs on the machine."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def stop(process: subprocess.Popen[str], number: int) -> tuple[str, float]:
    """Send a signal; return stderr, and the CPU time until the process has ended, s."""
    before = child_cpu_time()
    try:
        fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
        used = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except OSError:  # it has ended, or there is no /proc
        used = 0.0
    process.send_signal(number)
    _, messages = process.communicate(timeout=PATIENCE)
    return messages, max(child_cpu_time() - before - used, 0.0)


def reference_run(name: str) -> Path:
    """The folder of the run that nothing disturbed; run twice, so that its time does not include compilation."""

    def fill(folder: Path) -> None:
        for _ in range(2):
            started = time.monotonic()
            code, messages = complete([*run_arguments(name), "--out", str(folder / "run"), "--fresh", "--threads", "1"])
            assert code == 0, messages
        (folder / "seconds").write_text(str(time.monotonic() - started))

    return cached_folder(f"reference/{name}", fill) / "run"


def reference_seconds(name: str) -> float:
    """Wall-clock time of the reference run with the start of the program, s."""
    return float((reference_run(name).parent / "seconds").read_text())


def wait_for(process: subprocess.Popen[str], is_due: Callable[[], bool]) -> None:
    """Wait until a condition is true, or the process has ended."""
    while process.poll() is None and not is_due():
        time.sleep(0.001)


def finish(name: str, folder: Path, threads: int, environment: Mapping[str, str] | None = None) -> str | None:
    """Give the command once more if the run is incomplete; return how its folder differs from the reference run.

    A run that was killed between writing its result and removing its last checkpoint is also incomplete.
    """
    if read_status(folder).name != "done" or any((folder / name).exists() for name in CHECKPOINT_FILES):
        arguments = [*run_arguments(name), "--out", str(folder), "--threads", str(threads)]
        code, messages = complete(arguments, {"NUMBA_NUM_THREADS": str(threads), **(environment or {})})
        if code != 0:
            return f"the resumed run ended with exit code {code}: {messages}"
    return difference(reference_run(name), folder)


def difference(reference: Path, other: Path) -> str | None:
    """How two finished runs differ; None if all bits are equal and no temporary file is left."""
    try:
        assert_equal_runs(reference, other)
    except AssertionError as error:
        return f"{other} differs from {reference}: {error}"
    if Results(reference).summary["state_sha256"] != Results(other).summary["state_sha256"]:
        return "the final states differ"
    files, expected = ({path.relative_to(run) for path in run.rglob("*")} for run in (other, reference))
    return f"left behind: {sorted(map(str, files - expected))}" if files - expected else None


def describe_exit(code: int) -> str:
    """An exit code, or the signal that killed the process."""
    return f"exit code {code}" if code >= 0 else f"killed by {signal.Signals(-code).name}"
