"""Small runs in processes of their own, and the one that nothing disturbed, made once for each case."""

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
from tests.soak.figures import PACKAGE, digest
from tests.support.cli import set_options
from tests.support.runs import SHORT, SMALL_CASES, assert_equal_runs

ROOT = PACKAGE.parent
KEPT = ROOT / "build" / "soak" / "kept"
PATIENCE = 600.0  # s: kernels may have to be compiled
STOPPED = 75  # exit code
QUIET = {"NUMBA_NUM_THREADS": "1"}


def keep(name: str, make: Callable[[Path], object]) -> Path:
    """A folder that `make` fills once for the present code, and that later trials find there."""
    place = KEPT / digest(PACKAGE) / name
    if not place.exists():
        making = place.with_name(f"{place.name}.{os.getpid()}")
        shutil.rmtree(making, ignore_errors=True)  # of an attempt that failed
        making.mkdir(parents=True)
        make(making)
        try:
            making.rename(place)
        except OSError:  # another process was first
            shutil.rmtree(making)
    return place


def words(name: str) -> list[str]:
    """The command that runs the case of this name, without --out."""
    source, *values = SMALL_CASES[name]
    return ["run", source, *set_options((*values, *SHORT))]


def start(
    command: list[str], environment: Mapping[str, str] = QUIET, before: Callable[[], None] | None = None
) -> subprocess.Popen[str]:
    """Start `mpmcol` with these words and its stderr in a pipe; `before` is called in its process."""
    return subprocess.Popen(
        [sys.executable, "-m", "mpmcol", *command], env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, preexec_fn=before,
    )  # fmt: skip


def carry_out(command: list[str], environment: Mapping[str, str] = QUIET) -> tuple[int, str]:
    """Exit code and stderr of `mpmcol` with these words."""
    run = start(command, environment)
    try:
        _, said = run.communicate(timeout=PATIENCE)
    finally:
        run.kill()
    return run.returncode, said


def cpu_time() -> float:
    """Seconds that processes we waited for took of a core: on a busy machine the wall's clock tells nothing of them."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def stop(run: subprocess.Popen[str], number: int) -> tuple[str, float]:
    """Send a signal; returns what the run said on stderr, and the seconds of a core that it took until its end."""
    before = cpu_time()
    try:
        words = Path(f"/proc/{run.pid}/stat").read_text().rpartition(")")[2].split()
        used = (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")
    except OSError:  # it has gone, or there is no /proc
        used = 0.0
    run.send_signal(number)
    _, said = run.communicate(timeout=PATIENCE)
    return said, max(cpu_time() - before - used, 0.0)


def undisturbed(name: str) -> Path:
    """The folder of the case's run that nothing disturbed, with kernels warm: its time on the wall tells the pace."""

    def make(folder: Path) -> None:
        for _ in range(2):
            started = time.monotonic()
            code, said = carry_out([*words(name), "--out", str(folder / "run"), "--fresh", "--threads", "1"])
            assert code == 0, said
        (folder / "seconds").write_text(str(time.monotonic() - started))

    return keep(f"undisturbed/{name}", make) / "run"


def seconds(name: str) -> float:
    """What the undisturbed run took, with starting up, s."""
    return float((undisturbed(name).parent / "seconds").read_text())


def await_(run: subprocess.Popen[str], due: Callable[[], bool]) -> None:
    """Wait until something is due, or the run has ended."""
    while run.poll() is None and not due():
        time.sleep(0.001)


def finish(name: str, folder: Path, threads: int, environment: Mapping[str, str] | None = None) -> str | None:
    """Give the run's command once more, and say how what it leaves differs from the undisturbed run.

    Of a run that was killed after its result and before its last state was removed, too.
    """
    if read_status(folder).name != "done" or any((folder / name).exists() for name in CHECKPOINT_FILES):
        command = [*words(name), "--out", str(folder), "--threads", str(threads)]
        code, said = carry_out(command, {"NUMBA_NUM_THREADS": str(threads), **(environment or {})})
        if code != 0:
            return f"going on ended with exit code {code}: {said}"
    return compare(undisturbed(name), folder)


def compare(whole: Path, other: Path) -> str | None:
    """How two finished runs differ; None if they left equal bits, and nothing of what was half written."""
    try:
        assert_equal_runs(whole, other)
    except AssertionError as difference:
        return f"{other} differs from {whole}: {difference}"
    if Results(whole).summary["state_sha256"] != Results(other).summary["state_sha256"]:
        return "the final states differ"
    left = {path.relative_to(other) for path in other.rglob("*")} - {
        path.relative_to(whole) for path in whole.rglob("*")
    }
    return f"left behind: {sorted(map(str, left))}" if left else None


def described(code: int) -> str:
    """An exit code in words."""
    return f"exit code {code}" if code >= 0 else f"killed by {signal.Signals(-code).name}"
