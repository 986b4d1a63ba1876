"""Grid-converged values: extrapolation of single and of repeated runs, with standard errors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from mpmcol.studies.convergence import ConvergedValue, combine, converged_value, first_order_value


def test_a_line_is_extrapolated_exactly() -> None:
    converged = first_order_value([3.0, 2.0, 1.0], [1.0 + 0.1 * h for h in (3.0, 2.0, 1.0)])
    assert converged is not None
    assert converged.value == pytest.approx(1.0, rel=1e-12) and converged.error == pytest.approx(0.0, abs=1e-7)


def test_the_error_of_a_first_order_value_is_that_of_the_scatter() -> None:
    """The values of many series with normal noise scatter as their standard errors state on average."""
    rng, h = np.random.default_rng(1), [3.0, 2.5, 2.0, 1.5, 1.0]
    converged = [first_order_value(h, 2.0 + 0.1 * np.array(h) + 0.05 * rng.normal(size=5)) for _ in range(4000)]
    values = np.array([one.value for one in converged if one])
    variances = np.array([one.error**2 for one in converged if one])
    assert values.mean() == pytest.approx(2.0, abs=0.005)
    assert np.sqrt(variances.mean()) == pytest.approx(values.std(), rel=0.05)


def test_coarse_grids_are_left_out() -> None:
    converged = first_order_value([10.0, 3.0, 2.0, 1.0], [0.0, 1.3, 1.2, 1.1])
    assert converged is not None and converged.value == pytest.approx(1.0, rel=1e-12)


def test_two_spacings_are_not_extrapolated() -> None:
    assert first_order_value([2.0, 1.0], [1.0, 1.1]) is None
    assert first_order_value([2.0, 2.0, 1.0], [1.0, 1.0, 1.1]) is None
    assert first_order_value([], []) is None


def as_runs(levels: Mapping[float, np.ndarray]) -> tuple[list[float], list[float]]:
    """Spacing and value of each run."""
    return [h for h, values in levels.items() for _ in values], [float(one) for own in levels.values() for one in own]


def test_a_power_law_is_found_with_its_order() -> None:
    rng = np.random.default_rng(1)
    for order in (0.7, 1.0, 1.8):
        levels = {h: 1.2 - 0.4 * h**order + 1e-4 * rng.standard_normal(4) for h in (1.0, 0.7, 0.5, 0.35)}
        converged = converged_value(*as_runs(levels))
        assert converged is not None and abs(converged.order - order) < 0.1
        assert abs(converged.value - 1.2) < 3.0 * converged.error + 1e-3 and converged.error < 0.02


def test_the_stated_error_covers_scatter_and_misfit() -> None:
    """With noise, the true value is within two standard errors in at least 90 % of refinements."""
    rng = np.random.default_rng(2)
    inside = 0
    for _ in range(200):
        h = np.array([1.0, 0.95, 0.7, 0.68, 0.5, 0.49, 0.35, 0.345])
        converged = converged_value(h.tolist(), (1.0 - 0.3 * h + 0.02 * h * rng.standard_normal(8)).tolist())
        assert converged is not None
        inside += abs(converged.value - 1.0) < 2.0 * converged.error
    assert inside > 180
    misfit = converged_value([1.0, 0.7, 0.5, 0.35], [0.8, 1.0, 0.9, 1.0])
    assert misfit is not None and misfit.error > 0.05


def test_the_observed_order_needs_spacings_and_runs() -> None:
    assert converged_value([1.0, 1.0, 0.5, 0.5], [1.0, 1.1, 1.0, 1.2]) is None
    assert converged_value([1.0, 0.5, 0.4], [1.0, 1.1, 1.2]) is None
    assert converged_value([], []) is None
    near = converged_value([10.0, 1.0, 0.7, 0.6, 0.5], [5.0, 1.0, 1.01, 1.0, 1.01])
    assert near is not None and abs(near.value - 1.005) < 0.02  # the coarsest spacing is left out


def test_exact_runs_have_no_error() -> None:
    exact = converged_value([1.0, 0.8, 0.6, 0.5], [2.0, 1.8, 1.6, 1.5])
    assert exact is not None and exact.value == pytest.approx(1.0, abs=1e-9) and exact.error < 1e-9


def test_the_weighted_fit_is_that_of_the_normal_equations() -> None:
    """With one candidate order the result is the least-squares line with the weights 1 / h^2, written out here."""
    h, q = np.array([0.5, 0.5, 0.7, 0.75, 1.0]), np.array([0.93, 0.91, 0.88, 0.9, 0.8])
    matrix, weights = np.stack((np.ones(5), h), axis=1), h**-2.0
    normal = matrix.T @ (weights[:, None] * matrix)
    expected = np.linalg.solve(normal, matrix.T @ (weights * q))
    variance = np.sum(weights * (q - matrix @ expected) ** 2) / 3 * np.linalg.inv(normal)[0, 0]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mpmcol.studies.convergence.ORDERS", np.array([1.0]))
        converged = converged_value(h.tolist(), q.tolist())
    assert converged is not None and converged.value == pytest.approx(expected[0], rel=1e-12)
    assert converged.error == pytest.approx(np.sqrt(variance), rel=1e-9)


def test_two_values_that_disagree_have_an_error_of_half_their_difference() -> None:
    both = combine([ConvergedValue(1.0, 0.01, 1.0), ConvergedValue(1.2, 0.01, 1.0)])
    assert both.value == pytest.approx(1.1) and both.error == pytest.approx(0.1)
    agreeing = combine([ConvergedValue(1.0, 0.01, 1.0), ConvergedValue(1.0, 0.03, 1.0)])
    assert agreeing.error == pytest.approx(0.01 * np.sqrt(0.9))


def test_several_values_that_disagree_have_an_error_of_half_their_range() -> None:
    values = (1.0, 1.2, 1.1, 1.4)
    several = combine([ConvergedValue(value, 0.01, 1.0) for value in values])
    assert several.value == pytest.approx(np.mean(values)) and several.error == pytest.approx(0.2)


def test_values_without_error_are_averaged() -> None:
    exact = combine([ConvergedValue(1.0, 0.0, 1.0), ConvergedValue(1.0, 0.0, 2.0)])
    assert exact.value == pytest.approx(1.0) and exact.error < 1e-8 and exact.order == pytest.approx(1.5)
