"""Projection, completion by symmetry, hidden points and silhouettes of the 3D views."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.plotting.render.projection import (
    HIDDEN_DEPTH,
    TOP,
    circle,
    complete_by_symmetry,
    silhouette,
    view_projection,
    visible,
)

SIZE = 0.01


def lattice(x: int, y: int, z: int) -> np.ndarray:
    """Centres of x * y * z cubes of SIZE, the first corner in the origin."""
    grids = np.meshgrid(*(SIZE * (np.arange(n) + 0.5) for n in (x, y, z)), indexing="ij")
    return np.column_stack([grid.ravel() for grid in grids])


def area(outline: np.ndarray) -> float:
    x, y = outline.T
    return 0.5 * abs(float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])))


@pytest.mark.parametrize(("azimuth", "elevation"), [(0, 0), (35, 28), (225, -10), (0, 90)])
def test_projection_is_a_rotation(azimuth: float, elevation: float):
    projection = view_projection(azimuth, elevation)
    assert projection @ projection.T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(projection) == pytest.approx(1)
    assert projection[0, 1] == 0  # horizontal lengths across the image are preserved


def test_viewing_direction_has_the_given_angles():
    assert view_projection(0, 0) == pytest.approx(np.eye(3))
    assert view_projection(90, 0)[2] == pytest.approx([1, 0, 0])
    assert view_projection(-90, 90) == pytest.approx(TOP)
    assert view_projection(45, 30)[2] == pytest.approx(np.array([np.sqrt(1.5), 1, np.sqrt(1.5)]) / 2)


def test_the_view_from_above_is_not_mirrored():
    right, up, toward = TOP
    assert np.cross(right, up) == pytest.approx(toward) and toward == pytest.approx([0, 1, 0])
    assert right == pytest.approx([0, 0, 1]) and up == pytest.approx([1, 0, 0])  # z to the right, x upward


def test_quarter_is_mirrored_at_both_symmetry_planes():
    x, index = complete_by_symmetry(np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]), "quarter")
    expected = {(i * a, b, k * c) for a, b, c in ((1, 2, 3), (4, 5, 6)) for i in (-1, 1) for k in (-1, 1)}
    assert {tuple(point) for point in x} == expected
    assert np.abs(x[:, 0]) == pytest.approx(np.array([1, 4])[index])


def test_full_model_is_unchanged():
    points = lattice(3, 2, 3) - 0.01
    x, index = complete_by_symmetry(points, "full")
    assert np.array_equal(x, points) and np.array_equal(index, np.arange(len(points)))


def test_inner_points_are_hidden():
    block = lattice(20, 20, 20)
    for projection in (TOP, view_projection(35, 28)):
        projected = block @ projection.T
        seen = visible(projected, SIZE)
        facing = ((block > SIZE * 19) & (projection[2] > 1e-9)).any(axis=1)
        assert seen[facing].all()
        depth = np.min((SIZE * 19.5 - block) / np.maximum(projection[2], 1e-9), axis=1)  # behind the nearest face
        assert not seen[depth > (HIDDEN_DEPTH + 4) * SIZE].any() and seen.mean() < 0.6


def test_points_at_the_bottom_of_a_hole_are_visible():
    block = lattice(20, 20, 20)
    in_hole = (np.abs(block[:, [0, 2]] - 10 * SIZE) < 3 * SIZE).all(axis=1)
    block = block[~in_hole | (block[:, 1] < SIZE)]
    at_bottom = (np.abs(block[:, [0, 2]] - 10 * SIZE) < 3 * SIZE).all(axis=1)
    seen = visible(block @ TOP.T, SIZE)
    assert at_bottom.sum() == 36 and seen[at_bottom].all()
    assert not seen[(block[:, 1] < SIZE) & (np.abs(block[:, 0] - 10 * SIZE) > 5 * SIZE)].any()


def test_silhouette_of_a_cube():
    cube = lattice(10, 10, 10)
    edge = 10 * SIZE
    assert area(silhouette(cube, TOP, SIZE)) == pytest.approx(edge**2)
    corner = view_projection(45, np.degrees(np.arctan(np.sqrt(0.5))))  # along the diagonal it is a regular hexagon
    assert area(silhouette(cube, corner, SIZE)) == pytest.approx(np.sqrt(3) * edge**2)


def test_silhouette_of_a_cylinder():
    rims = np.concatenate([circle(0.3, 0.0), circle(0.3, 0.5)])
    assert area(silhouette(rims, TOP, 0.0)) == pytest.approx(np.pi * 0.09, rel=1e-3)
    assert area(silhouette(rims, view_projection(20, 0), 0.0)) == pytest.approx(0.6 * 0.5, rel=1e-3)
    slanted = np.pi * 0.09 * np.sin(0.5) + 0.6 * 0.5 * np.cos(0.5)  # both ends make one ellipse
    assert area(silhouette(rims, view_projection(20, np.degrees(0.5)), 0.0)) == pytest.approx(slanted, rel=1e-3)
