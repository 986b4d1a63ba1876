"""The closed-form Mohr-Coulomb return against a brute-force Koiter return, and the element tests of soil mechanics."""

from __future__ import annotations

from math import log, radians, sin, sqrt, tan

import numpy as np
import pytest

from mpmcol.mpm.constitutive import mohr_coulomb, mohr_coulomb_softening
from tests.support.reference import koiter_return

ELASTIC = {"density": 2650.0, "youngs_modulus": 10e6, "poissons_ratio": 0.2}
K, G = 10e6 / 1.8, 10e6 / 2.4
SCALE = 1e4
ANGLES = [(33.0, 0.0), (39.0, 6.0), (50.0, 25.0), (30.0, 30.0), (20.0, 1.0)]
UNUSED, DT = (0.0, 0.0), 1e-5


def params_of(friction, dilatancy=0.0, cohesion=0.0):
    material = mohr_coulomb.Material(
        law="mohr-coulomb", friction_deg=friction, dilatancy_deg=dilatancy, cohesion=cohesion, **ELASTIC
    )
    return mohr_coulomb.make_params(material)


def returned(trial, params):
    """Stresses (n, 3) after the return, released volumetric strains (n,), whether the trial is elastic (n,)."""
    *principal, _, released, yields = mohr_coulomb.return_map(*trial.T, UNUSED, params, DT)
    elastic = yields <= 0.0
    return np.where(elastic[:, None], trial, np.array(principal).T), np.where(elastic, 0.0, released), elastic


def one(s, params):
    """Principal stresses after the return of one sorted triple."""
    return returned(np.array([s]), params)[0][0]


def random_trials(n, centre=0.0, seed=1):
    """Sorted principal stresses (n, 3) around the apex, many of them in every region of the return."""
    rng = np.random.default_rng(seed)
    trial = centre + SCALE * (rng.normal(size=(n, 3)) + rng.normal(size=(n, 1)))
    return -np.sort(-trial, axis=1)


def strain_of(stress):
    """Elastic principal strains (n, 3) of principal stresses (n, 3)."""
    p = stress.mean(axis=-1, keepdims=True)
    return (stress - p) / (2.0 * G) + p / (3.0 * K)


def stress_of(strain):
    volumetric = strain.sum(axis=-1, keepdims=True)
    return 2.0 * G * (strain - volumetric / 3.0) + K * volumetric


def regions(stress, elastic, apex):
    """elastic 0, face 1, edge s1 = s2 2, edge s2 = s3 3, apex 4."""
    near = 1e-9 * SCALE
    first, second = stress[:, 0] - stress[:, 1] < near, stress[:, 1] - stress[:, 2] < near
    at_apex = np.all(np.abs(stress - apex) < near, axis=1)
    return np.select([elastic, at_apex, first, second], [0, 4, 2, 3], 1)


# ------------------------------------------------------------------------------------- the return itself


@pytest.mark.parametrize("cohesion", [0.0, 5e3])
@pytest.mark.parametrize(("phi", "psi"), ANGLES)
def test_return_is_the_koiter_return_in_every_region(phi, psi, cohesion):
    params = params_of(phi, psi, cohesion)
    trial = random_trials(10_000, params.apex)
    stress, released, elastic = returned(trial, params)
    np.testing.assert_allclose(
        stress, koiter_return(trial, radians(phi), radians(psi), cohesion, K, G), atol=1e-9 * SCALE, rtol=0.0
    )
    np.testing.assert_array_equal(stress[elastic], trial[elastic])
    region = regions(stress, elastic, params.apex)
    assert np.all(np.bincount(region, minlength=5) > 50)
    np.testing.assert_allclose(released[region == 4], (trial[region == 4].mean(axis=1) - params.apex) / K, atol=1e-15)
    assert np.all(released[region != 4] == 0.0)


@pytest.mark.parametrize(("phi", "psi"), ANGLES)
def test_return_is_sorted_admissible_and_idempotent(phi, psi):
    params = params_of(phi, psi, 1e3)
    once = returned(random_trials(2_000, seed=2), params)[0]
    assert np.all(np.diff(once, axis=1) <= 1e-9 * SCALE)
    shifted = once - params.apex
    assert np.all(params.n_phi * shifted[:, 0] - shifted[:, 2] <= 1e-9 * SCALE)
    np.testing.assert_allclose(returned(once, params)[0], once, atol=1e-9 * SCALE)


@pytest.mark.parametrize(("phi", "psi"), ANGLES)
def test_plastic_flow_dissipates_and_dilates_by_sin_psi_on_the_face(phi, psi):
    params = params_of(phi, psi, 1e3)
    trial = random_trials(2_000, seed=3)
    stress, _, elastic = returned(trial, params)
    plastic = strain_of(trial - stress)
    assert np.all(np.sum(stress * plastic, axis=1) >= -1e-9 * SCALE**2 / G)
    flow = plastic[regions(stress, elastic, params.apex) == 1]
    np.testing.assert_allclose(flow.sum(axis=1), sin(radians(psi)) * (flow[:, 0] - flow[:, 2]), atol=1e-12)
    np.testing.assert_allclose(flow[:, 1], 0.0, atol=1e-12)


@pytest.mark.parametrize(("phi", "psi"), ANGLES)
def test_return_is_continuous_across_the_regions(phi, psi):
    """Along straight paths in trial space no jump exceeds three times the step."""
    params = params_of(phi, psi, 1e3)
    ends, seen = random_trials(40, params.apex, seed=4), set()
    along = np.linspace(0.0, 1.0, 401)[:, None]
    for start, end in zip(ends[::2], ends[1::2], strict=True):
        stress, _, elastic = returned(start + along * (end - start), params)
        jump = np.linalg.norm(np.diff(stress, axis=0), axis=1)
        assert jump.max() <= 3.0 * np.linalg.norm(end - start) / 400
        seen |= set(regions(stress, elastic, params.apex).tolist())
    assert seen == {0, 1, 2, 3, 4}


def test_isochoric_return_below_the_apex_conserves_the_mean_stress_and_is_independent_of_moduli():
    trial = random_trials(1_000, centre=-3.0 * SCALE, seed=5)
    trial = trial[trial.mean(axis=1) < 0.0]
    stress = returned(trial, params_of(33.0))[0]
    other = returned(trial, params_of(33.0)._replace(bulk_modulus=7.0 * K, shear_modulus=0.1 * G))[0]
    np.testing.assert_allclose(stress.mean(axis=1), trial.mean(axis=1))
    np.testing.assert_allclose(stress, other, atol=1e-9 * SCALE)


def test_tension_is_cut_off_at_the_apex():
    np.testing.assert_array_equal(one((2e3, 1e3, 1e3), params_of(33.0)), 0.0)
    cohesive = params_of(33.0, cohesion=1e3)
    apex = 1e3 / tan(radians(33.0))
    np.testing.assert_allclose(one((9e3, 8e3, 8e3), cohesive), apex)
    np.testing.assert_allclose(mohr_coulomb.apex(UNUSED, cohesive), apex)


def test_zero_stress_is_elastic():
    stress, released, elastic = returned(np.zeros((1, 3)), params_of(33.0))
    assert elastic.all() and not stress.any() and not released.any()


# ---------------------------------------------------------------------------------------- element tests


def drive(stress, strain_step, params, steps):
    """Stress (3, 3) after equal strain increments (3, 3), without rotation of the material."""
    mean = np.trace(strain_step) / 3.0
    increment = 2.0 * G * (strain_step - mean * np.eye(3)) + 3.0 * K * mean * np.eye(3)
    for _ in range(steps):
        values, axes = np.linalg.eigh(stress + increment)
        axes = axes[:, ::-1]
        stress = axes @ np.diag(one(values[::-1], params)) @ axes.T
    return stress


def test_oedometer_reaches_the_active_ratio_and_its_tangent():
    step = np.diag([0.0, -1e-6, 0.0])
    first = drive(np.zeros((3, 3)), step, params_of(33.0), 100)
    last = drive(first, step, params_of(33.0), 100)
    np.testing.assert_allclose([last[0, 0] / last[1, 1], last[2, 2] / last[1, 1]], 0.2948, atol=5e-5)
    k = params_of(33.0).n_phi
    np.testing.assert_allclose((first - last)[1, 1] / 1e-4, 3.0 * k * K / (2.0 + k))
    np.testing.assert_allclose((first - last)[1, 1] / 1e-4, 10.485e6, rtol=1e-4)


def test_simple_shear_mobilises_sin_phi():
    step = np.array([[0.0, 5e-6, 0.0], [5e-6, 0.0, 0.0], [0.0, 0.0, 0.0]])
    stress = drive(-1e3 * np.diag([0.5, 1.0, 0.7]), step, params_of(33.0), 500)
    np.testing.assert_allclose(-stress[0, 1] / stress[1, 1], 0.5446, atol=1e-4)


@pytest.mark.parametrize("psi", [0.0, 10.0])
def test_triaxial_compression_fails_at_n_phi(psi):
    """Compression at constant cell pressure, by iteration over the lateral strain: s3 / s1 = N_phi."""
    params, stress = params_of(33.0, psi), np.full(3, -1e3)
    for _ in range(300):
        trial_strain = np.array([1e-5, 1e-5, -2e-5])
        for _ in range(60):
            trial = stress + stress_of(trial_strain)
            new = one(trial, params)
            trial_strain[:2] -= 0.4 * (new[0] + 1e3) / K
        stress = new
    np.testing.assert_allclose(stress[0], -1e3, rtol=1e-6)
    np.testing.assert_allclose(stress[2] / stress[0], params.n_phi, rtol=1e-9)
    np.testing.assert_allclose(trial_strain.sum() / -trial_strain[2], params.n_psi - 1.0, atol=1e-6)


# -------------------------------------------------------------------------------------------- softening


def softening(cohesion=0.0):
    material = mohr_coulomb_softening.Material(
        law="mohr-coulomb-softening",
        friction_peak_deg=50.0,
        friction_residual_deg=33.0,
        dilatancy_peak_deg=25.0,
        dilatancy_residual_deg=0.0,
        softening_rate=5.0,
        cohesion=cohesion,
        **ELASTIC,
    )
    return mohr_coulomb_softening.make_params(material)


@pytest.mark.parametrize("cohesion", [0.0, 1e3])
@pytest.mark.parametrize(("eps", "phi", "psi"), [(0.0, 50.0, 25.0), (log(2.0) / 5.0, 41.5, 12.5), (20.0, 33.0, 0.0)])
def test_softening_returns_with_the_angles_of_the_present_strain(eps, phi, psi, cohesion):
    trial = random_trials(500, seed=6)
    *principal, (strain, _), opened, yields = mohr_coulomb_softening.return_map(
        *trial.T, (np.full(len(trial), eps), 0.0), softening(cohesion), DT
    )
    stress, released, elastic = returned(trial, params_of(phi, psi, cohesion))
    np.testing.assert_array_equal(yields <= 0.0, elastic)
    np.testing.assert_allclose(np.array(principal).T[~elastic], stress[~elastic], atol=1e-8 * SCALE)
    np.testing.assert_allclose(opened[~elastic], released[~elastic], atol=1e-12)
    plastic = strain_of(trial - stress)
    deviatoric = plastic - plastic.mean(axis=1, keepdims=True)
    length = sqrt(2.0 / 3.0) * np.linalg.norm(deviatoric, axis=1)
    np.testing.assert_allclose((strain - eps)[~elastic], length[~elastic], atol=1e-12)


@pytest.mark.parametrize("cohesion", [0.0, 1e3])
def test_may_yield_is_positive_wherever_softening_material_yields(cohesion):
    trial, params = random_trials(2_000, seed=7), softening(cohesion)
    for eps in (0.0, 0.1, 20.0):
        history = (np.full(len(trial), eps), 0.0)
        yields = mohr_coulomb_softening.return_map(*trial.T, history, params, DT)[-1] > 0.0
        may = mohr_coulomb_softening.may_yield(trial[:, 0], trial[:, 2], history, params) > 0.0
        assert yields.any() and not np.any(yields & ~may)


def test_cohesion_decays_to_its_residual_value():
    material = mohr_coulomb_softening.Material(
        **ELASTIC, friction_peak_deg=33.0, friction_residual_deg=33.0, softening_rate=5.0, cohesion=1e3,
        cohesion_residual=200.0,
    )  # fmt: skip
    params, trial = mohr_coulomb_softening.make_params(material), random_trials(500, seed=6)
    for eps, cohesion in ((0.0, 1e3), (log(2.0) / 5.0, 600.0), (20.0, 200.0)):
        history = (np.full(len(trial), eps), 0.0)
        *principal, _, _, yields = mohr_coulomb_softening.return_map(*trial.T, history, params, DT)
        stress, _, elastic = returned(trial, params_of(33.0, 0.0, cohesion))
        np.testing.assert_array_equal(yields <= 0.0, elastic)
        np.testing.assert_allclose(np.array(principal).T[~elastic], stress[~elastic], atol=1e-8 * SCALE)
        apex = mohr_coulomb_softening.apex(history, params)
        np.testing.assert_allclose(apex, cohesion / tan(radians(33.0)), rtol=1e-12)
