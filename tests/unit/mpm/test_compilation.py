"""What all laws share is compiled by a second process while the stress update is compiled."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
import pytest

from mpmcol.mpm.jit import argument_types, is_compiled
from mpmcol.mpm.kernels import compilation, loop
from mpmcol.mpm.kernels.particle_update import make_update_points
from mpmcol.mpm.kernels.particle_update_split import make_g2p, make_update_stresses
from mpmcol.mpm.settings import Scheme
from mpmcol.mpm.solver import Solver
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


@pytest.fixture
def solver() -> Solver:
    prepared = collapse(DAMPED)
    prepared.prepare()
    return prepared


def overloads(function: Any) -> Any:
    """The compiled versions of a function by the types of their arguments."""
    return getattr(function, "compiled", function).overloads


def shared(solver: Solver) -> tuple[int, Scheme, tuple[Any, ...]]:
    signatures = compilation.shared_signatures(solver.state(), solver.sort_arguments())
    return solver.points.dimension, solver.scheme, signatures


def test_the_types_are_those_with_which_the_functions_are_called(solver: Solver) -> None:
    """Otherwise the second process would compile what is never called."""
    dimension, scheme, signatures = shared(solver)
    move_points, *phases, sort = compilation.shared_functions(dimension, scheme)
    p2g, update_grid, clear = phases
    g2p: Any = make_g2p(dimension, scheme)
    g2p = numba.njit(g2p.function)  # not from the disk cache, which would not compile what it calls

    @numba.njit  # type: ignore[untyped-decorator]
    def grid_step(state: Any, dt: float, pending: Any) -> None:
        rows, grid, spare, contacts, tiles, shares, settings, _, smallest_mass, node_report, report, _, _ = state
        clear(grid, tiles)
        p2g(rows, grid, tiles, shares, settings)
        update_grid(grid, spare.nodes, contacts, tiles, settings, smallest_mass, dt, node_report)
        g2p(rows, grid, tiles, settings, dt, pending, report)

    grid_step.compile(argument_types(solver.state(), solver.dt, np.zeros(0)))
    solver.sort()
    for function, types in zip((move_points, *phases, sort), signatures, strict=True):
        assert types in overloads(function)


@pytest.mark.parametrize(("order", "make"), [("usl", make_update_points), ("musl", make_update_stresses)])
def test_the_stress_update_is_compiled_once(order: str, make: Callable[..., Any]) -> None:
    solver = collapse(DAMPED, scheme=Scheme(stress_order=order))
    solver.prepare()
    laws = solver.bodies[0].law, solver.bodies[1].law
    compiled = overloads(make(2, *laws, solver.scheme))
    types = len(compiled)
    compilation.compile_stress_update(solver.state(), 2, *laws, solver.scheme)
    solver.advance(1.0, max_steps=2)
    assert len(compiled) == types > 0


def test_cached_functions_are_not_compiled_again(solver: Solver, started: list[subprocess.Popen[bytes]]) -> None:
    dimension, scheme, signatures = shared(solver)
    compilation.compile_shared_functions(dimension, scheme, signatures)
    for function, types in zip(compilation.shared_functions(dimension, scheme), signatures, strict=True):
        assert is_compiled(function, types)
        assert not is_compiled(function, types[:1])
    with compilation.shared_functions_compiled_meanwhile(dimension, scheme, signatures):
        pass
    assert started == []


def test_the_second_process_ends_successfully_before_the_loop_is_called(
    solver: Solver, started: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compilation, "is_compiled", lambda function, types: False)
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    with compilation.shared_functions_compiled_meanwhile(*shared(solver)):
        assert [process.returncode for process in started] == [None]
    assert [process.returncode for process in started] == [0]


def test_no_process_is_started_without_a_disk_cache(
    solver: Solver, started: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What it compiles would be lost."""
    monkeypatch.setattr(compilation, "is_compiled", lambda function, types: False)
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    monkeypatch.setattr("os.access", lambda path, mode: False)
    with compilation.shared_functions_compiled_meanwhile(*shared(solver)):
        pass
    assert started == []


def test_without_processes_the_block_runs_all_the_same(solver: Solver, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise PermissionError

    monkeypatch.setattr(compilation, "is_compiled", lambda function, types: False)
    monkeypatch.setattr(subprocess, "Popen", refuse)
    with compilation.shared_functions_compiled_meanwhile(*shared(solver)):
        has_run = True
    assert has_run


def test_the_loop_that_was_prepared_is_the_one_that_steps(solver: Solver) -> None:
    time_loop: Any = loop.make_time_loop(2, solver.bodies[0].law, solver.bodies[1].law, solver.scheme)
    prepared = len(time_loop.signatures)  # with those of other tests, such as of models with walls
    solver.advance(1.0, max_steps=2)
    assert solver.steps == 2
    assert len(time_loop.signatures) == prepared > 0
