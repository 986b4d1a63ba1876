"""Mohr-Coulomb with a tension cut-off and without friction: brute force, closest point, and loss of strength."""

from __future__ import annotations

from itertools import permutations
from math import exp, radians, sqrt, tan

import numpy as np
import pytest
from scipy.optimize import minimize

from mpmcol.mpm.constitutive import mohr_coulomb, mohr_coulomb_softening
from tests.support.reference import koiter_return

E, C, SCALE, DT = 10e6, 5e3, 1e4, 1e-5
INTACT = (0.0, 0.0)
SOILS = [  # phi, psi, tensile strength over c cot(phi), or over c without friction
    (33.0, 0.0, 0.0), (33.0, 0.0, 0.5), (33.0, 10.0, 0.3), (33.0, 33.0, 0.7), (20.0, 0.0, 0.9), (0.0, 0.0, 0.4),
    (0.0, 0.0, 0.0), (0.0, 0.0, None),
]  # fmt: skip
soils = pytest.mark.parametrize(("phi", "psi", "ratio"), SOILS)


def params_of(phi, psi=0.0, tension=0.0, nu=0.2, **keys):
    material = mohr_coulomb.Material(
        density=2000.0, youngs_modulus=E, poissons_ratio=nu, friction_deg=phi, dilatancy_deg=psi, cohesion=C,
        tension=tension, **keys,
    )  # fmt: skip
    return mohr_coulomb.make_params(material)


def tension_of(phi, ratio):
    return None if ratio is None else ratio * (C / tan(radians(phi)) if phi else C)


def random_trials(n, seed=1):
    rng = np.random.default_rng(seed)
    trial = SCALE * (rng.normal(size=(n, 3)) + rng.normal(size=(n, 1)))
    return -np.sort(-trial, axis=1)


def returned(trial, params):
    *principal, _, released, yields = mohr_coulomb.return_map(*trial.T, INTACT, params, DT)
    return np.where((yields > 0.0)[:, None], np.array(principal).T, trial), np.where(yields > 0.0, released, 0.0)


@pytest.mark.parametrize("nu", [0.0, 0.2, 0.45])
@soils
def test_return_is_the_koiter_return(phi, psi, ratio, nu):
    """Against all active sets of the nine planes, in every region of the surface."""
    tension, trial = tension_of(phi, ratio), random_trials(10_000)
    params = params_of(phi, psi, tension, nu)
    stress, released = returned(trial, params)
    expected = koiter_return(
        trial, radians(phi), radians(psi), C, params.bulk_modulus, params.shear_modulus, tension=tension
    )
    np.testing.assert_allclose(stress, expected, atol=1e-9 * SCALE, rtol=0.0)
    limit = mohr_coulomb.UNLIMITED if tension is None else tension
    at_apex = np.all(np.abs(stress - limit) < 1e-9 * SCALE, axis=1)
    np.testing.assert_allclose(released[at_apex], (trial[at_apex].mean(axis=1) - limit) / params.bulk_modulus)
    assert np.all(released[~at_apex] == 0.0)
    if tension is not None and ratio < 0.9:
        active = np.isclose(stress, tension, atol=1e-9 * SCALE).sum(axis=1)
        shear = np.abs(params.n_phi * stress[:, 0] - stress[:, 2] - params.strength) < 1e-8 * SCALE
        corners = [(count, both) for count in (1, 2) for both in (False, True)]
        assert all(np.sum((active == count) & (shear == both)) > 20 for count, both in corners)


# Unit tests of GeoMechanicsApplication (Kratos Multiphysics), MohrCoulombWithTensionCutOff: phi = 35 degrees, c = 10,
# tensile strength 10, Poisson's ratio 0. Without returns to an edge between two shear planes, which it approximates.
PUBLISHED = [  # psi, trial, stress; principal stresses, tension positive
    (20.0, (6.0, 0.0, -10.0), (6.0, 0.0, -10.0)),
    (20.0, (8.0, 6.0, 4.0), (8.0, 6.0, 4.0)),
    (0.0, (8.0, 0.0, -12.0), (7.338673315592010, 0.0, -11.338673315592010)),
    (0.0, (12.0, 0.0, -16.0), (7.338673315592010, 0.0, -11.338673315592010)),
    (20.0, (18.0, 8.0, -2.0), (10.0, 8.0, -1.5179192179966735)),
    (20.0, (24.0, 8.0, -8.0), (10.0, 8.0, -1.5179192179966735)),
    (20.0, (24.0, 22.0, -8.0), (10.0, 10.0, -1.5179192179966735)),
    (20.0, (12.0, 9.0, 8.0), (10.0, 9.0, 8.0)),
    (20.0, (14.0, 9.0, 6.0), (10.0, 9.0, 6.0)),
    (20.0, (14.0, 12.0, 6.0), (10.0, 10.0, 6.0)),
    (20.0, (19.0, 12.0, 11.0), (10.0, 10.0, 10.0)),
    (20.0, (11.5, 10.5, 10.0), (10.0, 10.0, 10.0)),
]


@pytest.mark.parametrize(("psi", "trial", "expected"), PUBLISHED)
def test_published_returns(psi, trial, expected):
    scale = C / 10.0
    stress, _ = returned(scale * np.array([trial]), params_of(35.0, psi, tension=C, nu=0.0))
    np.testing.assert_allclose(stress[0], scale * np.array(expected), rtol=0.0, atol=1e-11 * C)


@pytest.mark.parametrize(("phi", "ratio"), [(33.0, 0.4), (0.0, 0.4)])
def test_the_associated_return_is_the_closest_point(phi, ratio):
    """In the norm of the elastic energy, by a general optimiser."""
    tension, psi = tension_of(phi, ratio), phi
    params, trials = params_of(phi, psi, tension), random_trials(40, seed=4)
    stress, _ = returned(trials, params)
    compliance = (1.2 * np.eye(3) - 0.2) * (SCALE / E)  # nu = 0.2
    pairs = [(i, j) for i, j in permutations(range(3), 2)]
    rows = np.array([params.n_phi * np.eye(3)[i] - np.eye(3)[j] for i, j in pairs] + list(np.eye(3)))
    limits = np.array(6 * [params.strength] + 3 * [tension]) / SCALE
    for trial, found in zip(trials / SCALE, stress / SCALE, strict=True):
        solution = minimize(
            lambda s, trial=trial: (s - trial) @ compliance @ (s - trial) * 1e3,
            np.full(3, -1.0),
            jac=lambda s, trial=trial: 2e3 * compliance @ (s - trial),
            constraints={"type": "ineq", "fun": lambda s: limits - rows @ s, "jac": lambda s: -rows},
            method="SLSQP",
            options={"ftol": 1e-14, "maxiter": 300},
        )
        np.testing.assert_allclose(found, solution.x, atol=2e-5)


@soils
def test_return_is_admissible_sorted_and_idempotent(phi, psi, ratio):
    params = params_of(phi, psi, tension_of(phi, ratio))
    once, _ = returned(random_trials(2000, seed=2), params)
    assert np.all(np.diff(once, axis=1) <= 1e-9 * SCALE)
    assert np.max(mohr_coulomb.may_yield(once[:, 0], once[:, 2], INTACT, params)) < 1e-8 * SCALE
    np.testing.assert_allclose(returned(once, params)[0], once, atol=1e-8 * SCALE)


def test_the_default_is_the_tensile_strength_at_the_apex():
    """By other formulas, with dilatancy, where the flow rules at the apex agree."""
    plain, equal = params_of(33.0, 33.0, None), params_of(33.0, 33.0, C / tan(radians(33.0)) * (1.0 - 1e-12))
    assert (plain.cut_off, equal.cut_off) == (0.0, 1.0)
    trial = random_trials(2000, seed=5)
    np.testing.assert_allclose(returned(trial, plain)[0], returned(trial, equal)[0], atol=1e-7 * SCALE)


@pytest.mark.parametrize(("tension", "strength"), [(None, 2.0 * C), (0.4 * C, 0.4 * C), (3.0 * C, 2.0 * C)])
def test_clay_in_uniaxial_tension_fails_at_its_tensile_strength_or_at_twice_the_cohesion(tension, strength):
    params = params_of(0.0, 0.0, tension)
    assert mohr_coulomb.may_yield(0.999 * strength, 0.0, INTACT, params) < 0.0
    assert mohr_coulomb.may_yield(1.001 * strength, 0.0, INTACT, params) > 0.0


def test_material_that_has_failed_in_tension_has_friction_only():
    params = params_of(20.0, 0.0, 0.5 * C, failure_strain=1e-4)
    trial = np.array([[0.9 * C, 0.0, -0.5 * C], [0.0, -0.5 * C, -5.0 * C], [0.4 * C, 0.0, 0.0]])
    stress, _ = returned(trial, params)
    *_, history, _, yields = mohr_coulomb.return_map(*trial.T, (np.full(3, 9e-5), 0.0), params, DT)
    np.testing.assert_array_equal(yields > 0.0, [True, True, False])
    plastic = (trial - stress).sum(axis=1) / (3.0 * params.bulk_modulus)
    np.testing.assert_allclose(history[0][:2] - 9e-5, [plastic[0], 0.0], atol=1e-15)  # by tension, and by shear
    assert history[0][0] > 1e-4
    np.testing.assert_array_equal(mohr_coulomb.apex(history, params)[:2], [0.0, 0.5 * C])

    dry = mohr_coulomb.Material(density=2000.0, youngs_modulus=E, poissons_ratio=0.2, friction_deg=20.0)
    again = random_trials(2000, seed=3)
    *found, _, _, yields = mohr_coulomb.return_map(*again.T, (np.full(2000, 2e-4), 0.0), params, DT)
    *expected, _, _, cone = mohr_coulomb.return_map(*again.T, INTACT, mohr_coulomb.make_params(dry), DT)
    np.testing.assert_array_equal(yields > 0.0, cone > 0.0)
    shear_only = (cone > 0.0) & (np.array(expected)[0] < 0.0)
    np.testing.assert_allclose(np.array(found)[:, shear_only], np.array(expected)[:, shear_only], atol=1e-8 * SCALE)


@pytest.mark.parametrize(
    ("keys", "limit"), [({}, 1.0), ({"tension": None}, np.inf), ({"tension": None, "failure_strain": 0.0}, 0.0)]
)
def test_strength_is_lost_where_the_volume_has_doubled_by_default(keys, limit):
    params = params_of(20.0, **{"tension": 0.5 * C} | keys)
    assert params.failure_strain == limit and params.cut_off == float(limit < np.inf)
    assert params.strength == pytest.approx(2.0 * C * sqrt(params.n_phi))


@pytest.mark.parametrize("eps", [0.0, 0.3])
def test_softening_material_returns_to_its_present_cut_off(eps):
    """Strength and tensile strength are those of Mohr-Coulomb with the cohesion and friction that remain."""
    trial, tension = random_trials(10_000), 0.4 * C / tan(radians(40.0))
    params = mohr_coulomb_softening.make_params(
        mohr_coulomb_softening.Material(
            density=2000.0, youngs_modulus=E, poissons_ratio=0.2, friction_peak_deg=40.0, friction_residual_deg=30.0,
            dilatancy_peak_deg=10.0, softening_rate=5.0, cohesion=C, cohesion_residual=0.2 * C, tension=tension,
        )
    )  # fmt: skip
    history, remaining = (np.full(len(trial), eps), 0.0), exp(-5.0 * eps)
    *principal, (strain, _), released, yields = mohr_coulomb_softening.return_map(*trial.T, history, params, DT)
    stress = np.where((yields > 0.0)[:, None], np.array(principal).T, trial)
    share = 0.2 + 0.8 * remaining
    expected = koiter_return(
        trial, radians(30.0 + 10.0 * remaining), radians(10.0 * remaining), share * C, params.bulk_modulus,
        params.shear_modulus, tension=share * tension,
    )  # fmt: skip
    np.testing.assert_allclose(stress, expected, atol=1e-9 * SCALE, rtol=0.0)
    assert np.all(strain[yields > 0.0] >= eps) and released.max() > 0.0
    np.testing.assert_allclose(mohr_coulomb_softening.apex(history, params), share * tension, rtol=1e-12)
    may = mohr_coulomb_softening.may_yield(trial[:, 0], trial[:, 2], history, params) > 0.0
    assert not np.any((yields > 0.0) & ~may)


def test_dry_material_has_no_cut_off():
    """Its parameters, and so its results, are those of material without these keys."""
    dry = {"density": 2000.0, "youngs_modulus": E, "poissons_ratio": 0.2, "friction_deg": 33.0}
    plain, cut = (
        mohr_coulomb.make_params(mohr_coulomb.Material(**dry, **keys))
        for keys in ({}, {"cohesion": 0.0, "tension": 0.0, "failure_strain": 0.0})
    )
    assert cut._replace(failure_strain=plain.failure_strain) == plain and cut.cut_off == 0.0
