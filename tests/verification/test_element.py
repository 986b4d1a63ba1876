"""Element tests of elasticity and of Mohr-Coulomb: one point with a prescribed velocity gradient."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import K_ACTIVE, NU, PHI, WEIGHTLESS, E, elastic_body, sand_body
from mpmcol.mpm.solver import Body
from tests.support.strain_path import make_path

SHEAR = E / (2.0 * (1.0 + NU))
BULK = E / (3.0 * (1.0 - 2.0 * NU))
both_dimensions = pytest.mark.parametrize("d", [2, 3])


class Driven(NamedTuple):
    """Final stress (xx yy zz xy) and volume ratio of a point."""

    sigma: np.ndarray
    J: float


def driven(d: int, body: Body, strain: np.ndarray, steps: int, sigma: tuple[float, ...] = (0.0,) * 4) -> Driven:
    """A point with initial stress xx yy zz xy, after `steps` steps with a total of dt L = `strain` (2, 2)."""
    (xx, xy), (yx, yy) = strain.tolist()
    gradient = (xx, xy, yx, yy, 0.0) if d == 2 else (xx, xy, 0.0, yx, yy, 0.0, 0.0, 0.0, 0.0)
    start = sigma if d == 2 else (*sigma, 0.0, 0.0)
    end, J = make_path(d, body.law)(start, gradient, body.params, WEIGHTLESS, steps)
    assert all(component == 0.0 for component in end[4:])
    return Driven(np.array(end[:4]), J)


def simple_shear(gamma: float) -> np.ndarray:
    return np.array([[0.0, gamma], [0.0, 0.0]])


@pytest.mark.parametrize("gamma", [0.01, 0.5, 2.0, 6.0])
@both_dimensions
def test_elastic_simple_shear_oscillates_with_the_jaumann_rate(d: int, gamma: float) -> None:
    point = driven(d, elastic_body(), simple_shear(gamma), steps=20_000)
    xx, yy, zz, xy = point.sigma / SHEAR
    error = 1e-3 * gamma
    assert xy == pytest.approx(np.sin(gamma), abs=error)
    assert xx == pytest.approx(1.0 - np.cos(gamma), abs=error)
    assert yy == pytest.approx(-xx, abs=1e-12) and zz == 0.0
    assert point.J == 1.0


@pytest.mark.parametrize("body", [elastic_body(), sand_body()], ids=["elastic", "mohr-coulomb"])
@both_dimensions
def test_rotation_keeps_the_principal_stresses(d: int, body: Body) -> None:
    start = np.array([[-3e4, 4e3], [4e3, -5e4]])
    angle, steps = 1.2, 20_000
    point = driven(d, body, angle * np.array([[0.0, -1.0], [1.0, 0.0]]), steps, (-3e4, -5e4, -4e4, 4e3))
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    xx, yy, zz, xy = point.sigma
    np.testing.assert_allclose([[xx, xy], [xy, yy]], R @ start @ R.T, rtol=2e-4)
    assert zz == -4e4
    # Eq. 29 drifts in rotation, since det(I + dt L) > 1
    assert pytest.approx((1.0 + (angle / steps) ** 2) ** steps, rel=1e-10) == point.J


@both_dimensions
def test_oedometer_stays_at_active_yield(d: int) -> None:
    compressions = [-0.004, -0.005]
    (first, second) = (driven(d, sand_body(), np.diag([0.0, e]), 1000).sigma for e in compressions)
    n_phi = 1.0 / K_ACTIVE
    assert second[0] / second[1] == pytest.approx(0.2948, abs=5e-5)
    assert second[2] / second[1] == pytest.approx(K_ACTIVE, rel=1e-9)
    tangent = (second[1] - first[1]) / (compressions[1] - compressions[0])
    assert tangent == pytest.approx(3.0 * n_phi * BULK / (2.0 + n_phi), rel=1e-9)
    assert tangent == pytest.approx(10.485e6, rel=1e-4)


@pytest.mark.parametrize("ratio", [K_ACTIVE, 0.6, 1.0, 2.5])
@both_dimensions
def test_simple_shear_mobilises_the_sine_of_friction(d: int, ratio: float) -> None:
    """tau / sigma_n = sin(phi) at constant volume with psi = 0, for any initial lateral stress."""
    start = (ratio * -1e3, -1e3, ratio * -1e3, 0.0)
    xx, yy, _, xy = driven(d, sand_body(), simple_shear(0.2), 10_000, start).sigma
    assert xy / -yy == pytest.approx(np.sin(np.radians(PHI)), rel=2e-4)
    assert xy / -yy == pytest.approx(0.5446, rel=3e-4)
    assert xx == pytest.approx(yy, rel=1e-3)


@both_dimensions
def test_a_wrong_friction_angle_is_detected(d: int) -> None:
    weak = driven(d, sand_body(friction_deg=30.0), simple_shear(0.2), 10_000, (-1e3, -1e3, -1e3, 0.0)).sigma
    assert abs(weak[3] / -weak[1] - 0.5446) > 0.04
