"""Change of volume in a step: by the determinant or the exponential, of each point or of a cell."""

from __future__ import annotations

from types import ModuleType

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import WEIGHTLESS, elastic_body
from mpmcol.mpm.constitutive import elastic
from mpmcol.mpm.kernels import stress_2d, stress_3d
from mpmcol.mpm.kernels.stress_common import exponential
from mpmcol.mpm.kernels.volumetric_averaging import make_excess
from mpmcol.mpm.particles import Points

BODY = elastic_body()
IN_PLANE = [(0, 0), (0, 1), (1, 0), (1, 1), (2, 2)]
IN_SPACE = [(a, b) for a in range(3) for b in range(3)]


def test_the_exponential() -> None:
    x = np.linspace(-0.1, 0.1, 201)
    np.testing.assert_allclose(exponential(x), np.exp(x), rtol=2e-14)
    assert exponential(0.0) == 1.0
    np.testing.assert_allclose(exponential(x) * exponential(-x), 1.0, rtol=1e-15)
    far = np.array([-9.0, -5.0, -1.0, 1.0])
    assert np.all(exponential(far) > 0.0)
    np.testing.assert_allclose(exponential(far[2:]), np.exp(far[2:]), rtol=2e-6)


@pytest.mark.parametrize(("module", "lanes", "shears"), [(stress_2d, IN_PLANE, 1), (stress_3d, IN_SPACE, 3)])
@pytest.mark.parametrize(
    ("gradient", "determinant"),
    [
        ([[0.0, -0.01, 0.0], [0.01, 0.0, 0.0], [0.0, 0.0, 0.0]], 1.0 + 1e-4),
        ([[0.01, 0.0, 0.0], [0.0, -0.01, 0.0], [0.0, 0.0, 0.0]], 1.0 - 1e-4),
        ([[0.02, 0.01, 0.0], [0.0, 0.03, 0.0], [0.0, 0.0, 0.0]], 1.02 * 1.03),
    ],
    ids=["spin", "shear", "growth"],
)
def test_volume_ratio_of_a_step(
    module: ModuleType, lanes: list[tuple[int, int]], shears: int, gradient: list[list[float]], determinant: float
) -> None:
    """A spin and a shear without change of volume have none with the exponential."""
    formula, L = module.make_formula(elastic), np.array(gradient)
    for exponentially, expected in ((False, determinant), (True, np.exp(np.trace(L)))):
        settings = WEIGHTLESS._replace(exponential_volume=exponentially)
        _, J, *_ = formula(
            (0.0,) * (3 + shears),
            tuple(L[lane] for lane in lanes),
            1.0,
            1.0,
            0.0,
            (0.0, 0.0),
            BODY.params,
            settings,
            1.0,
        )
        assert pytest.approx(expected, rel=1e-14) == J


@pytest.mark.parametrize("d", [2, 3])
def test_closed_points_of_a_cell_swell_alike(d: int) -> None:
    """With the mean weighted by volume; open points count for nothing, and a cell of them has no mean."""
    rng, points = np.random.default_rng(2), Points(9, d)
    points.grad_v = rng.normal(size=(9, 3, 3))
    points.V0[:], points.J[:] = rng.uniform(1.0, 2.0, 9), rng.uniform(0.5, 1.0, 9)
    points.opening[[1, 6]] = 1e-3
    cells, out = np.array([3, 3, 3, 5, 0, 0, 7, 8, 8], np.uint8), np.full(8, np.nan)
    make_excess(d)(points.rows.reshape(-1), cells, 0, 8, out)
    trace = np.trace(points.grad_v, axis1=1, axis2=2)
    for members in ([0, 2], [3], [4, 5], [7]):  # the last cell goes on beyond the end
        V = points.V[members]
        np.testing.assert_allclose(3.0 * out[members], trace[members] - V @ trace[members] / V.sum(), atol=1e-15)
    np.testing.assert_array_equal(out[[1, 6]], 0.0)
