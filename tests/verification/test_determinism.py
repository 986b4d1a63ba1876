"""A collapse is bitwise reproducible for any number of threads and any number of steps per call."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.sand_column import OTHER_SCHEME, state_digest

ROOT = Path(__file__).absolute().parents[2]
IN_ANOTHER_PROCESS = """
from mpmcol.mpm.threads import set_threads
from tests.support.sand_column import OTHER_SCHEME, state_digest
for threads in (1, 2, 4):
    count = set_threads(threads)
    other = state_digest(2, scheme=OTHER_SCHEME)
    print(count, state_digest(2), state_digest(3), other, state_digest(3, margin=1))
"""


def test_results_are_equal_for_1_2_and_4_threads() -> None:
    run = subprocess.run(
        [sys.executable, "-c", IN_ANOTHER_PROCESS],
        cwd=ROOT,
        env=os.environ | {"NUMBA_NUM_THREADS": "4", "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    threads, *digests = zip(*(line.split() for line in run.stdout.splitlines()), strict=True)
    assert threads == ("1", "2", "4")
    here = [state_digest(2), state_digest(3), state_digest(2, scheme=OTHER_SCHEME), state_digest(3, margin=1)]
    assert [set(each) for each in digests] == [{each} for each in here]
    assert len(set(here)) == len(here)


@pytest.mark.parametrize("d", [2, 3])
def test_results_do_not_depend_on_the_steps_per_call(d: int) -> None:
    assert state_digest(d, chunk=1) == state_digest(d, chunk=7) == state_digest(d)


def test_results_of_another_scheme_do_not_depend_on_the_steps_per_call() -> None:
    assert state_digest(2, 7, OTHER_SCHEME) == state_digest(2, scheme=OTHER_SCHEME)
