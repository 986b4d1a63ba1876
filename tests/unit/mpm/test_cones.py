"""The returns of Drucker-Prager and mu(I): one-step values, equivalence with each other and with Mohr-Coulomb."""

from __future__ import annotations

from math import radians, sin, sqrt

import numpy as np
import pytest

from mpmcol.mpm.constitutive import drucker_prager, mohr_coulomb, mu_i
from mpmcol.mpm.constitutive.invariants import active_ratio, invariants_of
from tests.support.reference import ReferenceMaterial, shear_rate

ELASTIC = {"density": 1550.0, "youngs_modulus": 10e6, "poissons_ratio": 0.2}
BEADS = {"mu_s": 0.48, "mu_2": 0.73, "I_0": 0.279, "grain_diameter": 0.7e-3, "grain_density": 2500.0}
UNUSED, DT = (0.0, 0.0), 3e-5
SIN = sin(radians(33.0))


def beads(**keys):
    return mu_i.make_params(mu_i.Material(**ELASTIC, **BEADS | keys))


def cone(**keys):
    return drucker_prager.make_params(drucker_prager.Material(**ELASTIC, **{"friction_deg": 33.0} | keys))


def random_stresses(n, seed=1):
    """Mean and shear stresses (n,), many of them beyond the apex, in the cone, and outside of it."""
    rng = np.random.default_rng(seed)
    return rng.normal(-400.0, 800.0, n), np.abs(rng.normal(0.0, 600.0, n))


@pytest.mark.parametrize(
    ("p", "tau", "expected", "rate"),
    [
        (1000.0, 600.0, 480.94106141598, 0.952471508672),
        (1000.0, 800.0, 482.493972058486, 2.54004822353),
        (100.0, 80.0, 48.0798307119217, 0.255361354305),
        (10000.0, 6000.0, 4829.03774168246, 9.36769806654),
    ],
)
def test_one_step_of_mu_i_has_the_values_of_an_exact_solution(p, tau, expected, rate):
    """tau = mu(I) p with the rate (tau_trial - tau) / (G dt), by arithmetic with more digits."""
    params = beads()
    mean, shear, _, released, yields = mu_i.return_map(-p, tau, UNUSED, params, DT)
    assert shear == pytest.approx(expected, rel=1e-12) and mean == -p and released == 0.0
    assert yields == pytest.approx(tau - expected, rel=1e-12)
    found = (tau - shear) / (params.shear_modulus * DT)
    assert found == pytest.approx(rate, rel=1e-10)
    number = found * 0.7e-3 * sqrt(2500.0 / p)
    assert shear == pytest.approx((0.48 + 0.25 / (1.0 + 0.279 / number)) * p, rel=1e-12)


def test_mu_i_is_elastic_below_its_strength_at_vanishing_rate():
    assert mu_i.return_map(-1000.0, 470.0, UNUSED, beads(), DT)[-1] < 0.0
    assert mu_i.may_yield(-1000.0, 470.0, UNUSED, beads()) < 0.0 < mu_i.may_yield(-1000.0, 481.0, UNUSED, beads())


@pytest.mark.parametrize("keys", [{}, {"cohesion": 50.0, "failure_strain": 0.0}])
@pytest.mark.parametrize("mean", [0.0, 10.0])
def test_a_point_without_strength_under_tension_has_no_stress(keys, mean):
    """Also one without any stress: numerator and denominator of the return are zero there."""
    broken = (1.0, 0.0)
    found = mu_i.return_map(mean, 0.0, broken, beads(**keys), DT)
    assert (found[0], found[1], found[-1]) == (0.0, 0.0, mean)


@pytest.mark.parametrize("cohesion", [0.0, 200.0])
def test_mu_i_solves_the_equation_of_the_rate(cohesion):
    """Against the positive root of the equation for the rate, also under tension, and beyond the apex."""
    params = beads(cohesion=cohesion)
    material = ReferenceMaterial(10e6, 0.2, c=cohesion, mu=0.48, mu_2=0.73, I_0=0.279, d=0.7e-3, rho_s=2500.0)
    for mean, shear in zip(*random_stresses(300), strict=True):
        new_mean, new_shear, _, released, yields = mu_i.return_map(mean, shear, UNUSED, params, DT)
        if mean > cohesion / 0.48:
            assert yields > 0.0 and new_shear == 0.0 and new_mean == cohesion / 0.48
            assert released == pytest.approx((mean - cohesion / 0.48) / params.bulk_modulus, rel=1e-12)
            continue
        rate = shear_rate(shear, -mean, material, DT)
        assert released == 0.0 and (yields > 1e-10) == (rate > 1e-10 / (params.shear_modulus * DT))
        if yields > 0.0:
            assert new_shear == pytest.approx(shear - params.shear_modulus * DT * rate, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("cohesion", [0.0, 200.0])
def test_equal_coefficients_give_drucker_prager(cohesion):
    params, same = beads(mu_2=0.48, cohesion=cohesion), cone(friction_deg=np.degrees(np.arctan(0.48)), match="tangent")
    same = same._replace(strength=cohesion, apex=cohesion / 0.48)
    mean, shear = random_stresses(2000)
    found = mu_i.return_map(mean, shear, UNUSED, params, DT)
    expected = drucker_prager.return_map(mean, shear, UNUSED, same, DT)
    yields = expected[-1] > 1e-9
    np.testing.assert_array_equal(found[-1] > 1e-9, yields)
    for one, other in zip((*found[:2], found[3]), (*expected[:2], expected[3]), strict=True):
        np.testing.assert_allclose(one[yields], other[yields], rtol=1e-12, atol=1e-10)


def test_a_step_of_no_duration_returns_to_the_strength_at_infinite_rate():
    """The check of the yield surface during a run uses it."""
    assert mu_i.return_map(-1000.0, 700.0, UNUSED, beads(), 0.0)[-1] <= 1e-12 * 1000.0
    assert mu_i.return_map(-1000.0, 740.0, UNUSED, beads(), 0.0)[-1] == pytest.approx(10.0, rel=1e-10)


def test_smaller_grains_are_weaker_at_the_same_trial_stress():
    shears = [mu_i.return_map(-1e3, 800.0, UNUSED, beads(grain_diameter=d), DT)[1] for d in (1e-3, 1e-4, 1e-5)]
    assert shears[0] > shears[1] > shears[2] > 480.0


@pytest.mark.parametrize("cohesion", [0.0, 100.0])
def test_the_compression_match_has_the_strength_of_mohr_coulomb_in_triaxial_compression(cohesion):
    n_phi = (1.0 + SIN) / (1.0 - SIN)
    side = -500.0
    axial = n_phi * side - 2.0 * cohesion * sqrt(n_phi)
    mean, shear = invariants_of(np.array([side]), np.array([side]), np.array([axial]))
    params = cone(match="compression", cohesion=cohesion)
    assert drucker_prager.may_yield(mean, shear, UNUSED, params) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("cohesion", [0.0, 100.0])
def test_the_plane_strain_match_has_the_strength_of_mohr_coulomb_at_constant_volume(cohesion):
    """There sigma_2 is the mean of the other two."""
    s1 = -500.0
    n_phi = (1.0 + SIN) / (1.0 - SIN)
    s3 = n_phi * s1 - 2.0 * cohesion * sqrt(n_phi)
    mean, shear = invariants_of(np.array([s1]), np.array([0.5 * (s1 + s3)]), np.array([s3]))
    assert drucker_prager.may_yield(mean, shear, UNUSED, cone(cohesion=cohesion)) == pytest.approx(0.0, abs=1e-9)
    sand = mohr_coulomb.Material(**ELASTIC, friction_deg=33.0, cohesion=cohesion)
    assert cone(cohesion=cohesion).apex == pytest.approx(mohr_coulomb.make_params(sand).apex, rel=1e-15)


def test_without_friction_there_is_no_apex():
    params = cone(friction_deg=0.0, cohesion=1e3)
    assert np.isinf(drucker_prager.apex(UNUSED, params))
    mean, shear, _, released, yields = drucker_prager.return_map(5e3, 1.5e3, UNUSED, params, DT)
    assert (mean, released) == (5e3, 0.0)
    assert shear == pytest.approx(1e3) and yields == pytest.approx(500.0)


def test_the_active_ratio_is_that_of_rankine_for_the_compression_match():
    material = drucker_prager.Material(**ELASTIC, friction_deg=33.0, match="compression")
    assert material.active_pressure_ratio == pytest.approx((1.0 - SIN) / (1.0 + SIN), rel=1e-12)
    assert active_ratio(2.0) == 0.0
