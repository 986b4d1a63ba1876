"""Compilation by two processes: one compiles what all laws share, this one meanwhile what depends on the laws.

`python -m mpmcol.mpm.kernels.compilation` compiles G2P, the phases of the nodes and the sort into the disk cache, in
the order in which the other process needs them. It reads dimension, scheme and types of the arguments, pickled, from
its standard input.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.mpm.boundary import Box
from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import CACHE_FOLDER, argument_types, compile_for, is_compiled
from mpmcol.mpm.kernels.grid_update import clear, update_grid
from mpmcol.mpm.kernels.particle_update import make_update_points
from mpmcol.mpm.kernels.particle_update_split import make_update_stresses
from mpmcol.mpm.kernels.sort import sort_points
from mpmcol.mpm.kernels.step import State
from mpmcol.mpm.kernels.stress import make_update_stress
from mpmcol.mpm.kernels.transfer import make_move_points, make_p2g
from mpmcol.mpm.settings import Scheme

PACKAGE_ROOT = str(Path(__file__).parents[3])
Signature = tuple[Any, ...]  # types of the arguments of a compiled function


def shared_functions(dimension: int, scheme: Scheme) -> tuple[Callable[..., Any], ...]:
    """The compiled functions that do not depend on the laws, in the order in which they are needed."""
    move_points = make_move_points(dimension, scheme.basis, scheme.affine)
    return move_points, make_p2g(dimension, scheme.basis), update_grid, clear, sort_points


def shared_signatures(state: State, sort_arguments: Sequence[Any]) -> tuple[Signature, ...]:
    """Types of their arguments in a simulation with this state."""
    rows, grid, spare, contacts, tiles, shares, settings, _, smallest_mass, node_report, _, _, _ = state
    dt, averages = 0.0, np.zeros(0)
    arguments = (
        (rows, 0, 0, 0, grid, settings, dt, averages, averages),
        (rows, grid, tiles, shares, settings),
        (grid, spare.nodes, contacts, tiles, settings, smallest_mass, dt, node_report),
        (grid, tiles),
        sort_arguments,
    )
    return tuple(argument_types(*each) for each in arguments)


@contextlib.contextmanager
def shared_functions_compiled_meanwhile(
    dimension: int, scheme: Scheme, signatures: Sequence[Signature]
) -> Iterator[None]:
    """Compile these functions in a second process during the block, unless they are cached; wait for it at the end.

    Where no process can be started, with one core or without a disk cache nothing is done, and they are compiled when
    they are called.
    """
    functions = shared_functions(dimension, scheme)
    are_compiled = all(is_compiled(function, types) for function, types in zip(functions, signatures, strict=True))
    with contextlib.ExitStack() as stack:
        if not are_compiled and (os.cpu_count() or 1) > 1 and os.access(CACHE_FOLDER, os.W_OK):
            with contextlib.suppress(OSError):
                process = stack.enter_context(_second_process())
                if process.stdin:
                    process.stdin.write(pickle.dumps((dimension, scheme, signatures)))
                    process.stdin.close()
        yield


def _second_process() -> subprocess.Popen[bytes]:
    """Start a process that reads what it is to compile; it imports this package, not one in the present folder."""
    packages = [PACKAGE_ROOT, *filter(None, [os.environ.get("PYTHONPATH")])]
    return subprocess.Popen(
        [sys.executable, "-P", "-m", __name__],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(packages)},
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def compile_shared_functions(dimension: int, scheme: Scheme, signatures: Sequence[Signature]) -> None:
    """Compile these functions, or load them from the cache."""
    for function, types in zip(shared_functions(dimension, scheme), signatures, strict=True):
        compile_for(function, types)


def compile_stress_update(
    state: State, dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> None:
    """Compile the stress update and the phase that contains it, or load them from the cache.

    The stress update first, by when the second process has compiled what the phase needs as well.
    """
    rows, grid, spare, _, tiles, shares, settings, bodies, _, _, report, _, _ = state
    dt, side_rate, has_next, pending = 0.0, 0.0, True, np.zeros(0)
    params, box = column_law.PARAMS(*bodies.column[0]), Box(0.0, 0.0, 0.0, 0.0, 0.0)
    for law, own in ((column_law, params), (base_law, bodies.base)):
        types = argument_types(rows, tiles.cells, 0, 0, own, settings, box, 0.0, dt, pending, side_rate)
        compile_for(make_update_stress(dimension, law, scheme.volumetric_strain), types)
    if scheme.stress_order == "usl":
        update_points = make_update_points(dimension, column_law, base_law, scheme)
        types = argument_types(rows, grid, spare, tiles, shares, settings, *bodies, dt, side_rate, has_next, report)
        compile_for(update_points, types)
    else:
        update_stresses = make_update_stresses(dimension, column_law, base_law, scheme)
        types = argument_types(rows, grid, tiles, settings, *bodies, dt, side_rate, pending, report)
        compile_for(update_stresses, types)


if __name__ == "__main__":
    compile_shared_functions(*pickle.load(sys.stdin.buffer))
