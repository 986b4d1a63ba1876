"""The lock of a results folder."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from pathlib import Path

import portalocker
import pytest

import mpmcol
from mpmcol.errors import OutputError
from mpmcol.io.lock import is_locked, locked
from mpmcol.io.names import LOCK_FILE


def test_the_folder_is_created_and_locked_for_one_process(tmp_path: Path) -> None:
    folder = tmp_path / "new"
    assert not is_locked(folder)
    with locked(folder):
        assert is_locked(folder)
        with pytest.raises(OutputError, match="another run is writing here"), locked(folder):
            pass
    assert not is_locked(folder)


def test_temporary_files_of_a_killed_run_are_removed(tmp_path: Path) -> None:
    own = ("checkpoint-1.npz", "result.json", "report.html", "wall_pressure.csv", "run.vtkhdf")
    names = (*(f".{name}.77.tmp" for name in own), "snapshots/.000003.vtkhdf.77.tmp")
    others = (".case.toml.77.tmp", "snapshots/000002.vtkhdf", "checkpoint-0.npz")  # a sweep may be writing the first
    (tmp_path / "snapshots").mkdir()
    for name in (*names, *others):
        (tmp_path / name).touch()
    with locked(tmp_path), pytest.raises(OutputError, match="another run is writing here"), locked(tmp_path):
        pass
    remaining = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert remaining == {*others, LOCK_FILE}


def test_a_removed_or_replaced_folder_is_noticed(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    with locked(folder) as lock:
        lock.check()
        folder.rename(tmp_path / "moved")
        with pytest.raises(OutputError, match="run: the folder, or .lock in it, was removed or replaced"):
            lock.check()
        folder.mkdir()
        (folder / LOCK_FILE).touch()
        with pytest.raises(OutputError, match="repeat the command with --out NEW_FOLDER to resume"):
            lock.check()


pytestmark = pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning")
needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")

HOLDER = """
import sys, time
from pathlib import Path
from mpmcol.io.lock import locked

with locked(Path(sys.argv[1])):
    print("locked", flush=True)
    time.sleep(60.0)
"""


def test_the_lock_of_a_killed_process_is_released(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(Path(mpmcol.__file__).parents[1])}
    command = [sys.executable, "-c", HOLDER, str(tmp_path)]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None and holder.stdout.readline() == "locked\n"
        assert is_locked(tmp_path)
        holder.kill()
    assert not is_locked(tmp_path)


def test_the_state_of_a_read_only_folder_is_found_without_creating_a_file(tmp_path: Path) -> None:
    assert not is_locked(tmp_path) and not list(tmp_path.iterdir())
    with locked(tmp_path):
        (tmp_path / LOCK_FILE).chmod(0o444)
        tmp_path.chmod(0o555)
        opened: list[int] = []
        real = os.open
        with pytest.MonkeyPatch.context() as patch:  # the superuser may write in any case
            patch.setattr(os, "open", lambda path, flags, *more: opened.append(flags) or real(path, flags, *more))
            assert is_locked(tmp_path)
        assert opened == [os.O_RDONLY]
        tmp_path.chmod(0o755)


@needs_fork
def test_the_lock_is_released_although_a_forked_child_still_has_the_file_open(tmp_path: Path) -> None:
    with locked(tmp_path):
        child = os.fork()
        if not child:
            signal.pause()
    try:
        assert not is_locked(tmp_path)
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)


@needs_fork
def test_a_child_that_leaves_the_context_leaves_the_lock_to_its_parent(tmp_path: Path) -> None:
    parent = os.getpid()
    with locked(tmp_path):
        child = os.fork()
        if child:
            os.waitpid(child, 0)
            assert is_locked(tmp_path)
    if os.getpid() != parent:
        os._exit(0)


def test_a_file_system_without_locks_is_refused_in_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*arguments: object) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(portalocker.portalocker, "LOCKER", fail)
    (tmp_path / LOCK_FILE).touch()
    assert not is_locked(tmp_path)
    with pytest.raises(OutputError, match="has no file locks .*choose a folder on another disk"), locked(tmp_path):
        pass
