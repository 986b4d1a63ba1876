"""Element tests in 3D in rotated axes: rigid rotation, and Mohr-Coulomb in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import K_ACTIVE, NU, PHI, WEIGHTLESS, E, elastic_body, sand_body
from mpmcol.mpm.solver import Body
from tests.support.strain_path import make_path

N_PHI = 1.0 / K_ACTIVE
G2 = E / (1.0 + NU)
P = 1e4  # Pa, pressure at the start
SIX = ((0, 1, 2, 0, 1, 0), (0, 1, 2, 1, 2, 2))  # xx yy zz xy yz xz
AXIS = np.array([1.0, -2.0, 3.0]) / np.sqrt(14.0)
BODIES = pytest.mark.parametrize("body", [elastic_body(), sand_body()], ids=["elastic", "mohr-coulomb"])


def spin(axis: np.ndarray) -> np.ndarray:
    """Velocity gradient of a rotation about `axis` with unit angular velocity."""
    x, y, z = axis
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rotation(angle: float, axis: np.ndarray) -> np.ndarray:
    """Rotation matrix (Rodrigues' formula)."""
    w = spin(axis)
    return np.eye(3) + np.sin(angle) * w + (1.0 - np.cos(angle)) * w @ w


ROTATIONS = {
    "principal axes": np.eye(3),
    "about x": rotation(0.7, np.array([1.0, 0.0, 0.0])),
    "about y": rotation(2.0, np.array([0.0, 1.0, 0.0])),
    "about z": rotation(-1.1, np.array([0.0, 0.0, 1.0])),
    "oblique": rotation(0.9, AXIS),
    "oblique, large": rotation(2.6, AXIS[[2, 0, 1]]),
}
ROTATED = pytest.mark.parametrize("R", ROTATIONS.values(), ids=ROTATIONS)


def driven(body: Body, strain: np.ndarray, steps: int, sigma: np.ndarray) -> tuple[np.ndarray, float]:
    """Stress (3, 3) and J after `steps` steps with a total of dt L = `strain` (3, 3), from stress `sigma` (3, 3)."""
    gradient, start = tuple(strain.reshape(-1).tolist()), tuple(sigma[SIX].tolist())
    end, J = make_path(3, body.law)(start, gradient, body.params, WEIGHTLESS, steps)
    xx, yy, zz, xy, yz, xz = end
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), J


@BODIES
@pytest.mark.parametrize("axis", [*np.eye(3), AXIS], ids=["x", "y", "z", "oblique"])
def test_rotation_keeps_the_principal_stresses(body: Body, axis: np.ndarray) -> None:
    start = np.array([[-3e4, 4e3, -2e3], [4e3, -5e4, 1e3], [-2e3, 1e3, -4e4]])
    angle, steps = 1.2, 20_000
    sigma, J = driven(body, angle * spin(axis), steps, start)
    R = rotation(angle, axis)
    np.testing.assert_allclose(sigma, R @ start @ R.T, atol=2e-4 * 5e4)
    # Eq. 29 drifts in rotation, since det(I + dt L) > 1
    assert pytest.approx((1.0 + (angle / steps) ** 2) ** steps, rel=1e-10) == J


@ROTATED
def test_simple_shear_is_objective(R: np.ndarray) -> None:
    """With the Jaumann rate elastic shear oscillates: sin(gamma), 1 - cos(gamma)."""
    gamma, shear = 2.0, 0.5 * G2
    strain = R @ [[0.0, gamma, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]] @ R.T
    sigma, J = driven(elastic_body(), strain, 20_000, np.zeros((3, 3)))
    xx, yy, zz, xy, yz, xz = (R.T @ sigma @ R)[SIX] / shear
    assert [xy, xx, yy] == pytest.approx([np.sin(gamma), 1.0 - np.cos(gamma), np.cos(gamma) - 1.0], abs=1e-3 * gamma)
    np.testing.assert_allclose([zz, yz, xz], 0.0, atol=1e-10)
    assert pytest.approx(1.0, abs=1e-10) == J


def at_failure(strain: np.ndarray) -> np.ndarray:
    """Principal stresses of sand at yield after a large isochoric principal strain, from pressure P.

    With psi = 0 neither elastic nor plastic strain changes the mean stress. On a face of the yield
    surface the intermediate stress keeps its elastic value; on an edge two stresses are equal (triaxial paths).
    """
    order = np.argsort(-strain)
    e1, e2, e3 = strain[order]
    if e1 == e2:
        s1 = s2 = -3.0 * P / (2.0 + N_PHI)
    elif e2 == e3:
        s1 = -3.0 * P / (1.0 + 2.0 * N_PHI)
        s2 = N_PHI * s1
    else:
        s2 = -P + G2 * e2
        s1 = (-3.0 * P - s2) / (1.0 + N_PHI)
    s3 = N_PHI * s1
    assert s1 >= s2 >= s3
    out = np.empty(3)
    out[order] = s1, s2, s3
    return out


PATHS = {
    "compression": (0.002, -0.004, 0.002),
    "extension": (-0.002, 0.004, -0.002),
    "plane": (0.003, -0.003, 0.0),
    "true triaxial": (0.0035, -0.0038, 0.0003),
    "true triaxial, along z": (-0.0002, 0.0032, -0.0030),
}


@ROTATED
@pytest.mark.parametrize("strain", PATHS.values(), ids=PATHS)
def test_triaxial_paths_end_at_the_closed_form(strain: tuple[float, float, float], R: np.ndarray) -> None:
    """Triaxial and true triaxial paths at constant volume, in principal and in rotated axes."""
    principal = np.array(strain)
    path, start = R @ np.diag(principal) @ R.T, -P * np.eye(3)
    expected = R @ np.diag(at_failure(principal)) @ R.T
    sigma, _ = driven(sand_body(), path, 200, start)
    np.testing.assert_allclose(sigma, expected, atol=1e-9 * P)
    one_step, _ = driven(sand_body(), path, 1, start)
    np.testing.assert_allclose(one_step, expected, atol=1e-9 * P)


@ROTATED
@pytest.mark.parametrize("dilatancy_deg", [0.0, 15.0, PHI])
def test_the_return_mapping_is_the_same_in_rotated_axes(R: np.ndarray, dilatancy_deg: float) -> None:
    """Random trial stresses with cohesion and dilatancy cover the face, both edges and the apex."""
    rng = np.random.default_rng(5)
    body = sand_body(dilatancy_deg=dilatancy_deg, cohesion=500.0)
    for _ in range(200):
        start, strain = np.diag(rng.uniform(-2.0 * P, 0.0, 3)), np.diag(rng.normal(0.0, 2e-3, 3))
        expected, J = driven(body, strain, 1, start)
        sigma, J_rotated = driven(body, R @ strain @ R.T, 1, R @ start @ R.T)
        np.testing.assert_allclose(sigma, R @ expected @ R.T, atol=1e-8 * P)
        assert J_rotated == pytest.approx(J, rel=1e-12)


@ROTATED
def test_oedometer_stays_at_active_yield(R: np.ndarray) -> None:
    n = R[:, 1]
    sigma, _ = driven(sand_body(), -0.004 * np.outer(n, n), 1000, np.zeros((3, 3)))
    across, vertical = R.T @ sigma @ R @ [1.0, 0.0, 0.0], n @ sigma @ n
    assert across[0] / vertical == pytest.approx(K_ACTIVE, rel=1e-9)
    np.testing.assert_allclose(across[1:] / vertical, 0.0, atol=1e-9)


@ROTATED
def test_a_wrong_friction_angle_is_detected(R: np.ndarray) -> None:
    principal = np.array(PATHS["true triaxial"])
    sigma, _ = driven(sand_body(friction_deg=30.0), R @ np.diag(principal) @ R.T, 200, -P * np.eye(3))
    assert np.abs(R.T @ sigma @ R - np.diag(at_failure(principal))).max() > 0.02 * P
