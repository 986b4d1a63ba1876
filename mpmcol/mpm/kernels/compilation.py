"""Compilation by two processes: the sort in a second one, while this one compiles the time loop.

`python -m mpmcol.mpm.kernels.compilation` compiles the sort, which is the same for all models, into the disk cache.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator

import numpy as np

from mpmcol.mpm.grid import allocate_grid
from mpmcol.mpm.jit import CACHE_FOLDER, JIT_DISABLED
from mpmcol.mpm.kernels.sort import sort_buffers, sort_points
from mpmcol.mpm.lanes import RECORD_SIZE


@contextlib.contextmanager
def sort_compiled_meanwhile() -> Iterator[None]:
    """Compile the sort in a second process during the block, if it is not in the disk cache; wait for it at the end.

    It saves a quarter of the time of compilation. Where no process can be started, or with one core, nothing is done,
    and the sort is compiled when it is called.
    """
    with contextlib.ExitStack() as stack:
        if not JIT_DISABLED and not is_sort_cached() and (os.cpu_count() or 1) > 1:
            with contextlib.suppress(OSError):
                process = subprocess.Popen(
                    [sys.executable, "-m", __name__], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
                )
                stack.enter_context(process)
        yield


def is_sort_cached() -> bool:
    """Whether the disk cache holds the machine code of the sort."""
    return any(CACHE_FOLDER.glob(f"*/sort.{sort_points.__name__}*.nbi"))


def compile_sort() -> None:
    """Compile the sort, or load it from the cache, and sort one point."""
    rows, grid = np.zeros(RECORD_SIZE[2]), allocate_grid((0.0, 0.0), 1.0, (8, 8))
    sort_points(rows, RECORD_SIZE[2], grid, *sort_buffers(grid), 0, 1)


if __name__ == "__main__":
    compile_sort()
