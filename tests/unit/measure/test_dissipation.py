"""Shares of the released energy from a history."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.measure.dissipation import dissipation, walls_and_transfer

NAMES = ("kinetic", "potential", "elastic", "plastic", "filter", "damping", "walls", "transfer")


def history(stages: list[str], *rows: tuple[float, ...]) -> dict[str, np.ndarray]:
    columns = dict(zip(NAMES, np.array(rows).T, strict=True))
    return {"stage": np.array(stages), **columns}


LOADED = (0.0, 50.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
RELEASED = (0.0, 20.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
MOVING = (4.0, 15.0, 0.5, 1.0, 0.1, 0.3, 0.05, 0.05)
AT_REST = (0.0, 10.0, 0.4, 8.8, 0.2, 1.2, 0.1, 0.3)


def test_shares_are_relative_to_the_energy_since_release() -> None:
    shares = dissipation(
        history(["equilibrate", "release", "collapse", "rest"], LOADED, RELEASED, MOVING, AT_REST), 0.05
    )
    assert shares is not None and shares.released == 10.0
    assert (shares.friction, shares.damping, shares.walls) == pytest.approx((0.88, 0.12, 0.01))
    assert shares.numerical == pytest.approx(0.03 + 0.02 + 0.01) and shares.remaining == pytest.approx(-0.06)
    assert shares.smooth_damping == pytest.approx(2.0 * 0.05 * 4.0 / 10.0)
    assert shares.damping_ratio == pytest.approx(0.12 / 0.04)


def test_without_damping_no_ratio_is_too_high() -> None:
    undamped = (*AT_REST[:5], 0.0, *AT_REST[6:])
    shares = dissipation(history(["release", "collapse", "rest"], RELEASED, MOVING, undamped), 0.0)
    assert shares is not None and shares.damping_ratio == 0.0


@pytest.mark.parametrize("stages", [["equilibrate"], ["release"]])
def test_nothing_is_released_before_the_collapse(stages: list[str]) -> None:
    assert dissipation(history(stages, RELEASED), 0.05) is None


@pytest.mark.parametrize(
    ("walls", "transfer", "together"), [(3.715, -3.595, 0.12), (-0.3, 0.2, -0.1), (0.3, 0.2, None), (0.2, -0.01, None)]
)
def test_shares_that_cancel_are_added(walls: float, transfer: float, together: float | None) -> None:
    assert walls_and_transfer({"walls": walls, "transfer": transfer}) == (together and pytest.approx(together))
