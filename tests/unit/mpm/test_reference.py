"""Closed-form checks of the reference implementation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.support.reference import (
    ReferenceGrid,
    ReferenceMaterial,
    ReferencePoints,
    ReferenceScheme,
    g2p,
    grid_update,
    koiter_return,
    mohr_coulomb,
    p2g,
    step,
    stress_update,
    weights,
)

E, NU = 10e6, 0.2
ELASTIC = ReferenceMaterial(E, NU)
SAND = ReferenceMaterial(E, NU, phi=np.radians(33.0))
H = 0.1


def points_at(x, v=None, sigma=None, grad_v=None):
    n, d = x.shape
    return ReferencePoints(
        x=x,
        v=np.zeros((n, d)) if v is None else v,
        grad_v=np.zeros((n, 3, 3)) if grad_v is None else grad_v,
        sigma=np.zeros((n, 3, 3)) if sigma is None else sigma,
        J=np.ones(n),
        opening=np.zeros(n),
        m=np.linspace(1.0, 2.0, n),
        V0=np.full(n, 1e-3),
        history=np.zeros((n, 2)),
        material=np.zeros(n, int),
    )


def grid_of(d):
    return ReferenceGrid(np.full(d, -0.2), H, (7, 6, 5)[:d])


def scattered(d, n=60, seed=1):
    """Positions everywhere in the grid, the cells at its walls included."""
    grid = grid_of(d)
    extent = H * (np.array(grid.n_nodes) - 1)
    return grid.origin + extent * np.random.default_rng(seed).random((n, d))


def scheme_of(d, **choices):
    return ReferenceScheme(**({"dt": 1e-4, "gravity": np.array([0.0, -9.81, 0.0])[:d]} | choices))


def free(grid):
    return np.zeros((*grid.n_nodes, len(grid.n_nodes)), bool)


def driven(points, material, L, steps, dt=1e-4, **choices):
    """One point under a prescribed velocity gradient."""
    scheme = scheme_of(2, dt=dt, **choices)
    points = replace(points, grad_v=np.array([L], float))
    for _ in range(steps):
        points = stress_update(points, [material], scheme)
    return points


def one_point(sigma=None, **state):
    return replace(points_at(np.zeros((1, 2)), sigma=None if sigma is None else np.array([sigma], float)), **state)


# ------------------------------------------------------------------------------------ shape functions


@pytest.mark.parametrize("d", [1, 2, 3])
def test_shape_functions_reproduce_constants_and_linear_fields_up_to_the_walls(d):
    grid = grid_of(d)
    x = scattered(d, 200)
    x[0], x[1] = grid.origin, grid.origin + H * (np.array(grid.n_nodes) - 1) - 1e-12
    nodes, w, grad = weights(x, grid.origin, H, grid.n_nodes)
    np.testing.assert_allclose(w.sum(1), 1.0, atol=1e-14)
    np.testing.assert_allclose(grad.sum(1), 0.0, atol=1e-12)
    x_i = grid.origin + H * nodes
    np.testing.assert_allclose(np.einsum("pi,pia->pa", w, x_i), x, atol=1e-14)
    np.testing.assert_allclose(
        np.einsum("pia,pib->pab", x_i, grad), np.broadcast_to(np.eye(d), (200, d, d)), atol=1e-12
    )
    assert np.all(w >= 0.0)


def test_truncated_spline_loses_the_partition_of_unity_only_at_walls():
    w = weights(np.array([[0.01], [0.06], [0.31]]), np.zeros(1), H, (7,), correct=False)[1].sum(1)
    np.testing.assert_allclose(w, [1.0 - 0.5 * 0.4**2, 1.0, 1.0])


def test_gradient_is_the_derivative_of_the_weight():
    x, step_ = np.array([[0.013, 0.22], [0.31, 0.07], [0.26, 0.37]]), 1e-7
    grad = weights(x, np.zeros(2), H, (7, 6))[2]
    for a in range(2):
        shift = step_ * np.eye(2)[a]
        plus, minus = (weights(x + sign * shift, np.zeros(2), H, (7, 6))[1] for sign in (1, -1))
        np.testing.assert_allclose((plus - minus) / (2 * step_), grad[:, :, a], atol=1e-6)


def test_correction_joins_the_spline_smoothly():
    left, right = (weights(np.array([[x]]), np.zeros(1), H, (7,)) for x in (0.05 - 1e-12, 0.05 + 1e-12))
    np.testing.assert_allclose(left[1][0, 1:], right[1][0, :2], atol=1e-10)
    np.testing.assert_allclose(left[2][0, 1:], right[2][0, :2], atol=1e-8)


def test_points_outside_the_grid_are_rejected():
    with pytest.raises(ValueError, match="outside"):
        weights(np.array([[-0.01]]), np.zeros(1), H, (7,))


# ------------------------------------------------------------------------------------------- transfers


@pytest.mark.parametrize("d", [2, 3])
def test_taylor_transfer_of_a_linear_velocity_is_exact(d):
    grid, x = grid_of(d), scattered(d)
    L = np.zeros((3, 3))
    L[:d, :d] = np.random.default_rng(2).normal(size=(d, d))
    v0 = np.arange(1.0, d + 1.0)
    points = points_at(x, v=v0 + x @ L[:d, :d].T, grad_v=np.broadcast_to(L, (len(x), 3, 3)))
    m, p, f = p2g(points, grid, scheme_of(d, gravity=np.zeros(d)))
    nodes = np.stack(np.meshgrid(*(np.arange(n) for n in grid.n_nodes), indexing="ij"), -1)
    exact = v0 + (grid.origin + H * nodes) @ L[:d, :d].T
    full = m > 1e-9
    np.testing.assert_allclose((p / np.where(m > 0.0, m, 1.0)[..., None])[full], exact[full], atol=1e-9)
    back = g2p(points, *grid_update(m, p, f, free(grid), scheme_of(d)), grid, scheme_of(d))
    np.testing.assert_allclose(back.grad_v, points.grad_v, atol=1e-8)
    np.testing.assert_allclose(back.v, points.v, atol=1e-12)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("taylor", [0.0, 1.0])
def test_momentum_is_conserved(d, taylor):
    rng, x = np.random.default_rng(3), scattered(d)
    sigma, L = rng.normal(size=(len(x), 3, 3)) * 1e4, np.zeros((len(x), 3, 3))
    L[:, :d, :d] = rng.normal(size=(len(x), d, d))
    points = points_at(x, v=rng.normal(size=x.shape), sigma=sigma + sigma.transpose(0, 2, 1), grad_v=L)
    grid, scheme = grid_of(d), scheme_of(d, taylor=taylor)
    m, p, f = p2g(points, grid, scheme)
    axes = tuple(range(d))
    np.testing.assert_allclose(m.sum(), points.m.sum())
    np.testing.assert_allclose(p.sum(axes), points.m @ points.v)
    np.testing.assert_allclose(f.sum(axes), points.m.sum() * scheme.gravity, atol=1e-9)
    after = g2p(points, *grid_update(m, p, f, free(grid), scheme), grid, scheme)
    expected = points.m @ points.v + scheme.dt * points.m.sum() * scheme.gravity
    np.testing.assert_allclose(after.m @ after.v, expected)


@pytest.mark.parametrize("d", [2, 3])
def test_free_fall_is_the_exact_parabola(d):
    grid = grid_of(d)
    x0 = grid.origin + H * np.array([2.6, 3.4, 2.2])[:d] + 0.04 * np.random.default_rng(4).random((20, d))
    v0, scheme = np.array([0.3, 0.5, -0.2])[:d], scheme_of(d, dt=2e-3)
    points = points_at(x0, v=np.broadcast_to(v0, x0.shape))
    for _ in range(10):
        points = step(points, grid, free(grid), [SAND], scheme)
    t = 10 * scheme.dt
    np.testing.assert_allclose(points.x, x0 + v0 * t + 0.5 * scheme.gravity * t**2, atol=1e-14)
    np.testing.assert_allclose(points.v, np.broadcast_to(v0 + scheme.gravity * t, x0.shape), atol=1e-13)
    np.testing.assert_allclose(points.J * (1.0 + points.opening), 1.0, atol=1e-12)


@pytest.mark.parametrize(("position", "share"), [(0.0, 1.0), (0.5, 0.5), (1.0, 0.0)])
def test_position_rules_differ_by_the_acceleration(position, share):
    grid, scheme = grid_of(2), scheme_of(2, position=position)
    moved = step(points_at(np.full((1, 2), 0.03)), grid, free(grid), [SAND], scheme)
    np.testing.assert_allclose(moved.x[0] - 0.03, share * scheme.dt**2 * scheme.gravity, atol=1e-15)


def test_damping_always_opposes_the_motion():
    f = np.array([[3.0, 3.0], [-3.0, -3.0], [3.0, 3.0]])
    p = np.array([[1.0, -1.0], [1.0, -1.0], [0.0, 0.0]])
    a = grid_update(np.ones(3), p, f, np.zeros((3, 2), bool), scheme_of(2, alpha_d=0.5))[1]
    np.testing.assert_allclose(a, [[1.5, 4.5], [-4.5, -1.5], [3.0, 3.0]])


@pytest.mark.parametrize(("wall_impulse", "expected"), [(True, -4e4), (False, 0.0)])
def test_fixed_nodes_are_at_rest_and_their_acceleration_includes_the_wall_impulse(wall_impulse, expected):
    fixed = np.array([[True, False]])
    scheme = scheme_of(2, wall_impulse=wall_impulse)
    v, a = grid_update(np.array([0.5]), np.array([[2.0, 2.0]]), np.array([[5.0, 5.0]]), fixed, scheme)
    np.testing.assert_allclose(v, [[0.0, 4.0 + 10.0 * scheme.dt]])
    np.testing.assert_allclose(a, [[expected, 10.0]])


def test_flip_fraction_blends_the_two_velocity_updates():
    x = scattered(2)
    points, grid = points_at(x, v=np.random.default_rng(5).normal(size=x.shape)), grid_of(2)
    nodal = grid_update(*p2g(points, grid, scheme_of(2)), free(grid), scheme_of(2))
    pic, half, flip = (g2p(points, *nodal, grid, scheme_of(2, flip_fraction=A)).v for A in (0.0, 0.5, 1.0))
    np.testing.assert_allclose(half, 0.5 * (pic + flip))
    np.testing.assert_allclose(flip, points.v + scheme_of(2).dt * np.array([0.0, -9.81]))
    assert np.abs(pic - flip).max() > 0.1


@pytest.mark.parametrize("J", [1.0, 1.3])
def test_internal_force_is_the_stress_times_the_present_volume(J):
    """The first moment of the nodal forces equals -V sigma."""
    grid, sigma = grid_of(2), np.broadcast_to(np.diag([2e3, 5e3, 0.0]), (1, 3, 3))
    point = replace(points_at(np.array([[0.05, 0.07]]), sigma=sigma), J=np.full(1, J))
    f = p2g(point, grid, scheme_of(2, gravity=np.zeros(2)))[2]
    x_i = grid.origin + H * np.moveaxis(np.indices(grid.n_nodes), 0, -1)
    np.testing.assert_allclose(np.einsum("ija,ijb->ab", f, x_i), -J * 1e-3 * np.diag([2e3, 5e3]), atol=1e-12)


# ---------------------------------------------------------------------------------------- axisymmetry


def test_uniform_radial_stretch_gives_equal_radial_and_hoop_rates():
    grid, a = ReferenceGrid(np.zeros(2), H, (7, 6)), 0.7
    x = H * (np.array([0.02, 0.0]) + np.array([5.98, 5.0]) * np.random.default_rng(6).random((40, 2)))
    points = points_at(x, v=a * x * [1.0, 0.0], grad_v=np.broadcast_to(np.diag([a, 0.0, a]), (40, 3, 3)))
    scheme = scheme_of(2, gravity=np.zeros(2), axisymmetric=True)
    moved = g2p(points, *grid_update(*p2g(points, grid, scheme), free(grid), scheme), grid, scheme)
    np.testing.assert_allclose(moved.grad_v, points.grad_v, atol=1e-9)


def test_axisymmetric_internal_force_does_the_work_of_the_stress():
    """-f . v = V sigma : D for every nodal velocity field: the hoop force is conjugate to the hoop strain."""
    grid, rng = ReferenceGrid(np.zeros(2), H, (7, 6)), np.random.default_rng(7)
    sigma = rng.normal(size=(1, 3, 3))
    sigma = sigma + sigma.transpose(0, 2, 1)
    points = points_at(np.array([[0.13, 0.32]]), sigma=sigma)
    scheme = scheme_of(2, gravity=np.zeros(2), axisymmetric=True)
    f, v = p2g(points, grid, scheme)[2], rng.normal(size=(7, 6, 2))
    L = g2p(points, v, np.zeros_like(v), grid, scheme).grad_v[0]
    np.testing.assert_allclose(-np.sum(f * v), points.V0[0] * np.sum(sigma[0] * L))


# --------------------------------------------------------------------------------------------- stress


def test_elastic_simple_shear_follows_the_jaumann_solution():
    end = driven(one_point(), ELASTIC, [[0, 1, 0], [0, 0, 0], [0, 0, 0]], steps=10_000)
    G, s = ELASTIC.G, end.sigma[0]
    np.testing.assert_allclose([s[0, 1], s[0, 0]], [G * np.sin(1.0), G * (1.0 - np.cos(1.0))], rtol=2e-4)


def test_oedometer_reaches_the_active_ratio_and_its_tangent():
    sand, rate = one_point(np.diag([-3e2, -1e3, -3e2])), np.diag([0.0, -1.0, 0.0])
    first = driven(sand, SAND, rate, steps=100, dt=1e-6)
    last = driven(first, SAND, rate, steps=100, dt=1e-6)
    s = np.diag(last.sigma[0])
    np.testing.assert_allclose([s[0] / s[1], s[2] / s[1]], 0.2948, atol=5e-5)
    np.testing.assert_allclose((first.sigma[0, 1, 1] - s[1]) / 1e-4, 10.485e6, rtol=1e-4)


def test_simple_shear_mobilises_sin_phi():
    sand = one_point(-1e3 * np.eye(3))
    s = driven(sand, SAND, [[0, 1, 0], [0, 0, 0], [0, 0, 0]], steps=2000, dt=1e-5).sigma[0]
    np.testing.assert_allclose(abs(s[0, 1] / s[1, 1]), 0.5446, atol=2e-4)
    np.testing.assert_allclose(np.trace(s), -3e3)


@pytest.mark.parametrize(("phi", "psi", "c"), [(33, 0, 0), (33, 0, 2e3), (39, 6, 0), (50, 25, 1e3), (30, 30, 0)])
def test_closed_form_return_is_the_koiter_return(phi, psi, c):
    phi, psi = np.radians([phi, psi])
    rng = np.random.default_rng(8)
    trial = 1e4 * (rng.normal(size=(300, 3)) + rng.normal(size=(300, 1)))
    koiter = koiter_return(trial, phi, psi, c, SAND.K, SAND.G)
    closed = [mohr_coulomb(np.diag(s), phi, psi, c / np.tan(phi), SAND.K, SAND.G)[0] for s in trial]
    np.testing.assert_allclose([np.diag(s) for s in closed], koiter, atol=1e-6)


def test_return_conserves_the_principal_directions():
    turn = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))[0]
    straight = mohr_coulomb(np.diag([-1.0, -2.0, -9.0]), 0.5, 0.1, 0.0, 3.0, 2.0)[0]
    turned = mohr_coulomb(turn @ np.diag([-1.0, -2.0, -9.0]) @ turn.T, 0.5, 0.1, 0.0, 3.0, 2.0)[0]
    np.testing.assert_allclose(turned, turn @ straight @ turn.T, atol=1e-13)


def test_softening_strain_is_the_path_length_in_tensor_shear():
    """Simple shear gamma adds |gamma| / sqrt(3), and the angles decay with it."""
    soft = replace(SAND, phi=np.radians(50.0), phi_residual=np.radians(33.0), rate=5.0)
    shear = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    there = driven(one_point(-1e3 * np.eye(3)), soft, shear, steps=1000)
    np.testing.assert_allclose(there.history[0, 0], 0.1 / np.sqrt(3.0), rtol=5e-3)
    back = driven(there, soft, -shear, steps=1000)
    np.testing.assert_allclose(back.history[0, 0], 0.2 / np.sqrt(3.0), rtol=5e-3)
    s, phi = np.linalg.eigvalsh(back.sigma[0]), soft.angles(back.history[0])[0]
    np.testing.assert_allclose(s[2] / s[0], (1 - np.sin(phi)) / (1 + np.sin(phi)), rtol=1e-3)


def test_angles_decay_from_peak_to_residual_with_the_softening_strain():
    soft = ReferenceMaterial(E, NU, phi=0.9, psi=0.4, phi_residual=0.6, psi_residual=0.1, rate=5.0)
    np.testing.assert_allclose(soft.angles(np.zeros(2)), (0.9, 0.4))
    np.testing.assert_allclose(soft.angles(np.array([np.log(2.0) / 5.0, 0.0])), (0.75, 0.25))
    np.testing.assert_allclose(soft.angles(np.array([100.0, 0.0])), (0.6, 0.1))


def test_a_point_of_a_random_field_has_its_own_friction_and_no_more_dilatancy() -> None:
    sand = ReferenceMaterial(1e6, 0.25, 0.6, 0.5)
    np.testing.assert_allclose(np.tan(sand.angles(np.array([0.0, 0.5]))[0]), 1.5 * np.tan(0.6))
    phi, psi = sand.angles(np.array([0.0, -0.5]))
    assert psi == phi == np.arctan(0.5 * np.tan(0.6))


# -------------------------------------------------------------------------------------------- opening


@pytest.mark.parametrize(("psi", "c"), [(0.0, 0.0), (0.1, 0.0), (0.0, 50.0)])
def test_opened_material_closes_before_it_carries_pressure(psi, c):
    sand, rate = replace(SAND, psi=psi, c=c), np.eye(3)
    apex = c / np.tan(SAND.phi) * np.eye(3)
    opened = driven(one_point(), sand, rate, steps=100)
    np.testing.assert_allclose(opened.sigma[0], apex, atol=1e-9)
    np.testing.assert_allclose(opened.J * (1 + opened.opening), (1 + 1e-4) ** 300)
    np.testing.assert_allclose(opened.J, 1.0, atol=1e-4)
    still = driven(opened, sand, -rate, steps=99)
    assert still.opening[0] > 0.0
    np.testing.assert_allclose(still.sigma[0], apex, atol=1e-9)
    closed = driven(still, sand, -rate, steps=20)
    assert closed.opening[0] == 0.0
    assert np.trace(closed.sigma[0]) < 0.0
    np.testing.assert_allclose(closed.J, still.J * (1 + still.opening) * (1 - 1e-4) ** 60)


def test_opening_is_the_strain_of_the_tension_cut_off_and_is_closed_by_compression():
    pressed = one_point(-10.0 * np.eye(3))
    opened = driven(pressed, SAND, np.eye(3), steps=1, dt=1e-5)
    np.testing.assert_allclose(opened.opening, 3e-5 - 10.0 / SAND.K)
    closed = driven(opened, SAND, -np.eye(3), steps=1, dt=1e-5)
    p = SAND.K * ((1.0 + opened.opening[0]) * (1.0 - 1e-5) ** 3 - 1.0)
    np.testing.assert_allclose(closed.sigma[0], p * np.eye(3), atol=1e-8)


def test_without_opening_strain_the_volume_grows_and_compression_causes_pressure_at_once():
    opened = driven(one_point(), SAND, np.eye(3), steps=100, opening_strain=False)
    np.testing.assert_allclose(opened.J, (1 + 1e-4) ** 300)
    assert opened.opening[0] == 0.0
    assert np.trace(driven(opened, SAND, -np.eye(3), steps=1, opening_strain=False).sigma[0]) < 0.0


def test_elastic_material_never_opens():
    stretched = driven(one_point(), ELASTIC, np.eye(3), steps=10)
    assert stretched.opening[0] == 0.0
    assert np.trace(stretched.sigma[0]) > 0.0


@pytest.mark.parametrize(("psi", "c"), [(0.0, 0.0), (0.2, 0.0), (0.1, 1e3)])
def test_total_volume_ratio_is_the_product_of_the_increments(psi, c):
    rng, scheme, sand = np.random.default_rng(10), scheme_of(2), replace(SAND, psi=psi, c=c)
    points, whole, opened = one_point(), 1.0, 0
    pulsation = np.sin(np.arange(500) / 40.0)[:, None, None] * np.eye(3)
    for L in 20.0 * (rng.normal(size=(500, 3, 3)) + pulsation):
        points = stress_update(replace(points, grad_v=L[None]), [sand], scheme)
        whole *= np.linalg.det(np.eye(3) + scheme.dt * L)
        opened += points.opening[0] > 0.0
        np.testing.assert_allclose(points.J * (1.0 + points.opening), whole)
    assert 0 < opened < 500
