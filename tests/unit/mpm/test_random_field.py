"""Random fields of friction: statistics of the fields against closed forms, and the law of a single point."""

from __future__ import annotations

from math import atan, degrees, pi, radians, tan
from typing import Any

import numpy as np
import pytest
from scipy.stats import kstest, norm

from mpmcol.mpm.constitutive import mohr_coulomb, mohr_coulomb_random
from mpmcol.mpm.constitutive.random_field import gaussian_field, lognormal_variation

HORIZONTAL, VERTICAL = 0.8, 0.2  # m
REALIZATIONS = 1500
ELASTIC = {"density": 1700.0, "youngs_modulus": 10e6, "poissons_ratio": 0.2}
FIELD = {"friction_deg": 33.0, "friction_variation": 0.2, "correlation_length": HORIZONTAL}


def material(**keys: Any) -> mohr_coulomb_random.Material:
    return mohr_coulomb_random.Material(**ELASTIC, **FIELD | keys)


@pytest.fixture(scope="module")
def realizations() -> np.ndarray:
    """Values (realizations, points) at the points of PLACES."""
    return np.array([gaussian_field(PLACES, HORIZONTAL, VERTICAL, seed) for seed in range(REALIZATIONS)])


PLACES = np.array([[0.3, 0.1], [0.5, 0.1], [0.7, 0.1], [1.9, 0.1], [0.3, 0.15], [0.3, 0.2], [0.3, 0.5], [0.5, 0.15]])


def test_the_values_at_a_point_are_normal(realizations: np.ndarray) -> None:
    for values in realizations.T:
        assert kstest(values, norm.cdf).pvalue > 1e-3
    np.testing.assert_allclose(realizations.mean(axis=0), 0.0, atol=4.0 / np.sqrt(REALIZATIONS))
    np.testing.assert_allclose(realizations.var(axis=0), 1.0, atol=4.0 * np.sqrt(2.0 / REALIZATIONS))


def test_two_points_correlate_as_stated(realizations: np.ndarray) -> None:
    """exp(-pi (dx^2 / horizontal^2 + dy^2 / vertical^2)), of which a swap of both lengths would differ by 0.7."""
    d = PLACES - PLACES[0]
    expected = np.exp(-pi * (d[:, 0] ** 2 / HORIZONTAL**2 + d[:, 1] ** 2 / VERTICAL**2))
    found = np.corrcoef(realizations.T)[0]
    np.testing.assert_allclose(found, expected, atol=4.0 / np.sqrt(REALIZATIONS))
    assert expected.min() < 1e-3 and sorted(expected)[-2] > 0.8


def test_the_integral_of_the_correlation_is_the_correlation_length() -> None:
    x = np.linspace(-5.0, 5.0, 20001)
    assert np.trapezoid(np.exp(-pi * x**2 / HORIZONTAL**2), x) == pytest.approx(HORIZONTAL)


def test_a_point_has_its_value_whatever_the_other_points_are() -> None:
    """On every grid, and in 2D as in the plane z = 0 in 3D."""
    fine = np.random.default_rng(0).uniform(0.0, 2.0, (3000, 2))
    coarse, in_space = fine[::7], np.column_stack([fine, np.zeros(len(fine))])
    values = gaussian_field(fine, HORIZONTAL, VERTICAL, 3)
    np.testing.assert_allclose(gaussian_field(coarse, HORIZONTAL, VERTICAL, 3), values[::7], atol=1e-11)
    np.testing.assert_allclose(gaussian_field(in_space, HORIZONTAL, VERTICAL, 3), values, atol=1e-11)
    assert abs(np.corrcoef(gaussian_field(fine, HORIZONTAL, VERTICAL, 4), values)[0, 1]) < 0.9


def test_both_horizontal_directions_have_the_same_length() -> None:
    places = np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2]])
    values = np.array([gaussian_field(places, HORIZONTAL, VERTICAL, seed) for seed in range(REALIZATIONS)])
    expected = np.exp(-pi * (0.2 / HORIZONTAL) ** 2)
    np.testing.assert_allclose(np.corrcoef(values.T)[0, 1:], expected, atol=0.06)


def test_tan_phi_is_lognormal_with_mean_and_variation_of_the_case() -> None:
    field = norm.ppf((np.arange(100_000) + 0.5) / 100_000)
    values = 1.0 + lognormal_variation(field, 0.3)
    assert values.min() > 0.0 and values.mean() == pytest.approx(1.0, abs=1e-4)
    assert values.std() / values.mean() == pytest.approx(0.3, rel=2e-3)
    assert np.log(values).std() == pytest.approx(np.sqrt(np.log(1.09)), rel=1e-3)


def test_points_have_the_statistics_of_their_material() -> None:
    x = np.random.default_rng(0).uniform(0.0, 300.0, (4000, 2))  # points far from each other
    history = material(seed=5).initial_history(x)
    tangents = tan(radians(33.0)) * (1.0 + history[:, 1])
    assert np.all(history[:, 0] == 0.0)
    assert tangents.mean() == pytest.approx(tan(radians(33.0)), rel=0.01)
    assert tangents.std() / tangents.mean() == pytest.approx(0.2, rel=0.05)
    assert np.array_equal(history, material(seed=5).initial_history(x))
    assert not np.array_equal(history, material(seed=6).initial_history(x))


def test_without_variation_all_points_have_the_mean() -> None:
    assert np.all(material(friction_variation=0.0).initial_history(PLACES) == 0.0)


def test_the_vertical_length_is_by_default_the_horizontal_one() -> None:
    """Points that differ by the same distance in both directions then have the same value in two fields of one seed."""
    across = material(correlation_length_vertical=HORIZONTAL).initial_history(PLACES)
    assert np.array_equal(material().initial_history(PLACES), across)
    assert not np.array_equal(material(correlation_length_vertical=VERTICAL).initial_history(PLACES), across)


@pytest.mark.parametrize("variation", [-0.4, 0.0, 0.5])
def test_a_point_yields_as_mohr_coulomb_with_its_friction_angle(variation: float) -> None:
    keys = {"dilatancy_deg": 5.0, "cohesion": 50.0}
    angle = degrees(atan(tan(radians(33.0)) * (1.0 + variation)))
    same = mohr_coulomb.make_params(mohr_coulomb.Material(**ELASTIC, **keys, friction_deg=angle))
    params = mohr_coulomb_random.make_params(material(**keys))
    history, plain = (0.0, variation), (0.0, 0.0)
    assert mohr_coulomb_random.apex(history, params) == pytest.approx(same.apex)
    stresses = -np.sort(np.random.default_rng(0).normal(200.0, 400.0, (200, 3)), axis=1)
    yielded = 0
    for trial in stresses:
        found = mohr_coulomb_random.return_map(*trial, history, params, 1e-5)
        expected = mohr_coulomb.return_map(*trial, plain, same, 1e-5)
        yielded += expected[-1] > 0.0
        assert found[-1] == pytest.approx(expected[-1]) and found[3] == history
        if expected[-1] > 0.0:
            np.testing.assert_allclose(found[:3], expected[:3], rtol=1e-9, atol=1e-7)
            assert found[4] == pytest.approx(expected[4])
    assert 50 < yielded < 200


def test_the_friction_angle_of_points_is_reported_in_degrees() -> None:
    params, history = mohr_coulomb_random.make_params(material()), np.array([[0.0, 0.0], [0.0, -0.25]])
    found = mohr_coulomb_random.friction_angle(np.zeros(2), np.zeros(2), history, params)
    np.testing.assert_allclose(found, [33.0, degrees(atan(0.75 * tan(radians(33.0))))])
