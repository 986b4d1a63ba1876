"""Times of the snapshots of a collapse."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from mpmcol.simulation.stages import Stages


def times_after(now: float, snapshots: int, limit: float, usual: float, times: list[float] | None = None) -> Any:
    run: Any = SimpleNamespace(
        case=SimpleNamespace(output=SimpleNamespace(times=times, snapshots=snapshots)), solver=SimpleNamespace(time=now)
    )
    return Stages._snapshot_times(run, limit, usual)


def test_given_times_that_are_reached_are_left_out() -> None:
    assert list(times_after(0.2, 4, 1.5, 1.0, [0.1, 0.2, 0.7])) == [0.7]


def test_a_long_run_holds_no_list_of_its_snapshots() -> None:
    """A thousand million of them, of which half are written."""
    assert next(times_after(5e4 + 1e-5, 10_000, 1e5, 1.0)) == pytest.approx(5e4 + 1e-4)
