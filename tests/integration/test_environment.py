"""Variables of the caller's environment neither break commands nor are ignored."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.cli import invoke

THREADS = "from mpmcol.mpm.jit import set_threads\nprint(set_threads(None))"


def run(*command: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *command], env={**os.environ, **environment}, capture_output=True, text=True)


@pytest.mark.parametrize("backend", ["module://matplotlib_inline.backend_inline", "nonsense"])
def test_charts_do_not_depend_on_the_backend_of_matplotlib(finished: Path, tmp_path: Path, backend: str) -> None:
    folder = shutil.copytree(finished, tmp_path / "run")
    done = run("-m", "mpmcol", "plot", str(folder), MPLBACKEND=backend)
    assert done.returncode == 0, done.stderr
    assert (folder / "front.png").exists()


@pytest.mark.parametrize(("value", "expected"), [("1", 1), ("3", 3), ("100", 4), ("2,1", 2), ("many", 4), ("", 4)])
def test_threads_are_limited_by_omp_num_threads(value: str, expected: int) -> None:
    done = run("-c", THREADS, OMP_NUM_THREADS=value, NUMBA_NUM_THREADS="4")
    assert done.stdout.strip() == str(expected), done.stderr


def test_a_missing_threading_layer_is_an_error_in_words() -> None:
    done = run("-c", THREADS, NUMBA_THREADING_LAYER="tbb")
    if done.returncode == 0:
        pytest.skip("tbb is installed here")
    assert "NUMBA_THREADING_LAYER = 'tbb' is not available here; remove this variable" in done.stderr


def test_a_link_to_a_folder_that_does_not_exist_yet(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "disk" / "run")
    done = invoke("sweep", "quickstart", "--aspect", "1", "--out", tmp_path / "link", "--engine", "commands")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "disk" / "run").is_dir()


def test_plan_does_not_replace_a_file(tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    mine.write_text('extends = "quickstart"\n')
    done = invoke("plan", mine, "--accuracy", "20%", "--apply", mine)
    assert done.exit_code == 2 and "exists and is not replaced" in done.output
    assert mine.read_text() == 'extends = "quickstart"\n'
