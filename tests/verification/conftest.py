"""Verification problems are small: one thread is faster than two."""

from __future__ import annotations

from collections.abc import Iterator

import numba
import pytest

from mpmcol.mpm.jit import set_threads


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    before = numba.get_num_threads()
    set_threads(1)
    yield
    set_threads(before)
