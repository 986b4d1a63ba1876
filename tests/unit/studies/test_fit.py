"""Fits: response surface, least squares, precision and remarks against closed forms, without runs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import ANY

import numpy as np
import pytest

from mpmcol.api.fits import default_folder
from mpmcol.errors import CaseError, UsageError
from mpmcol.measure import Measurement
from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.fit import Fit, plan_fit, require_enough
from mpmcol.studies.fit.agreement import agreement_of, largest_misfit
from mpmcol.studies.fit.course import course_of
from mpmcol.studies.fit.forward import Evaluation, values_of
from mpmcol.studies.fit.identify import remarks
from mpmcol.studies.fit.levels import Level, StudiedGrid, levels_for
from mpmcol.studies.fit.quantities import (
    ASSUMED_ERROR,
    FRONT,
    GridErrors,
    GridFactors,
    Target,
    grid_covariance,
    parse_targets,
    read_profile,
    targets_of,
)
from mpmcol.studies.fit.response import best_point, corrected, design, fit_surface, misfit, pooled_variance, precision
from mpmcol.studies.fit.search import MOST_STEPS, Search, Solution
from mpmcol.studies.fit.unknowns import Unknown, parse_unknowns, settings
from mpmcol.studies.fit.values import FittedValue, fitted_values
from mpmcol.studies.pareto.error_interval import ErrorInterval
from mpmcol.studies.pareto.score import BETA, ZETA

FRICTION, FLOOR = Unknown("material.friction_deg", 20.0, 40.0), Unknown("friction.floor", 0.1, 0.5)
COARSE = Level("level1", (), 10.0, "")


def symmetric(error: float) -> ErrorInterval:
    """An interval that leads to a standard error of this size, and to no correction."""
    return ErrorInterval(1.0 / (1.0 + NORMAL_90 * error) - 1.0, 1.0 / (1.0 - NORMAL_90 * error) - 1.0)


FINE = Level(
    "level2", ("grid.spacing=0.001",), 40.0, "",
    StudiedGrid("light", {ZETA: 0.1, BETA: 0.05}, {ZETA: symmetric(0.02), BETA: symmetric(0.01)}),
)  # fmt: skip


def deposit(zeta: float, beta: float, repose: float = 20.0) -> Measurement:
    """A triangular deposit of a column with r_i = h_i = 1 m."""
    front = 1.0 + zeta
    x = np.arange(0.05, 1.1 * front, 0.1)
    return Measurement(
        front={FRONT: front}, zeta={FRONT: zeta}, spread=0.0, height=beta, beta=beta, area_factor=0.5,
        repose_angle_deg=repose, undisturbed_radius=0.3,
        profile_x=x, profile_y=np.maximum(beta * (1.0 - x / front), 0.0),
    )  # fmt: skip


class Synthetic:
    """Takes the place of runs: zeta and beta by a formula of the unknowns, with a shift on the coarse grid."""

    repeats = 2
    at_rest = True

    def __init__(
        self, unknowns: Sequence[Unknown], targets: Sequence[Target], formula: Callable[..., tuple[float, ...]],
        scatter: float = 0.0, course: Callable[..., dict[str, float]] = lambda *values: {},
    ) -> None:  # fmt: skip
        self.unknowns, self.targets, self.formula, self.scatter = tuple(unknowns), tuple(targets), formula, scatter
        self.course = course
        self.calls: list[str] = []

    def evaluate(self, level: Level, shares: Sequence[np.ndarray]) -> list[Evaluation]:
        return [self._evaluation(level, one) for one in shares]

    def _evaluation(self, level: Level, shares: np.ndarray) -> Evaluation:
        self.calls.append(level.name)
        values = [one.at(float(share)) for one, share in zip(self.unknowns, shares, strict=True)]
        shift = 0.85 if level.cells == COARSE.cells else 1.0
        zeta, *others = self.formula(*values)
        deposits = tuple(
            deposit(shift * zeta * (1.0 + sign * self.scatter), *others)
            for sign in np.linspace(-1.0, 1.0, self.repeats)
        )
        course = self.course(*values)
        folders, courses = (Path("a"), Path("b")), (course,) * len(deposits)
        found = values_of(self.targets, deposits, courses, level.factors)
        return Evaluation(level, shares, found, deposits, folders, self.at_rest, 1.0, courses)


def runout_of(friction: float) -> tuple[float, float]:
    """Zeta and beta of a column, monotone and curved."""
    return 1.8 * np.exp(-0.04 * (friction - 20.0)), 0.4 + 0.02 * (friction - 20.0)


def solve(forward: Any, levels: Sequence[Level] = (COARSE,)) -> Solution:
    search = Search(forward, lambda line: None)
    shares = search.begin(levels[0])
    for level in levels:
        solution = search.run(level, shares)
        shares = solution.shares
    return solution


def test_a_surface_has_the_values_and_slopes_of_a_quadratic_function() -> None:
    u = design(2)
    y = np.column_stack((1.0 + 2.0 * u[:, 0] + 3.0 * u[:, 0] ** 2 - u[:, 1], u[:, 1] ** 2))
    surface, at = fit_surface(u, y, np.array([0.2, 0.7])), np.array([0.3, 0.6])
    assert surface.value(at) == pytest.approx([1.0 + 0.6 + 0.27 - 0.6, 0.36])
    assert surface.gradient(at) == pytest.approx(np.array([[2.0 + 1.8, -1.0], [0.0, 1.2]]))


def test_a_surface_is_shifted_by_one_point_and_turned_by_several() -> None:
    u = design(1)
    surface, centre = fit_surface(u, 2.0 * u, np.array([0.5])), np.array([0.5])
    shifted, weight = corrected(surface, np.array([[0.5]]), np.array([[1.3]]), np.array([1e-8]), centre)
    assert shifted.value(centre) == pytest.approx([1.3]) and weight == pytest.approx(1.0)
    assert shifted.gradient(centre) == pytest.approx(np.array([[2.0]]))
    points = np.array([[0.4], [0.6]])
    turned, _ = corrected(surface, points, 1.0 + 3.0 * points, np.array([1e-10]), centre)
    assert turned.gradient(centre) == pytest.approx(np.array([[3.0]]), rel=1e-4)
    noisy, _ = corrected(surface, points, 1.0 + 3.0 * points, np.array([1e6]), centre)
    assert noisy.gradient(centre) == pytest.approx(np.array([[2.0]]), rel=1e-4)  # less than the scatter of the values


def test_the_best_point_lies_in_the_ranges() -> None:
    u = design(1)
    surface = fit_surface(u, 2.0 * u, np.array([0.5]))
    inside = best_point(surface, np.array([0.9]), np.array([0.5]), np.eye(1))
    beyond = best_point(surface, np.array([0.9]), np.array([5.0]), np.eye(1))
    assert inside == pytest.approx([0.25], abs=1e-6) and beyond == pytest.approx([1.0], abs=1e-6)


def test_standard_errors_are_those_of_linear_least_squares() -> None:
    """Two independent measurements of one unknown, with slopes 2 and 1: weights are inverse variances."""
    gradient = np.array([[2.0], [1.0]])
    causes = {"measurement": np.diag([0.04, 0.0]), "scatter": np.diag([0.0, 0.01])}
    found = precision(gradient, causes)
    assert found is not None
    assert found.errors == pytest.approx([(4.0 / 0.04 + 1.0 / 0.01) ** -0.5])
    assert np.hypot(found.part("measurement"), found.part("scatter")) == pytest.approx(found.errors)


def test_unknowns_that_act_alike_are_not_determined() -> None:
    assert precision(np.array([[1.0, 2.0], [2.0, 4.0]]), {"scatter": np.eye(2)}) is None
    assert precision(np.array([[0.0]]), {"scatter": np.eye(1)}) is None


def test_pooled_variance_and_misfit_by_hand() -> None:
    assert pooled_variance([np.array([[1.0], [3.0]]), np.array([[5.0], [5.0]])]) == pytest.approx([1.0])
    assert misfit(np.array([2.0, 0.0]), np.diag([4.0, 1.0])) == pytest.approx(1.0)


@pytest.mark.parametrize("friction", [21.5, 28.5, 33.0, 39.0])
def test_one_unknown_is_recovered(friction: float) -> None:
    zeta, beta = runout_of(friction)
    forward = Synthetic([FRICTION], targets_of({"zeta": (zeta, 1e-3), "beta": (beta, 1e-3)}), runout_of)
    found = solve(forward, [COARSE, FINE])
    assert FRICTION.at(found.shares[0]) == pytest.approx(friction, abs=0.1)
    assert forward.calls.count("level2") <= 3  # the surface of the coarse grid needs a correction only


def test_a_coarse_grid_alone_gives_another_value() -> None:
    """So the correction by the finer grid is what makes the value right."""
    zeta, _ = runout_of(30.0)
    forward = Synthetic([FRICTION], targets_of({"zeta": (zeta, 1e-3)}), runout_of)
    assert FRICTION.at(solve(forward).shares[0]) == pytest.approx(30.0 + np.log(0.85) / 0.04, abs=0.2)


def test_two_unknowns_are_recovered_with_their_correlation() -> None:
    def formula(friction: float, floor: float) -> tuple[float, float]:
        return 1.8 - 0.03 * (friction - 20.0) - 0.8 * floor, 0.4 + 0.02 * (friction - 20.0) + 0.1 * floor

    measured = dict(zip(("zeta", "beta"), ((value, 0.01) for value in formula(27.0, 0.35)), strict=True))
    forward = Synthetic([FRICTION, FLOOR], targets_of(measured), formula)
    found = solve(forward, [COARSE, FINE])
    assert [one.at(float(u)) for one, u in zip(forward.unknowns, found.shares, strict=True)] == [
        pytest.approx(27.0, abs=0.1), pytest.approx(0.35, abs=0.01),
    ]  # fmt: skip
    assert found.precision is not None
    slopes = found.surface.gradient(found.shares)
    by_hand = np.linalg.inv(slopes.T @ np.linalg.inv(sum(found.causes.values())) @ slopes)
    assert found.precision.covariance == pytest.approx(by_hand)


def test_the_standard_error_covers_the_scatter_of_the_runs() -> None:
    zeta, _ = runout_of(30.0)
    quiet, noisy = (
        solve(Synthetic([FRICTION], targets_of({"zeta": (zeta, 1e-3)}), runout_of, scatter), [COARSE, FINE])
        for scatter in (0.005, 0.05)
    )
    assert quiet.precision is not None and noisy.precision is not None
    assert noisy.precision.part("scatter")[0] > 5.0 * quiet.precision.part("scatter")[0]


def remarks_of(forward: Any) -> str:
    return "\n".join(remarks(forward.unknowns, forward.targets, solve(forward)))


def fitted(forward: Any, solution: Solution) -> list[FittedValue]:
    return fitted_values(Fit("channel", (), forward.unknowns, forward.targets, solution, Path()))


def slope(friction: float) -> tuple[float, float]:
    """Zeta falls by 0.05, beta rises by 0.01 per degree."""
    return 1.5 - 0.05 * (friction - 20.0), 0.5 + 0.01 * (friction - 20.0)


def test_measurements_that_no_value_reproduces_have_no_standard_error() -> None:
    """At the end of the range zeta is 0.5 instead of 0.4 +- 0.01: 9 standard errors with a scatter of 0.5 % per run."""
    forward = Synthetic([FRICTION], targets_of({"zeta": (0.4, 0.01)}), slope)
    solution = solve(forward, [FINE])
    agreement = agreement_of(forward.targets, solution)
    assert (agreement.freedom, agreement.is_reproduced, agreement.has_errors) == (1, False, False)
    (compared,) = agreement.comparisons
    total = np.sqrt(sum(solution.causes.values())[0, 0])
    assert compared.differences == pytest.approx([0.1 / total], rel=1e-3) and total > 0.01
    (value,) = fitted(forward, solution)
    assert (value.error, value.interval, value.end) == (None, None, "high")
    assert str(value) == "material.friction_deg = 40 deg, the nearest value, without a standard error"
    text = "\n".join(remarks(forward.unknowns, forward.targets, solution))
    assert "no values in the ranges reproduce the measurements: zeta is 0.5, 25% above the measured 0.4 (" in text
    assert "at the end of its range, 40, and the measurements are not reproduced there" in text


def test_a_quantity_that_never_reaches_the_measured_value_is_reported() -> None:
    """Zeta is largest inside the range: one measured value and one unknown, and still a misfit."""

    def formula(friction: float) -> tuple[float, float]:
        return 1.0 - 0.002 * (friction - 30.0) ** 2, 0.5

    forward = Synthetic([FRICTION], targets_of({"zeta": (1.2, 0.01)}), formula)
    solution = solve(forward, [FINE])
    assert FRICTION.at(solution.shares[0]) == pytest.approx(30.0, abs=0.5)
    assert "zeta is 1, 17% below the measured 1.2" in next(remarks([FRICTION], forward.targets, solution))
    assert fitted(forward, solution)[0].error is None


def test_an_interval_at_the_end_of_the_range_is_one_sided() -> None:
    """Zeta is 0.5 at the end, 0.49 is measured: within the errors, so that the friction angle may be larger."""
    forward = Synthetic([FRICTION], targets_of({"zeta": (0.49, 0.01)}), slope)
    solution = solve(forward, [FINE])
    (value,) = fitted(forward, solution)
    assert agreement_of(forward.targets, solution).is_reproduced and value.error and value.interval
    assert value.interval == (pytest.approx(40.0 - NORMAL_90 * value.error), 40.0) and value.end == "high"
    assert f"95 %, one-sided: at least {value.interval[0]:.4g}" in str(value)
    text = next(remarks([FRICTION], forward.targets, solution))
    assert "at the end of its range, 40, where the measurements are reproduced within their errors" in text


def test_an_interval_is_cut_to_the_range() -> None:
    forward = Synthetic([FRICTION], targets_of({"zeta": (0.6, 0.1)}), slope)
    (value,) = fitted(forward, solve(forward, [FINE]))
    assert value.value == pytest.approx(38.0, abs=0.1) and value.interval and value.interval[1] == 40.0
    assert value.error and value.interval[0] == pytest.approx(value.value - NORMAL_90 * value.error)
    assert "to 40, cut to the range" in str(value)


def test_contradicting_measurements_enlarge_the_errors_by_the_misfit() -> None:
    """Zeta asks for 25, beta for 35 degrees. Errors are those by the misfit, the interval that of Student's t."""
    forward = Synthetic([FRICTION], targets_of({"zeta": (1.25, 0.05), "beta": (0.65, 0.01)}), slope)
    solution = solve(forward, [FINE])
    agreement, found = agreement_of(forward.targets, solution), solution.precision
    assert not agreement.is_reproduced and agreement.has_errors and agreement.freedom == 1 and found
    difference = solution.fitted - [1.25, 0.65]
    chi_squared = difference @ np.linalg.inv(sum(solution.causes.values())) @ difference
    (value,) = fitted(forward, solution)
    assert value.error == pytest.approx(20.0 * found.errors[0] * np.sqrt(chi_squared))
    assert value.interval and value.error and agreement.quantile == pytest.approx(np.tan(0.45 * np.pi))  # t, 1 degree
    text = agreement.statement
    assert "zeta is" in text and "beta is" in text and "the standard errors are enlarged by" in text


def test_agreeing_measurements_leave_the_errors() -> None:
    forward = Synthetic([FRICTION], targets_of({"zeta": (1.0, 0.05), "beta": (0.6, 0.01)}), slope)
    agreement = agreement_of(forward.targets, solve(forward, [FINE]))
    assert (agreement.scale, agreement.quantile, agreement.statement) == (1.0, NORMAL_90, "")


@pytest.mark.parametrize("names", [("zeta",), ("zeta", "beta")])
def test_intervals_contain_the_value_as_often_as_stated(names: tuple[str, ...]) -> None:
    """Deposits whose measured values scatter by their standard errors, over the whole range: 90 % of 80 intervals."""
    draw, level, held = np.random.default_rng(5), Level("level1", ("own",), 40.0, ""), 0
    for _ in range(80):
        friction = draw.uniform(FRICTION.low, FRICTION.high)
        exact = dict(zip(("zeta", "beta"), slope(friction), strict=True))
        measured = {name: (exact[name] * (1.0 + 0.05 * draw.normal()), 0.05 * exact[name]) for name in names}
        forward = Synthetic([FRICTION], targets_of(measured), slope)
        (value,) = fitted(forward, solve(forward, [level]))
        held += value.interval is not None and value.interval[0] <= friction <= value.interval[1]
    assert 66 <= held < 80  # 72 +- 2.7 by the binomial distribution


def test_limits_of_the_misfit() -> None:
    """Two standard errors for one value; for two, chi squared has the tail exp(-x / 2)."""
    tail = math.erfc(2.0 / math.sqrt(2.0))
    assert largest_misfit(1) == pytest.approx(4.0) and largest_misfit(2) == pytest.approx(-2.0 * np.log(tail))


def test_an_error_of_the_grid_that_is_not_studied_is_not_zero() -> None:
    targets = targets_of({"zeta": (1.0, 0.05)})
    coarse, fine = (Synthetic([FRICTION], targets, slope) for _ in range(2))
    (unknown,), (known,) = fitted(coarse, solve(coarse, [COARSE])), fitted(fine, solve(fine, [FINE]))
    assert unknown.parts and unknown.parts["grid"] is None and "grid not known" in str(unknown)
    assert known.parts and known.parts["grid"] == pytest.approx(0.02 / 0.05) and "grid 0.4," in str(known)


def test_a_search_that_does_not_converge_is_reported() -> None:
    """The runout differs between runs of equal values by more than its error, so that no two steps agree."""
    jumps = itertools.cycle((0.7, 1.3, 0.9, 1.45, 0.6))

    def erratic(friction: float) -> tuple[float, float]:
        zeta, beta = slope(friction)
        return zeta * next(jumps), beta

    forward = Synthetic([FRICTION], targets_of({"zeta": (1.0, 1e-3)}), erratic)
    solution = solve(forward, [FINE])
    assert not solution.is_converged and forward.calls.count("level2") == 3 + MOST_STEPS - 1
    text = "\n".join(remarks([FRICTION], forward.targets, solution))
    assert f"the search did not converge in {MOST_STEPS} steps" in text and "material.friction_deg by" in text
    assert solve(Synthetic([FRICTION], targets_of({"zeta": (1.0, 1e-3)}), slope), [FINE]).is_converged


def test_unknowns_that_cannot_be_separated_are_reported_with_what_would() -> None:
    """Runout and height depend on the sum of both; the repose angle on the friction angle alone."""

    def formula(friction: float, floor: float) -> tuple[float, float, float]:
        both = 0.03 * (friction - 20.0) + 1.5 * floor
        return 1.8 - both, 0.4 + 0.4 * both + 0.01 * floor, 0.8 * friction

    forward = Synthetic([FRICTION, FLOOR], targets_of({"zeta": 1.0, "beta": 0.72}), formula)
    text = remarks_of(forward)
    assert "material.friction_deg and friction.floor cannot be separated by zeta, beta" in text
    assert text.count("repose (repose angle of the deposit), measured within 3%") == 1


def test_a_quantity_of_the_course_separates_what_the_deposit_does_not() -> None:
    """All of the deposit depends on the sum of both unknowns, the runout at one time on their difference."""

    def formula(friction: float, damping: float) -> tuple[float, float, float]:
        both = 0.02 * (friction - 20.0) + damping
        return 1.8 - both, 0.4 + 0.4 * both, 20.0 + both

    def course(friction: float, damping: float) -> dict[str, float]:
        return {"zeta_at_1": 0.5 + 0.02 * (friction - 20.0) - damping}

    targets = targets_of({"zeta": 0.85 * 1.4, "beta": 0.56})
    text = remarks_of(Synthetic([FRICTION, FLOOR], targets, formula))
    assert "(examined: repose, undisturbed_radius, profile)" in text and "no other quantity" in text
    assert "zeta_at_1 (runout at 1 sqrt(h_i/g) after the release), measured within 3%, would reduce" in remarks_of(
        Synthetic([FRICTION, FLOOR], targets, formula, course=course)
    )


def test_a_quantity_of_the_course_can_be_fitted() -> None:
    def course(friction: float) -> dict[str, float]:
        return {"stop_time": 5.0 - 0.1 * friction}

    forward = Synthetic([FRICTION], parse_targets("stop_time=2+-0.1"), runout_of, course=course)
    solution = solve(forward, [FINE])
    assert FRICTION.at(solution.shares[0]) == pytest.approx(30.0)
    assert list(remarks([FRICTION], forward.targets, solution)) == [
        "the error of the grid in stop_time is not known, and in no standard error"
    ]
    assert fitted(forward, solution)[0].parts == {"measurement": pytest.approx(1.0), "grid": None, "scatter": ANY}


def test_quantities_of_the_course_by_hand() -> None:
    """The front moves with 1 m in sqrt(h_i/g) = 0.5 s until 2.5 of these; the height falls by 0.1 m in each."""
    time = np.linspace(-0.5, 2.0, 26)
    front = 2.0 + np.clip(2.0 * time, 0.0, 2.5)
    history = {
        "stage": np.where(time < 0.0, "equilibrate", "collapse"), "time": time, "front_height": front,
        "height": 4.0 - 0.2 * np.maximum(time, 0.0),
    }  # fmt: skip
    shape = SimpleNamespace(h_i=4.0, r_i=2.0, spacing=0.01)
    results: Any = SimpleNamespace(history=history, shape=shape, fall_time=0.5)
    assert course_of(results) == {
        "zeta_at_1": pytest.approx(0.5), "zeta_at_2": pytest.approx(1.0), "beta_at_1": pytest.approx(0.975),
        "beta_at_2": pytest.approx(0.95), "stop_time": pytest.approx(2.6, abs=0.21),
    }  # fmt: skip


def test_a_quantity_that_is_zero_is_not_proposed() -> None:
    def formula(friction: float) -> tuple[float, float, float]:
        return 1.0, 0.5, 0.0

    text = remarks_of(Synthetic([FRICTION], targets_of({"zeta": 1.0}), formula))
    assert "no other quantity" in text and "(examined: beta, undisturbed_radius, profile)" in text


def test_a_determined_unknown_has_no_remarks() -> None:
    assert remarks_of(Synthetic([FRICTION], targets_of({"zeta": 1.2}), runout_of)) == ""


def test_errors_of_the_grid_act_as_those_of_runout_and_height() -> None:
    """By a finite difference: a deposit with 1 % more runout, and one with 1 % more height."""
    targets = [
        *targets_of({"zeta": 1.0, "beta": 0.5}),
        Target("profile", "m", *np.zeros((2, 4)), np.linspace(0.3, 1.5, 4)),
    ]
    base = deposit(1.0, 0.5)

    def values(one: Measurement) -> np.ndarray:
        return np.concatenate([target.of(one) for target in targets])

    modes = np.vstack([target.grid_modes(base) for target in targets])
    longer, higher = (
        (values(deposit(1.01, 0.5)) - values(base)) / 0.01,
        (values(deposit(1.0, 0.505)) - values(base)) / 0.01,
    )
    assert modes[:, 0] == pytest.approx(longer, rel=0.05, abs=1e-6)
    assert modes[:, 1] == pytest.approx(higher, rel=0.05, abs=1e-6)
    covariance = grid_covariance(targets, base, GridErrors(0.1, 0.0, 0.2, 0.0))
    change = modes[:, 0] * np.array([0.1, 0.1, *[0.2] * 4])  # a profile is not corrected
    assert covariance == pytest.approx(np.outer(change, change))


def test_runout_and_height_are_corrected_and_the_rest_is_as_computed() -> None:
    targets = [
        *targets_of({"zeta": 1.0, "beta": 0.5, "repose": 14.0, "undisturbed_radius": 0.3, "stop_time": 2.0}),
        Target("profile", "m", *np.zeros((2, 4)), np.linspace(0.3, 1.5, 4)),
    ]
    computed, course, factors = deposit(0.9, 0.475), {"stop_time": 2.1}, GridFactors(1.0 / 0.9, 1.0 / 0.95)
    zeta, beta, *others = (target.of(computed, course, factors) for target in targets)
    assert (zeta[0], beta[0]) == pytest.approx((1.0, 0.5))
    for found, target in zip(others, targets[2:], strict=True):
        assert found == pytest.approx(target.of(computed, course))


def test_known_errors_of_the_grid_are_corrected() -> None:
    """The coarse grid of the synthetic runs has 85 % of the runout: 15 % less, known to 1 %."""
    interval = {ZETA: ErrorInterval(-0.16, -0.14), BETA: symmetric(0.01)}
    corrected_level = replace(COARSE, studied=StudiedGrid("light", {ZETA: 0.2, BETA: 0.05}, interval))
    forward = Synthetic([FRICTION], targets_of({"zeta": (runout_of(30.0)[0], 0.001)}), runout_of)
    search = Search(forward, lambda line: None)
    plain = search.run(COARSE, search.begin(COARSE))
    assert FRICTION.at(plain.shares[0]) < 26.5
    search.correct(corrected_level)
    found = search.run(corrected_level, plain.last.shares)
    assert FRICTION.at(found.shares[0]) == pytest.approx(30.0, abs=0.1)
    assert found.last.level == corrected_level


def test_errors_of_the_grid_act_on_the_repose_angle_as_on_that_of_a_triangle() -> None:
    (repose,) = targets_of({"repose": 14.0})

    def angle(zeta: float, beta: float) -> float:
        return float(np.degrees(np.arctan2(beta, 1.0 + zeta)))

    (modes,) = repose.grid_modes(deposit(1.0, 0.5, angle(1.0, 0.5)))
    changes = (angle(1.01, 0.5) - angle(1.0, 0.5)) / 0.01, (angle(1.0, 0.505) - angle(1.0, 0.5)) / 0.01
    assert modes == pytest.approx(changes, rel=0.1)


def test_measured_values_are_read_with_their_errors() -> None:
    zeta, repose = parse_targets("zeta = 1.37+-0.05, repose=31deg")
    assert (zeta.values[0], zeta.errors[0], zeta.is_stated) == (1.37, 0.05, True)
    assert (repose.values[0], repose.errors[0], repose.is_stated) == (31.0, pytest.approx(31.0 * ASSUMED_ERROR), False)
    (radius,) = parse_targets("undisturbed_radius=70 mm+-2 mm")
    assert (radius.values[0], radius.errors[0]) == (0.07, 0.002)


def test_a_profile_in_another_unit_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "mm.csv"
    path.write_text("r,z\n0,85\n100,60\n200,0\n")
    with pytest.raises(
        UsageError, match=r'profile is up to 85 m high, the column 90 mm; .* header "r \[mm\],z \[mm\]"'
    ):
        plan_fit("coarse-channel", [], [FRICTION], [read_profile(path)], tmp_path / "fit")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("zeta", "expected NAME=VALUE"),
        ("zeta=", "expected NAME=VALUE"),
        ("zeta=1,3", "--to 3: a name is missing, or the decimal separator is a point; expected NAME=VALUE"),
        ("runout=1", "no quantity 'runout'; expected one of zeta"),
        ("zeta=-1", "expected a value > 0"),
        ("zeta=1+-x", "not a number"),
        ("zeta=1,zeta=2", "zeta is given twice"),
        ("beta=2 mm", "cannot be converted"),
    ],
)
def test_wrong_measured_values_are_refused(text: str, message: str) -> None:
    with pytest.raises(UsageError, match="--to") as refused:
        parse_targets(text)
    assert message in str(refused.value)


def test_a_profile_is_sampled_at_stations(tmp_path: Path) -> None:
    path = tmp_path / "deposit.csv"
    path.write_text("r [mm],z [mm]\n200,0\n0,80\n100,40\n")
    target = read_profile(path)
    assert target.x[[0, -1]] == pytest.approx([0.0, 0.2]) and target.values[[0, -1]] == pytest.approx([0.08, 0.0])
    assert target.errors == pytest.approx(0.0016)
    path.write_text("r,z,series\n0,1,a\n1,0,a\n2,0,b\n")
    with pytest.raises(UsageError, match="2 series"):
        read_profile(path)


def test_unknowns_are_checked_with_the_case() -> None:
    (friction,) = parse_unknowns(["material.friction_deg=20:45"], "channel", [])
    assert (friction.low, friction.high, friction.name, friction.unit) == (20.0, 45.0, "friction_deg", "deg")
    assert settings([friction], np.array([0.5])) == ["material.friction_deg=32.5"]
    (spacing,) = parse_unknowns(["material.cohesion=1 kPa:2 kPa"], "cohesive-column", [])
    assert (spacing.low, spacing.high) == (1000.0, 2000.0)


@pytest.mark.parametrize(
    ("texts", "overrides", "error", "message"),
    [
        (["material.friction_deg"], [], UsageError, "expected KEY=LOW:HIGH"),
        (["material.friction_deg=30"], [], UsageError, "expected KEY=LOW:HIGH"),
        (["material.friction_deg=40:30"], [], UsageError, "greater than its start"),
        (["material.friction_deg=30:100"], [], CaseError, "--vary material.friction_deg=30:100: "),
        (["material.fricton_deg=30:40"], [], CaseError, "--vary material.fricton_deg=30:40: "),
        (["geometry.model=plane:full"], [], UsageError, "not a real number"),
        (["grid.points_per_cell=4:9"], [], UsageError, "not a real number"),
        (["grid.spacing=1 mm:2 mm"], [], UsageError, "varies grid.spacing itself"),
        (["material.friction_deg=20:30"] * 2, [], UsageError, "given twice"),
        (["material.friction_deg=20:30"], ["material.friction_deg=25"], UsageError, "given twice"),
    ],
)
def test_wrong_unknowns_are_refused(
    texts: list[str], overrides: list[str], error: type[Exception], message: str
) -> None:
    with pytest.raises(error) as refused:
        parse_unknowns(texts, "channel", overrides)
    assert message in str(refused.value)


def test_more_unknowns_than_measured_values_are_refused() -> None:
    with pytest.raises(UsageError, match=r"2 unknowns .* cannot follow from 1 measured value \(zeta\)"):
        require_enough([FRICTION, FLOOR], targets_of({"zeta": 1.0}))
    with pytest.raises(UsageError, match="no unknown"):
        require_enough([], targets_of({"zeta": 1.0}))


def test_levels_end_with_the_accuracy_asked_for() -> None:
    assert levels_for(0.05) == [0.2, 0.1, 0.05] and levels_for(0.2) == [0.2] and levels_for(None) == [None]
    assert levels_for(0.08) == [0.2, 0.08]


def test_a_case_unlike_those_of_the_study_is_reported() -> None:
    unlike = replace(COARSE, differences=("a = 9, in the study 1 to 3",))
    forward = Synthetic([FRICTION], targets_of({"zeta": 1.2}), runout_of)
    assert list(remarks(forward.unknowns, forward.targets, solve(forward, [unlike]))) == [
        "the error of the grid may not apply: a = 9, in the study 1 to 3"
    ]


def test_a_case_that_is_not_at_rest_is_reported() -> None:
    forward = Synthetic([FRICTION], targets_of({"zeta": 1.2}), runout_of)
    forward.at_rest = False
    assert "still moved" in remarks_of(forward)


def test_fits_with_different_fixed_values_have_different_default_folders() -> None:
    unknowns = [Unknown("material.friction_deg", 20.0, 45.0)]
    name = f"fits/quickstart-{unknowns[0].name}"
    assert default_folder("quickstart", unknowns) == Path(name)
    two = default_folder("quickstart", unknowns, ["geometry.aspect=2", "method.transfer=apic"], 0.05)
    assert two == Path(f"fits/quickstart-a2-transfer-apic-accuracy0.05-{unknowns[0].name}")
