"""One point driven by a given velocity gradient: the element tests of elasticity and of Mohr-Coulomb."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.kernels.stress_2d import make_update_stress
from mpmcol.solver import Body
from mpmcol.state import Points
from tests.verification.blocks import K_ACTIVE, NU, PHI, WEIGHTLESS, E, elastic_body, sand_body

SHEAR = E / (2.0 * (1.0 + NU))
BULK = E / (3.0 * (1.0 - 2.0 * NU))


def driven(body: Body, strain: np.ndarray, steps: int, sigma: tuple[float, ...] = (0.0,) * 4) -> Points:
    """A point that starts with stress xx yy zz xy, after steps that add up to dt L = `strain` (2, 2)."""
    update = make_update_stress(body.law)
    point = Points(1)
    point.V0[:] = 1.0
    point.sigma = np.array([sigma])
    point.grad_v = np.pad(strain, (0, 1))[None]
    for _ in range(steps):
        update(point.rows[0], 0, body.params, WEIGHTLESS, 1.0 / steps)
    return point


def simple_shear(gamma: float) -> np.ndarray:
    return np.array([[0.0, gamma], [0.0, 0.0]])


@pytest.mark.parametrize("gamma", [0.01, 0.5, 2.0, 6.0])
def test_elastic_simple_shear_oscillates_as_jaumann_says(gamma: float) -> None:
    point = driven(elastic_body(), simple_shear(gamma), steps=20_000)
    xx, yy, zz, xy = point.sigma[0, :4] / SHEAR
    error = 1e-3 * gamma
    assert xy == pytest.approx(np.sin(gamma), abs=error)
    assert xx == pytest.approx(1.0 - np.cos(gamma), abs=error)
    assert yy == pytest.approx(-xx, abs=1e-12) and zz == 0.0
    assert point.J[0] == 1.0


@pytest.mark.parametrize("body", [elastic_body(), sand_body()], ids=["elastic", "mohr-coulomb"])
def test_a_stressed_point_that_turns_keeps_its_principal_stresses(body: Body) -> None:
    start = np.array([[-3e4, 4e3], [4e3, -5e4]])
    angle, steps = 1.2, 20_000
    point = driven(body, angle * np.array([[0.0, -1.0], [1.0, 0.0]]), steps, (-3e4, -5e4, -4e4, 4e3))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    xx, yy, zz, xy = point.sigma[0, :4]
    np.testing.assert_allclose([[xx, xy], [xy, yy]], turn @ start @ turn.T, rtol=2e-4)
    assert zz == -4e4
    # det(I + dt L) of a rotation is not 1: the known drift of Eq. 29
    assert point.J[0] == pytest.approx((1.0 + (angle / steps) ** 2) ** steps, rel=1e-10)


def test_oedometer_stays_at_active_yield() -> None:
    compressions = [-0.004, -0.005]
    (first, second) = (driven(sand_body(), np.diag([0.0, e]), 1000).sigma[0] for e in compressions)
    n_phi = 1.0 / K_ACTIVE
    assert second[0] / second[1] == pytest.approx(0.2948, abs=5e-5)
    assert second[2] / second[1] == pytest.approx(K_ACTIVE, rel=1e-9)
    tangent = (second[1] - first[1]) / (compressions[1] - compressions[0])
    assert tangent == pytest.approx(3.0 * n_phi * BULK / (2.0 + n_phi), rel=1e-9)
    assert tangent == pytest.approx(10.485e6, rel=1e-4)


@pytest.mark.parametrize("ratio", [K_ACTIVE, 0.6, 1.0, 2.5])
def test_simple_shear_mobilises_the_sine_of_friction(ratio: float) -> None:
    """tau / sigma_n = sin(phi) at constant volume with psi = 0, whatever the lateral stress was."""
    start = (ratio * -1e3, -1e3, ratio * -1e3, 0.0)
    xx, yy, _, xy = driven(sand_body(), simple_shear(0.2), 10_000, start).sigma[0, :4]
    assert xy / -yy == pytest.approx(np.sin(np.radians(PHI)), rel=2e-4)
    assert xy / -yy == pytest.approx(0.5446, rel=3e-4)
    assert xx == pytest.approx(yy, rel=1e-3)


def test_a_wrong_friction_angle_is_noticed() -> None:
    weak = driven(sand_body(friction_deg=30.0), simple_shear(0.2), 10_000, (-1e3, -1e3, -1e3, 0.0)).sigma[0]
    assert abs(weak[3] / -weak[1] - 0.5446) > 0.04
