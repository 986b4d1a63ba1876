"""Loops over points contain no calls: reference counting at every point would cost as much as a transfer."""

from __future__ import annotations

import platform
import re
from typing import Any

import numba
import numpy as np
import pytest

from mpmcol.bench.cases import make_solver
from mpmcol.mpm.boundary import column_box
from mpmcol.mpm.grid import grid_shape
from mpmcol.mpm.jit import JIT_DISABLED, argument_types
from mpmcol.mpm.kernels.stress import make_update_stress
from mpmcol.mpm.kernels.transfer import make_move_points, make_scatter_points
from mpmcol.mpm.wall_cells import with_walls

pytestmark = pytest.mark.skipif(
    JIT_DISABLED or platform.machine() not in ("x86_64", "AMD64"), reason="the names of calls are those of x86-64"
)
DIMENSIONS = pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.slow)])


def calls(function: Any, *arguments: Any) -> set[str]:
    """Functions that the machine code of a subroutine calls for these arguments."""
    options: Any = {"error_model": "numpy", "nogil": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    compiled = numba.njit(**options)(function.compiled.py_func)
    compiled.compile(argument_types(*arguments))
    (code,) = compiled.inspect_asm().values()
    body = code.partition(".cfi_endproc")[0]
    return set(re.findall(r"(?:movabsq\s+\$|callq\s+)([a-zA-Z_]\w*)", body))  # not the bits of a constant


@pytest.mark.parametrize("walls", [False, pytest.param(True, marks=pytest.mark.slow)])
@DIMENSIONS
def test_transfers_call_nothing(dimension: int, walls: bool) -> None:
    solver = make_solver("plane" if dimension == 2 else "quarter", 2000)
    state, dt, buffer = solver.state(), 0.1, np.zeros(8)
    cells = np.zeros(np.subtract(grid_shape(state.grid), 1), bool)
    grid = with_walls(state.grid, cells) if walls else state.grid
    arguments = state.rows, 0, 8, 8, grid, state.settings
    assert calls(make_scatter_points(dimension, "quadratic"), *arguments) == set()
    assert calls(make_move_points(dimension, "quadratic", False), *arguments, dt, buffer, buffer) == set()


@pytest.mark.slow
@DIMENSIONS
def test_the_stress_update_calls_nothing(dimension: int) -> None:
    solver = make_solver("plane" if dimension == 2 else "quarter", 2000)
    solver.sort()
    state, column = solver.state(), solver.bodies[0]
    params = column.law.PARAMS(*(float(value) for value in column.params))
    box, cells = column_box(state.grid, state.settings), state.tiles.cells
    update = make_update_stress(dimension, column.law, "point")
    found = calls(update, state.rows, cells, 0, 8, params, state.settings, box, 1.0, 0.1, np.zeros(8), 0.0)
    assert found == set()
