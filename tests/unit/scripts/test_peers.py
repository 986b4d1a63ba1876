"""Comparison with other codes: choice of the codes, and the code in Warp against the NumPy reference."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mpmcol.bench.report import Spread
from scripts.peers.compare import CODES, NAMES, Row, select, table_line

ROOT = Path(__file__).parents[3]


def test_warp_is_compared_on_one_thread_only() -> None:
    assert select(NAMES, threads=1) == list(CODES)
    assert select(NAMES, threads=2) == [code for code in CODES if code[0] != "warp"]
    assert select(["warp"], threads=1) == [("warp", "f64"), ("warp", "f32")]


def test_warp_alone_on_two_threads_is_refused() -> None:
    command = [sys.executable, "-m", "scripts.peers.compare", "--code", "warp", "--threads", "1", "2"]
    refused = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    assert refused.returncode == 2 and "Warp runs on one thread only" in refused.stderr


def test_a_line_of_the_table_names_the_code() -> None:
    row = Row("plane", 10, 1, "warp", "f32", Spread.of([2.0, 1.0, 4.0]), Spread.of([3.0]), 0.0)
    assert table_line(row) == "| plane | 10 | 1 | Warp | f32 | 2.0 (1.0-4.0) | 3.00 (3.00-3.00) |"


@pytest.mark.slow
@pytest.mark.parametrize("dim", [2, 3])
def test_warp_computes_the_same_as_the_reference(dim: int) -> None:
    pytest.importorskip("taichi")  # scripts.peers.check covers both
    pytest.importorskip("warp")
    from scripts.peers.check import TOLERANCE, differences, random_problem
    from scripts.peers.warp_example import WarpExample

    assert max(differences(WarpExample, random_problem(dim), 3).values()) < TOLERANCE
