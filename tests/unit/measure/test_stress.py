"""Quality of the stress field: level blocks of known pressure."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.measure import ColumnShape
from mpmcol.measure.stress import StressQuality, stress_quality

H, SIZE, HEIGHT, DENSITY, G = 0.01, 0.005, 0.2, 2000.0, 9.81
FOOT = DENSITY * G * HEIGHT


def block(model: str) -> tuple[np.ndarray, np.ndarray, ColumnShape]:
    """Positions and volumes of a block 0.1 m wide, and its shape."""
    across, up = np.arange(SIZE / 2, 0.1, SIZE), np.arange(SIZE / 2, HEIGHT, SIZE)
    axes = [across, up, across[:6]] if model == "quarter" else [across, up]
    x = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    volume = np.full(len(x), SIZE ** len(axes))
    if model == "axisymmetric":
        volume *= x[:, 0]
    return x, volume, ColumnShape(model, "one-sided", 0.1, HEIGHT, H, DENSITY, SIZE)


def quality(model: str = "plane", noise: float = 0.0, free: float = 0.0) -> StressQuality:
    """Of a geostatic pressure, with alternating noise (Pa), and a share of points without stress."""
    x, volume, shape = block(model)
    pressure = DENSITY * G * (HEIGHT - x[:, 1])
    pressure += noise * np.where(np.round(x[:, 1] / SIZE - 0.5) % 2.0 == 0.0, 1.0, -1.0)
    pressure[np.random.default_rng(1).uniform(size=len(x)) < free] = 0.0
    stress = np.zeros((len(x), 6))
    stress[:, :3] = -pressure[:, None]
    found = stress_quality(x, stress, DENSITY * volume, volume, shape, G)
    assert found is not None
    return found


@pytest.mark.parametrize("model", ["plane", "axisymmetric", "quarter"])
def test_a_geostatic_pressure_is_quiet(model: str) -> None:
    found = quality(model)
    assert found.weight_at_foot == pytest.approx(FOOT, rel=0.5 * SIZE / HEIGHT + 1e-3)
    assert found.stress_free == 0.0
    assert found.pressure_max == pytest.approx(1.0, abs=0.01) and found.pressure_p1 == pytest.approx(0.0, abs=0.02)
    # points count others of their row as above them: up to half a row of at least four
    assert (found.local_pressure_p1, found.local_pressure_p99) == pytest.approx((1.0, 1.0), abs=0.15)
    assert found.scatter == pytest.approx(0.5 * SIZE / HEIGHT, rel=0.05)  # of the gradient within a cell


def test_points_without_stress_are_counted_inside_the_block() -> None:
    found = quality(free=0.3)
    assert found.stress_free == pytest.approx(0.3, abs=0.03)
    assert found.local_pressure_p1 == 0.0 and found.local_pressure_p99 == pytest.approx(1.0, abs=0.15)


def test_noise_appears_in_scatter_and_percentiles() -> None:
    found = quality(noise=3.0 * FOOT)
    assert found.scatter == pytest.approx(3.0, rel=0.02)
    assert found.pressure_p1 < -1.9 and found.pressure_p99 > 3.8


def test_a_thin_layer_has_no_inside() -> None:
    x, volume, shape = block("plane")
    low = x[:, 1] < H
    assert stress_quality(x[low], np.zeros((low.sum(), 6)), DENSITY * volume[low], volume[low], shape, G) is None
