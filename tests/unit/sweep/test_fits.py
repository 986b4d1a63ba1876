"""Power-law fits and their uncertainty."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from mpmcol.experiments import find_experiment
from mpmcol.sweep.fits import fit_power, fit_slopes, student_t, write_slopes

CYLINDER = find_experiment("paper", "axisymmetric")


def test_a_power_law_is_recovered() -> None:
    x = np.array([0.5, 1.0, 2.0, 7.0])
    fit = fit_power(x, 1.6 * x**0.5)
    assert (fit.prefactor, fit.exponent) == pytest.approx((1.6, 0.5))
    assert fit.standard_error == pytest.approx(0.0, abs=1e-12)


def test_a_fit_of_two_points_has_no_uncertainty() -> None:
    fit = fit_power([1.0, 2.0], [3.0, 12.0])
    assert (fit.exponent, fit.standard_error, fit.half_width) == (pytest.approx(2.0), None, None)


@pytest.mark.parametrize(
    ("freedom", "quantile"), [(1, 12.7062), (2, 4.30265), (5, 2.57058), (10, 2.22814), (100, 1.98397)]
)
def test_quantiles_of_students_distribution(freedom: int, quantile: float) -> None:
    assert student_t(freedom) == pytest.approx(quantile, rel=2e-6)  # printed tables


def test_quantiles_with_one_and_two_degrees_of_freedom_have_closed_forms() -> None:
    p = 0.95
    assert student_t(1) == pytest.approx(np.tan(np.pi * p / 2.0), rel=1e-13)
    assert student_t(2) == pytest.approx(p * np.sqrt(2.0 / (1.0 - p**2)), rel=1e-13)


def test_standard_error_is_that_of_least_squares() -> None:
    x, y = np.array([1.0, 1.5, 2.0, 3.0, 5.0]), np.array([1.1, 1.3, 1.9, 2.4, 3.0])
    exponents, covariance = np.polyfit(np.log(x), np.log(y), 1, cov="unscaled")
    residual = np.log(y) - np.polyval(exponents, np.log(x))
    fit = fit_power(x, y)
    assert fit.exponent == pytest.approx(exponents[0])
    assert fit.standard_error == pytest.approx(np.sqrt(covariance[0, 0] * np.sum(residual**2) / 3.0))
    assert fit.half_width == pytest.approx(3.18245 * fit.standard_error, rel=1e-4)


def test_the_interval_contains_the_true_exponent_in_95_per_cent_of_samples() -> None:
    generator, x = np.random.default_rng(1), np.geomspace(0.5, 7.0, 5)
    fits = [fit_power(x, x**0.7 * np.exp(0.05 * generator.normal(size=5))) for _ in range(1000)]
    assert np.mean([abs(fit.exponent - 0.7) < fit.half_width for fit in fits]) == pytest.approx(0.95, abs=0.025)


def make_row(a: float, **values: float | bool) -> dict:
    zeta = 1.24 * a if a < 1.7 else 1.6 * a**0.5
    fronts = {f"zeta.{name}": zeta for name in ("front_max", "front_connected", "front_height")}
    return {"a": a, "at_rest": True, "beta": 1.0 if a < 1.0 else 0.88 * a ** (-5 / 6), **fronts, **values}


def test_each_side_of_the_transition_is_fitted_separately() -> None:
    slopes = fit_slopes([make_row(a) for a in (0.5, 0.9, 1.2, 1.5, 2.0, 3.0, 5.0)], CYLINDER)
    found = {(s.quantity, s.lo, s.hi): (s.count, round(s.exponent, 6), s.law_exponent) for s in slopes}
    assert found["zeta.front_max", 0.2, 1.7] == (4, 1.0, 1.0)
    assert found["zeta.front_height", 1.7, 35.0] == (3, 0.5, 0.5)
    assert found["beta", 0.2, 1.0] == (2, 0.0, 0.0)
    assert found["beta", 1.7, 10.0][:2] == (3, round(-5 / 6, 6))
    assert len(found) == 8  # a = 1.2 and 1.5 are in the transition of beta


def test_rows_that_cannot_be_fitted_are_excluded() -> None:
    moving = make_row(3.0, at_rest=False)
    failed = {"a": 4.0, "at_rest": None, "beta": None}
    flat = make_row(2.5, **{"zeta.front_max": 0.0})
    slopes = {
        slope.quantity: slope for slope in fit_slopes([make_row(2.0), moving, failed, flat, make_row(5.0)], CYLINDER)
    }
    assert slopes["zeta.front_max"].count == 2 and slopes["zeta.front_height"].count == 3
    assert fit_slopes([make_row(2.0)], CYLINDER) == []
    assert fit_slopes([make_row(2.0), make_row(2.0)], CYLINDER) == []


def test_without_a_law_all_runs_are_fitted_together() -> None:
    box = find_experiment("paper", "quarter", "box")
    slopes = fit_slopes([make_row(a) for a in (2.0, 3.0, 5.0)], box, "friction_deg = 30")
    assert {(slope.lo, slope.hi, slope.law_exponent, slope.series) for slope in slopes} == {
        (0.0, np.inf, None, "friction_deg = 30")
    }
    assert str(slopes[0]) == "zeta.front_max ~ a^0.50 +- 0.00 (3 runs in 0 <= a < inf)"


def test_slopes_are_written(tmp_path: Path) -> None:
    slopes = fit_slopes([make_row(a) for a in (2.0, 3.0)], CYLINDER)
    with write_slopes(tmp_path, slopes).open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["quantity"] for row in rows] == [slope.quantity for slope in slopes]
    assert float(rows[0]["exponent"]) == slopes[0].exponent and rows[0]["half_width"] == ""
