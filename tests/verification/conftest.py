"""Verification problems run on one thread: they are too small to gain from more."""

from __future__ import annotations

from collections.abc import Iterator

import numba
import pytest

from mpmcol.mpm.threads import set_threads


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    before = numba.get_num_threads()
    set_threads(1)
    yield
    set_threads(before)
