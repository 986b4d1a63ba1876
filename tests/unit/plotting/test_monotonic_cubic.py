"""Monotonic cubic interpolation against the implementation of SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from mpmcol.plotting.monotonic_cubic import monotonic_cubic


@pytest.mark.parametrize("count", [2, 3, 4, 50])
@pytest.mark.parametrize("seed", range(20))
def test_it_is_pchip(count: int, seed: int) -> None:
    """Also with equal neighbours, steps to zero and changes of sign."""
    values = np.random.default_rng(seed).integers(-3, 4, count).astype(float)
    x = np.linspace(0.0, count - 1.0, 8 * (count - 1) + 1)
    np.testing.assert_allclose(monotonic_cubic(values, x), PchipInterpolator(range(count), values)(x), atol=1e-13)
