"""Variables of the caller's environment neither break commands nor are ignored."""

from __future__ import annotations

import os
import shutil
import stat
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from mpmcol.mpm import cache_folder
from tests.support.cli import invoke, set_options
from tests.support.runs import TINY

CHINESE = "\u67f1.toml"  # "column"
CACHE = "from mpmcol.mpm.jit import CACHE_FOLDER, CACHE_NOTE\nprint(CACHE_FOLDER)\nprint(CACHE_NOTE)"
THREADS = "from mpmcol.mpm.threads import set_threads\nprint(set_threads(None))"


def run(*command: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *command], env={**os.environ, **environment}, capture_output=True, text=True)


@pytest.mark.parametrize("backend", ["module://matplotlib_inline.backend_inline", "nonsense"])
def test_charts_do_not_depend_on_the_backend_of_matplotlib(finished: Path, tmp_path: Path, backend: str) -> None:
    folder = shutil.copytree(finished, tmp_path / "run")
    done = run("-m", "mpmcol", "plot", str(folder), MPLBACKEND=backend)
    assert done.returncode == 0, done.stderr
    assert (folder / "front.png").exists()


@pytest.mark.parametrize("content", ['extends = "coarse-channel"\n', "wrong = 1\n"], ids=["stdout", "stderr"])
def test_text_that_the_encoding_of_a_console_lacks_is_written_as_escapes(content: str, tmp_path: Path) -> None:
    (tmp_path / CHINESE).write_text(content)
    done = run("-m", "mpmcol", "check", str(tmp_path / CHINESE), PYTHONIOENCODING="cp1252:strict")
    assert "\\u67f1.toml" in done.stdout + done.stderr and "internal error" not in done.stderr


@pytest.mark.parametrize(("value", "expected"), [("1", 1), ("3", 3), ("100", 4), ("2,1", 2), ("many", 4), ("", 4)])
def test_threads_are_limited_by_omp_num_threads(value: str, expected: int) -> None:
    done = run("-c", THREADS, OMP_NUM_THREADS=value, NUMBA_NUM_THREADS="4")
    assert done.stdout.strip() == str(expected), done.stderr


def test_a_missing_threading_layer_is_an_error_in_words() -> None:
    done = run("-c", THREADS, NUMBA_THREADING_LAYER="tbb")
    if done.returncode == 0:
        pytest.skip("tbb is installed here")
    assert "NUMBA_THREADING_LAYER = 'tbb' is not available here; remove this variable" in done.stderr


def cache_without_home(folder: Path) -> tuple[Path, str]:
    """The folder of compiled kernels and the note on it, of a user without a home, with temporary files in `folder`."""
    (folder / "file").touch()
    done = run("-c", CACHE, MPMCOL_CACHE_DIR=str(folder / "file"), TMPDIR=str(folder))
    assert done.returncode == 0, done.stderr
    path, note = done.stdout.splitlines()
    return Path(path), note


def test_without_a_home_all_commands_share_one_private_cache(tmp_path: Path) -> None:
    first, note = cache_without_home(tmp_path)
    assert cache_without_home(tmp_path) == (first, note)
    assert first.parent == tmp_path / f"mpmcol-{os.getuid()}" and first.is_dir()
    assert stat.S_IMODE(first.parent.stat().st_mode) == 0o700
    assert "compiled kernels are kept in" in note and "set MPMCOL_CACHE_DIR to a folder that can be written" in note


@pytest.mark.parametrize("how", ["open to others", "link", "of another user"])
def test_a_shared_folder_among_the_temporary_files_is_not_used(
    how: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another user could put machine code there."""
    shared = tmp_path / f"mpmcol-{os.getuid()}"
    if how == "link":
        (tmp_path / "other").mkdir(mode=0o700)
        shared.symlink_to(tmp_path / "other")
    else:
        shared.mkdir(mode=0o700)
        shared.chmod(0o770 if how == "open to others" else 0o700)
    if how == "of another user":
        monkeypatch.setattr(cache_folder, "_user_id", lambda: os.getuid() + 1)
        shared.rename(tmp_path / f"mpmcol-{os.getuid() + 1}")
    monkeypatch.setenv("MPMCOL_CACHE_DIR", os.devnull)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    root, note = cache_folder.cache_root()
    assert root.parent == tmp_path and root.name != f"mpmcol-{os.getuid()}"
    assert "is not a folder that only you can write; every command compiles its kernels again" in note


def test_the_note_on_the_cache_is_a_message_of_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mpmcol.simulation.run.CACHE_NOTE", "note: kept elsewhere")
    done = invoke("run", "coarse-channel", *set_options(TINY), "--out", tmp_path / "run", "--max-wall", "0.001s")
    assert done.exit_code == 75 and done.stderr.count("note: kept elsewhere\n") == 1


def test_a_link_to_a_folder_that_does_not_exist_yet(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "disk" / "run")
    done = invoke("sweep", "coarse-channel", "--aspect", "1", "--out", tmp_path / "link", "--engine", "commands")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "disk" / "run").is_dir()


def test_a_run_into_a_link_whose_target_does_not_exist_yet(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "disk" / "run")
    done = invoke("run", "coarse-channel", *set_options(TINY), "--out", tmp_path / "link", "--max-wall", "0.001s")
    assert done.exit_code == 75, done.output
    assert (tmp_path / "disk" / "run" / "result.json").is_file()


def test_plan_does_not_replace_a_file(tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    mine.write_text('extends = "coarse-channel"\n')
    done = invoke("plan", mine, "--accuracy", "20%", "--apply", mine)
    assert done.exit_code == 2 and "exists and is not replaced" in done.output
    assert mine.read_text() == 'extends = "coarse-channel"\n'
