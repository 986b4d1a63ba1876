"""The tiles of each thread are those of the present order of the points and number of threads."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.bench.cases import make_solver
from mpmcol.mpm import solver as module
from mpmcol.mpm.grid import share_tiles


def test_shares_follow_the_sort_and_the_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    solver = make_solver("plane", 2000)
    for threads, moves in ((1, False), (3, False), (3, True), (2, True)):
        if moves:
            solver.points.x[:, 0] += 4.0 * solver.grid.h
        solver.sort()
        monkeypatch.setattr(module, "threads_in_use", lambda threads=threads: threads)
        assert solver.tiles is not None
        expected = share_tiles(solver.tiles, threads)
        assert np.array_equal(solver.state().shares, expected) and expected.shape[1] == threads + 1
        assert solver.state().shares is solver.state().shares  # computed once
