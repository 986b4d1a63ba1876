"""The stress filter, as plain Python for single points and in steps of the solver."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import (
    WEIGHTLESS,
    advance_steps,
    by_id,
    elastic_energy,
    lattice,
    make_solver,
    points_at,
    sand_body,
    walled_grid,
)
from mpmcol.mpm.constitutive import elastic, mohr_coulomb
from mpmcol.mpm.kernels import stress_2d, stress_3d
from mpmcol.mpm.kernels.loop import L_FILTER
from mpmcol.mpm.kernels.stress_filter import make_stress_filter
from mpmcol.mpm.particles import COLUMN, Points
from mpmcol.mpm.settings import Settings

SAND = mohr_coulomb.Material(
    law="mohr-coulomb", density=2000.0, youngs_modulus=1e6, poissons_ratio=0.2, friction_deg=30.0, cohesion=100.0
)
PARAMS, APEX = mohr_coulomb.make_params(SAND), 100.0 * 3.0**0.5
K, G = SAND.bulk_modulus, SAND.shear_modulus
RATE, SHEAR_RATE, DT = 100.0, 2.0, 1e-3
CHI = RATE * DT / (1.0 + RATE * DT)
FILTERED = Settings(filter_rate=RATE, filter_shear_rate=SHEAR_RATE, filter_opening=0.01, filter_modulus=K)
SHEAR = (0.0, 4.0, 0.0, 0.0, 0.0)  # simple shear faster than SHEAR_RATE
STRESS = (-300.0, -500.0, -100.0, 80.0)  # xx yy zz xy, mean -300


class Filtered(NamedTuple):
    """A point after the filter."""

    s: Any
    J: float
    opening: float
    lost: float

    @property
    def mean(self) -> float:
        return float(sum(self.s[:3])) / 3.0


def filtered(
    average: float,
    s: tuple[float, ...] = STRESS,
    L: tuple[float, ...] = SHEAR,
    opening: float = 0.0,
    law: Any = mohr_coulomb,
    params: Any = PARAMS,
) -> Filtered:
    filter_stress = make_stress_filter(stress_2d if len(s) == 4 else stress_3d, law)
    return Filtered(*filter_stress(s, L, 2.0, 0.9, opening, (0.0, 0.0), params, FILTERED, DT, average))


def energy(s: tuple[float, ...], J: float) -> float:
    """Elastic energy of the point, J."""
    mean = sum(s[:3]) / 3.0
    deviator2 = sum((value - mean) ** 2 for value in s[:3]) + 2.0 * sum(value**2 for value in s[3:])
    return 2.0 * J * (0.5 * mean**2 / K + 0.25 * deviator2 / G)


def test_the_mean_stress_approaches_the_average_and_the_deviator_stays() -> None:
    after = filtered(-400.0)
    assert after.mean == pytest.approx(-300.0 - CHI * 100.0)
    assert np.array(after.s) - STRESS == pytest.approx([-CHI * 100.0] * 3 + [0.0])
    assert after.opening == 0.0


def test_the_volume_follows_the_strain() -> None:
    after = filtered(-4000.0)
    ratio = 1.0 + (after.mean + 300.0) / K
    assert after == after._replace(J=pytest.approx(0.9 * ratio, rel=1e-14)) and ratio < 1.0


@pytest.mark.parametrize("average", [-200.0, -800.0])
def test_the_energy_lost_is_that_of_the_stress(average: float) -> None:
    after = filtered(average)
    assert after.lost == pytest.approx(energy(STRESS, 0.9) - energy(after.s, 0.9), rel=1e-9)


def test_the_rate_follows_the_square_of_the_shear_rate_up_to_its_limit() -> None:
    slow, fast = (filtered(-400.0, L=(0.0, rate, 0.0, 0.0, 0.0)).mean for rate in (0.5, 400.0))
    assert slow + 300.0 == pytest.approx((0.5 / SHEAR_RATE) ** 2 * (fast + 300.0))
    assert fast == filtered(-400.0).mean


@pytest.mark.parametrize("L", [(0.0,) * 5, (3.0, 0.0, 0.0, 3.0, 3.0), (0.0, 5.0, -5.0, 0.0, 0.0)])
def test_rest_expansion_and_rotation_are_not_filtered(L: tuple[float, ...]) -> None:
    assert filtered(-4e5, L=L)[:3] == (pytest.approx(STRESS), pytest.approx(0.9), 0.0)


def test_a_point_beyond_the_apex_opens_without_deviator() -> None:
    average = 4e5
    after = filtered(average)
    q = -300.0 + CHI * (average + 300.0)
    assert after.s == pytest.approx((APEX, APEX, APEX, 0.0)) and after.opening == pytest.approx((q - APEX) / K)
    assert after == after._replace(J=pytest.approx(0.9 * (1.0 + (APEX + 300.0) / K)))
    assert after.lost == pytest.approx(energy((-300.0,) * 3, 0.9) - energy((APEX,) * 3, 0.9), rel=1e-9)


def test_an_open_point_closes_under_pressure() -> None:
    opened = (APEX, APEX, APEX, 0.0)
    after = filtered(-1e6, opened, opening=2e-3)
    q = APEX + 2e-3 * K
    q += CHI * (-1e6 - q)
    assert q < 0.0 and after.s == pytest.approx((q, q, q, 0.0)) and after.opening == 0.0
    still = filtered(0.0, opened, opening=2e-3)
    assert still.s == pytest.approx(opened)
    assert still[1:3] == pytest.approx((0.9, 2e-3 - CHI * (APEX / K + 2e-3)))


def test_a_flying_point_is_not_changed() -> None:
    opened = (APEX, APEX, APEX, 0.0)
    assert filtered(-1e6, opened, opening=0.011) == (opened, 0.9, 0.011, 0.0)


def test_an_elastic_point_never_opens() -> None:
    after = filtered(1e6, law=elastic, params=elastic.ElasticParams(K, G))
    assert after.opening == 0.0 and after.mean == pytest.approx(-300.0 + CHI * 1_000_300.0)


def test_three_dimensions_are_filtered_alike() -> None:
    six, nine = (*STRESS, 0.0, 0.0), (0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    flat, solid = filtered(-400.0), filtered(-400.0, six, nine)
    assert [float(value) for value in solid.s[:4]] == pytest.approx([float(value) for value in flat.s])
    assert [float(value) for value in solid[1:]] == pytest.approx([float(value) for value in flat[1:]])


# ------------------------------------------------------------------------------------------ in the solver


def sheared(d: int, noise: float, settings: dict[str, float]) -> tuple[Points, Points, float]:
    """Points before and after a step of a block of sand in simple shear, and the energy that the filter took.

    noise: standard deviation of the pressure, whose mean is 1000 Pa.
    """
    h, body = 0.1, sand_body(youngs_modulus=1e6, poissons_ratio=0.2)
    x = lattice((0.5,) * d, (1.5,) * d, h / 2)
    points = points_at(x, h / 2, COLUMN)
    grad_v = np.zeros((len(x), 3, 3))
    grad_v[:, 0, 1] = 4.0
    points.v[:, 0], points.grad_v = 4.0 * x[:, 1], grad_v
    pressure = 1e3 + noise * np.random.default_rng(5).normal(size=len(x))
    points.sigma = np.stack([-pressure] * 3 + [np.zeros(len(x))] * 3, axis=1)
    solver = make_solver(points, walled_grid((0.0,) * d, h, (20,) * d), WEIGHTLESS._replace(cfl=1e-4, **settings), body)
    solver.sort()
    before = by_id(solver)
    advance_steps(solver, 1)
    return before, by_id(solver), float(solver.ledger[L_FILTER])


def filter_of_sand(rate: float) -> dict[str, float]:
    bulk = sand_body(youngs_modulus=1e6, poissons_ratio=0.2).params.bulk_modulus
    return {"filter_rate": rate, "filter_shear_rate": 2.0, "filter_modulus": bulk}


@pytest.mark.parametrize("d", [2, 3])
def test_a_uniform_stress_is_not_changed_up_to_the_free_surface(d: int) -> None:
    _, plain, _ = sheared(d, 0.0, {})
    _, after, lost = sheared(d, 0.0, filter_of_sand(1e9))
    np.testing.assert_allclose(after.sigma, plain.sigma, atol=1e-9)
    assert abs(lost) < 1e-12


@pytest.mark.parametrize("d", [2, 3])
def test_noise_becomes_smaller_and_momentum_and_volume_stay(d: int) -> None:
    """A step at a high rate leaves the noise of the average alone, which is over a dozen points or more."""
    before, after, lost = sheared(d, 50.0, filter_of_sand(1e9))
    _, plain, _ = sheared(d, 50.0, {})
    noise = [float(np.std(points.sigma[:, :3].mean(axis=1))) for points in (before, plain, after)]
    assert noise[1] > 0.9 * noise[0] and noise[2] < 0.4 * noise[0]
    np.testing.assert_array_equal(after.v, plain.v)
    np.testing.assert_array_equal(after.x, plain.x)
    volumes = [float(np.sum(points.V * (1.0 + points.opening))) for points in (plain, after)]
    largest_strain = 200.0 / filter_of_sand(1.0)["filter_modulus"]
    assert abs(volumes[1] / volumes[0] - 1.0) < largest_strain**2
    assert lost > 0.0
    stored = [elastic_energy(points, 1e6, 0.2) for points in (plain, after)]
    assert lost == pytest.approx(stored[0] - stored[1], rel=0.1)
