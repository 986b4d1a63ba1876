"""A collapse is the same to the last bit for any number of threads and however its calls are cut."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from mpmcol.failure_modes.toolkit import advance_steps
from mpmcol.mpm.settings import PAPER, Scheme
from tests.verification.test_energy import DAMPED, collapse

ROOT = Path(__file__).absolute().parents[2]
STEPS = 400
IN_ANOTHER_PROCESS = """
from mpmcol.mpm.jit import set_threads
from tests.verification.test_determinism import OTHER, fingerprint
for threads in (1, 2, 4):
    print(set_threads(threads), fingerprint(2), fingerprint(3), fingerprint(2, scheme=OTHER), fingerprint(3, margin=1))
"""
OTHER = Scheme(stress_order="musl", affine=True, basis="cubic", volumetric_strain="cell")


def fingerprint(d: int, chunk: int = STEPS, scheme: Scheme = PAPER, margin: int = 0) -> str:
    """Hash of all points, the clock and the ledger after STEPS steps in d dimensions, `chunk` steps a call."""
    solver = collapse(DAMPED, d, scheme=scheme, margin=margin)
    for done in range(0, STEPS, chunk):
        advance_steps(solver, min(chunk, STEPS - done))
    assert solver.steps == STEPS
    state = hashlib.sha256()
    for array in (solver.points.rows, solver.clock, solver.ledger):
        state.update(array.tobytes())
    return state.hexdigest()


def test_equal_for_1_2_and_4_threads() -> None:
    run = subprocess.run(
        [sys.executable, "-c", IN_ANOTHER_PROCESS],
        cwd=ROOT,
        env=os.environ | {"NUMBA_NUM_THREADS": "4", "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    threads, *prints = zip(*(line.split() for line in run.stdout.splitlines()), strict=True)
    assert threads == ("1", "2", "4")
    here = [fingerprint(2), fingerprint(3), fingerprint(2, scheme=OTHER), fingerprint(3, margin=1)]
    assert [set(each) for each in prints] == [{each} for each in here]
    assert len(set(here)) == len(here)


@pytest.mark.parametrize("d", [2, 3])
def test_equal_however_the_calls_are_cut(d: int) -> None:
    assert fingerprint(d, chunk=1) == fingerprint(d, chunk=7) == fingerprint(d)


def test_so_is_another_scheme() -> None:
    assert fingerprint(2, 7, OTHER) == fingerprint(2, scheme=OTHER)
