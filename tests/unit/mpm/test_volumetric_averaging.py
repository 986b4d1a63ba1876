"""Volume change of a step: determinant or exponential, per point or averaged over a cell."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import WEIGHTLESS, elastic_body
from mpmcol.mpm.constitutive import elastic
from mpmcol.mpm.kernels.stress import make_stress_update
from mpmcol.mpm.kernels.stress_common import exponential
from mpmcol.mpm.kernels.volumetric_averaging import make_volumetric_excess
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


@pytest.mark.parametrize(("d", "components", "shears"), [(2, IN_PLANE, 1), (3, IN_SPACE, 3)])
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
    d: int, components: list[tuple[int, int]], shears: int, gradient: list[list[float]], determinant: float
) -> None:
    """With the exponential, a rotation and an isochoric shear do not change the volume."""
    stress_update, L = make_stress_update(d, elastic), np.array(gradient)
    for exponential_volume, expected in ((False, determinant), (True, np.exp(np.trace(L)))):
        settings = WEIGHTLESS._replace(exponential_volume=exponential_volume)
        _, J, *_ = stress_update(
            (0.0,) * (3 + shears),
            tuple(L[component] for component in components),
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
def test_closed_points_of_a_cell_have_the_same_volumetric_strain(d: int) -> None:
    """The mean is weighted by volume; open points do not contribute, and a cell of open points has no mean."""
    rng, points = np.random.default_rng(2), Points(9, d)
    points.grad_v = rng.normal(size=(9, 3, 3))
    points.V0[:], points.J[:] = rng.uniform(1.0, 2.0, 9), rng.uniform(0.5, 1.0, 9)
    points.opening[[1, 6]] = 1e-3
    cells, out = np.array([3, 3, 3, 5, 0, 0, 7, 8, 8], np.uint8), np.full(8, np.nan)
    make_volumetric_excess(d)(points.rows.reshape(-1), cells, 0, 8, out)
    trace = np.trace(points.grad_v, axis1=1, axis2=2)
    for members in ([0, 2], [3], [4, 5], [7]):  # the last cell extends beyond the end
        V = points.V[members]
        np.testing.assert_allclose(3.0 * out[members], trace[members] - V @ trace[members] / V.sum(), atol=1e-15)
    np.testing.assert_array_equal(out[[1, 6]], 0.0)
