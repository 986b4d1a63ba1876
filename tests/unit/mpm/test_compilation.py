"""The sort is compiled by a second process while the time loop is compiled."""

from __future__ import annotations

import subprocess
from typing import Any

import pytest

from mpmcol.mpm.kernels import compilation, loop
from tests.support.sand_column import DAMPED, collapse


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen[bytes]]:
    """The processes that are started."""
    processes: list[subprocess.Popen[bytes]] = []
    popen = subprocess.Popen

    def start(*command: Any, **options: Any) -> subprocess.Popen[bytes]:
        processes.append(popen(*command, **options))
        return processes[-1]

    monkeypatch.setattr(subprocess, "Popen", start)
    return processes


def test_a_cached_sort_is_not_compiled_again(started: list[subprocess.Popen[bytes]]) -> None:
    compilation.compile_sort()
    assert compilation.is_sort_cached()
    with compilation.sort_compiled_meanwhile():
        pass
    assert started == []


def test_the_second_process_ends_successfully_before_the_sort_is_called(
    started: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compilation, "is_sort_cached", lambda: False)
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    with compilation.sort_compiled_meanwhile():
        assert [process.returncode for process in started] == [None]
    assert [process.returncode for process in started] == [0]


def test_without_processes_the_block_runs_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise PermissionError

    monkeypatch.setattr(compilation, "is_sort_cached", lambda: False)
    monkeypatch.setattr(subprocess, "Popen", refuse)
    with compilation.sort_compiled_meanwhile():
        has_run = True
    assert has_run


def test_the_loop_compiled_before_the_sort_is_the_one_that_steps() -> None:
    solver = collapse(DAMPED)
    time_loop: Any = loop.make_time_loop(2, solver.bodies[0].law, solver.bodies[1].law, solver.scheme)
    solver.prepare()
    prepared = len(time_loop.signatures)  # with those of other tests, such as of models with walls
    solver.advance(1.0, max_steps=2)
    assert solver.steps == 2
    assert len(time_loop.signatures) == prepared > 0
