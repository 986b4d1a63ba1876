"""Atomic writing: the old or the new content, and no temporary file, whatever fails."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

import pytest

from mpmcol.errors import OutputError
from mpmcol.io import atomic
from mpmcol.io.atomic import atomic_write, make_folder


def failing(code: int):
    def fail(*args, **kwargs):
        raise OSError(code, os.strerror(code))

    return fail


def test_content_is_replaced_and_no_other_file_remains(tmp_path: Path):
    atomic_write(tmp_path / "a.txt", b"old, and longer")
    atomic_write(tmp_path / "a.txt", b"new")
    assert (tmp_path / "a.txt").read_bytes() == b"new"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_empty_content(tmp_path: Path):
    atomic_write(tmp_path / "a.txt", b"")
    assert (tmp_path / "a.txt").read_bytes() == b""


def test_permissions_equal_those_of_a_new_file(tmp_path: Path):
    (tmp_path / "plain").write_bytes(b"")
    atomic_write(tmp_path / "atomic", b"")
    plain, atomic = (stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("plain", "atomic"))
    assert atomic == plain


def test_short_writes_are_continued(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    write = os.write
    monkeypatch.setattr(os, "write", lambda descriptor, data: write(descriptor, data[:3]))
    atomic_write(tmp_path / "a.txt", b"0123456789")
    assert (tmp_path / "a.txt").read_bytes() == b"0123456789"


@pytest.mark.parametrize("call", ["open", "write", "fsync", "replace"])
def test_failure_leaves_the_old_file_and_no_temporary_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str):
    target = tmp_path / "a.txt"
    atomic_write(target, b"old")
    monkeypatch.setattr(os, call, failing(errno.EIO))
    with pytest.raises(OutputError, match="a.txt: cannot be written: Input/output error; check the disk"):
        atomic_write(target, b"new")
    monkeypatch.undo()
    assert target.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_disk_full_half_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    target = tmp_path / "a.txt"
    atomic_write(target, b"old")
    write, room = os.write, [4]

    def limited(descriptor: int, data: bytes) -> int:
        if not room[0]:
            failing(errno.ENOSPC)()
        written = write(descriptor, data[: room[0]])
        room[0] -= written
        return written

    monkeypatch.setattr(os, "write", limited)
    with pytest.raises(OutputError, match="No space left on device; free some space") as caught:
        atomic_write(target, b"0123456789")
    assert caught.value.exit_code == 5
    assert target.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_interrupt_leaves_no_temporary_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def interrupt(*args):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        atomic_write(tmp_path / "a.txt", b"new")
    assert os.listdir(tmp_path) == []


def test_data_is_synced_before_the_rename_and_the_folder_after(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    calls: list[str] = []
    fsync, replace = os.fsync, os.replace

    def logged_fsync(descriptor: int) -> None:
        calls.append("folder" if stat.S_ISDIR(os.fstat(descriptor).st_mode) else "file")
        fsync(descriptor)

    def logged_replace(source: Path, target: Path) -> None:
        calls.append("replace")
        replace(source, target)

    monkeypatch.setattr(os, "fsync", logged_fsync)
    monkeypatch.setattr(os, "replace", logged_replace)
    atomic_write(tmp_path / "a.txt", b"new")
    assert calls == ["file", "replace", "folder"]


def test_missing_folder_is_named(tmp_path: Path):
    with pytest.raises(OutputError, match="gone/a.txt: cannot be written: .*; there is no folder .*gone; create it"):
        atomic_write(tmp_path / "gone" / "a.txt", b"")


def test_make_folder(tmp_path: Path):
    assert make_folder(tmp_path / "a" / "b").is_dir()
    assert make_folder(tmp_path / "a" / "b").is_dir()
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="file/b: cannot be written"):
        make_folder(tmp_path / "file" / "b")


@pytest.mark.parametrize("refusals", [3, 10**6], ids=["shortly", "longer"])
def test_a_file_that_another_program_has_open_in_windows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refusals: int
) -> None:
    """Windows refuses to replace it; the rename is repeated until the other program, often a scanner, closes it."""
    replace, attempts = os.replace, []

    def refuse(source: Path, target: Path) -> None:
        attempts.append(target)
        if len(attempts) <= refusals:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        replace(source, target)

    monkeypatch.setattr(os, "replace", refuse)
    monkeypatch.setattr(atomic, "PATIENCE", 0.2)
    target = tmp_path / "a.txt"
    if refusals == 3:
        atomic_write(target, b"new")
        assert target.read_bytes() == b"new" and len(attempts) == 4
    else:
        with pytest.raises(OutputError, match="a.txt: cannot be written: Permission denied"):
            atomic_write(target, b"new")
        assert os.listdir(tmp_path) == []
