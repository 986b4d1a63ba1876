"""The lock of a results folder."""

from __future__ import annotations

from pathlib import Path

import pytest

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
    names = (".checkpoint-1.npz.77.tmp", ".result.json.77.tmp", ".run.vtkhdf.77.tmp", "snapshots/.000003.vtkhdf.77.tmp")
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
