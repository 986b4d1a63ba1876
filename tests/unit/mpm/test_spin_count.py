"""Threads wait long on an idle machine only, whatever ran there before."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from mpmcol.mpm import spin_count as module
from mpmcol.mpm.spin_count import LONG, SHORT, spin_count


class Load:
    """/proc/loadavg at successive times: the load average is that of a busy minute, other threads run as given."""

    def __init__(self, *others: int) -> None:
        self._others: Iterator[int] = iter(others)

    def read_text(self, encoding: str) -> str:
        return f"8.00 8.00 8.00 {next(self._others) + 1}/200 4711\n"


@pytest.mark.parametrize(
    ("others", "cores", "expected"),
    [
        ((0, 0, 0), 2, LONG),
        ((1, 1, 1), 2, SHORT),
        ((2, 0, 1), 2, LONG),  # one that runs for a moment only
        ((4, 5, 4), 16, LONG),
        ((9, 9, 9), 16, SHORT),
    ],
)
def test_threads_that_run_at_present_decide(
    monkeypatch: pytest.MonkeyPatch, others: tuple[int, ...], cores: int, expected: int
) -> None:
    monkeypatch.setattr(module, "_LOAD", Load(*others))
    monkeypatch.setattr(os, "cpu_count", lambda: cores)
    assert spin_count() == expected


@pytest.mark.parametrize(
    ("load", "cores", "expected"), [(0.0, 2, LONG), (0.9, 2, SHORT), (3.9, 16, LONG), (9.0, 16, SHORT)]
)
@pytest.mark.parametrize("content", [None, "", "0.0 0.0 0.0 ?"])
def test_the_load_average_decides_where_the_system_tells_no_more(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, content: str | None, load: float, cores: int, expected: int
) -> None:
    if content is not None:
        (tmp_path / "loadavg").write_text(content)
    monkeypatch.setattr(module, "_LOAD", tmp_path / "loadavg")
    monkeypatch.setattr(os, "getloadavg", lambda: (load, 0.0, 0.0))
    monkeypatch.setattr(os, "cpu_count", lambda: cores)
    assert spin_count() == expected
