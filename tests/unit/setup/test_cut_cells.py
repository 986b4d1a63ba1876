"""Volumes of points in cells that an outline cuts, and the weight above them."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.case import load_case
from mpmcol.case.outline import Outline, area
from mpmcol.errors import UsageError
from mpmcol.mpm.particles import BASE
from mpmcol.setup.column_shape import column_shape
from mpmcol.setup.cut_cells import _volumes, material_above, point_shares
from mpmcol.setup.discretization import discretize, require_thick_outline
from mpmcol.setup.model import build_model

HEAP: Outline = ((0.0, 0.0), (0.3, 0.0), (0.0, 0.11))
TRAPEZOID: Outline = ((0.0, 0.0), (0.3, 0.0), (0.3, 0.13), (0.1, 0.13))
EMBANKMENT: Outline = ((0.05, 0.0), (0.33, 0.0), (0.25, 0.13), (0.2, 0.04), (0.1, 0.09))  # with a notch
ANGLES = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
DISC: Outline = tuple((0.1 + 0.1 * np.cos(t), 0.1 + 0.1 * np.sin(t)) for t in ANGLES)
OUTLINES = [HEAP, TRAPEZOID, EMBANKMENT, DISC]


def case_of(outline: Outline, *overrides: str):  # type: ignore[no-untyped-def]
    points = [[max(float(c), 0.0) for c in point] for point in outline]
    lowest = min(y for _, y in points)
    text = str([[x, y - lowest] for x, y in points])
    return load_case("coarse-channel", [f"geometry.outline={text}", *overrides])


def first_moment(outline: Outline) -> float:
    """Integral of x over a polygon."""
    x, y = np.array(outline).T
    next_x, next_y = np.roll(x, -1), np.roll(y, -1)
    return float(np.sum((x * next_y - next_x * y) * (x + next_x)) / 6.0)


@pytest.mark.parametrize("outline", OUTLINES, ids=["heap", "trapezoid", "embankment", "disc"])
@pytest.mark.parametrize("model", ["plane", "axisymmetric"])
def test_the_mass_is_exact_and_no_point_is_small(outline: Outline, model: str) -> None:
    case = case_of(outline, f"geometry.model={model}", "material.density=1000")
    made, given = build_model(case), case.geometry.outline
    assert given is not None
    exact = area(given) if model == "plane" else first_moment(given)
    assert made.column_mass == pytest.approx(1000.0 * exact, rel=1e-13)
    shares = made.discretization.outline_shares()
    assert shares[shares > 0.0].min() > 0.5 - 1e-9 and shares.max() < 3.0
    assert made.column_points == np.count_nonzero(shares)
    counted = made.discretization.most_points - np.count_nonzero(made.points.kind == BASE)
    assert made.column_points == pytest.approx(counted, rel=0.02)


def test_small_parts_are_added_to_the_nearest_point() -> None:
    """A slope of 1:2 over four cells: its cells hold 1, 1, 0.75 and 0.25, and above them 0.75 and 0.25."""
    lines = np.arange(5.0)
    shares = point_shares(((0.0, 0.0), (4.0, 0.0), (0.0, 2.0)), lines, lines[:3], per_radian=False)
    assert shares[:, 0] == pytest.approx([1.0, 1.25, 1.0, 0.0], abs=1e-12)
    assert shares[:, 1] == pytest.approx([0.75, 0.0, 0.0, 0.0], abs=1e-12)


def test_volumes_per_radian_of_a_cone() -> None:
    """A cone of radius and height 4 has the volume 4^3 / 6; its tip, 1 / 6, is added to the cell below of 1 / 2."""
    lines = np.arange(5.0)
    shares = point_shares(((0.0, 0.0), (4.0, 0.0), (0.0, 4.0)), lines, lines, per_radian=True)
    volume = shares * (lines[:-1] + 0.5)[:, None]
    assert volume.sum() == pytest.approx(4.0**3 / 6.0, rel=1e-14)
    assert shares[0, :3] == pytest.approx([1.0, 1.0, 1.0 + (1.0 / 6.0) / 0.5], abs=1e-12)


def test_a_rectangle_has_full_cells() -> None:
    case = case_of(((0.0, 0.0), (0.31, 0.0), (0.31, 0.1), (0.0, 0.1)))
    assert (discretize(case).outline_shares() == 1.0).all()


def test_the_material_above_a_point_is_that_of_the_outline_without_its_gaps() -> None:
    x, y = np.array([0.1, 0.2, 0.25, 0.0, 0.4]), np.array([0.0, 0.02, 0.05, 0.01, 0.0])
    assert material_above(HEAP, x, y) == pytest.approx([0.11 * 2 / 3, 0.11 / 3 - 0.02, 0.0, 0.1, 0.0])
    arch: Outline = ((0.0, 0.0), (0.1, 0.0), (0.1, 0.2), (0.2, 0.2), (0.2, 0.0), (0.3, 0.0), (0.3, 0.3), (0.0, 0.3))
    assert material_above(arch, np.full(3, 0.15), np.array([0.0, 0.1, 0.25])) == pytest.approx([0.1, 0.1, 0.05])


@pytest.mark.parametrize("base", ["elastic", "rigid"])
def test_the_initial_stress_is_the_weight_above(base: str) -> None:
    made = build_model(case_of(HEAP, "stages.initial_stress=k0", "stages.k0=0.4", f"geometry.base={base}"))
    column = made.points.kind != BASE
    x, y = made.points.x[column].T
    weight = 9.81 * made.points.m[column][0] / made.points.V0[column][0] * np.maximum(0.11 * (1.0 - x / 0.3) - y, 0.0)
    assert made.points.sigma[column, 1] == pytest.approx(-weight, abs=1e-9)
    assert made.points.sigma[column, 0] == pytest.approx(-0.4 * weight, abs=1e-9)


@pytest.mark.parametrize("outline", OUTLINES, ids=["heap", "trapezoid", "embankment", "disc"])
@pytest.mark.parametrize("model", ["plane", "axisymmetric"])
def test_the_potential_energy_is_that_of_the_points(outline: Outline, model: str) -> None:
    case = case_of(outline, f"geometry.model={model}", "grid.spacing=0.004")
    made = build_model(case)
    column = made.points.kind != BASE
    points = 9.81 * float(np.sum(made.points.m[column] * made.points.x[column, 1]))
    assert column_shape(case, made.discretization).potential_energy(9.81) == pytest.approx(points, rel=3e-3)


@pytest.mark.parametrize(
    "outline", [((0.0, 0.0), (0.3, 0.0), (0.0, 0.001)), ((0.0, 0.0), (1.0, 0.0), (0.1, 0.01), (0.0, 0.1))]
)
def test_an_outline_that_is_too_thin_for_the_points_is_refused(outline: Outline) -> None:
    case = case_of(outline, "grid.spacing=0.0009" if outline[2][0] == 0.0 else "grid.spacing=0.02")
    message = "geometry.outline is thinner than half the distance between points"
    with pytest.raises(UsageError, match=message):
        build_model(case)
    with pytest.raises(UsageError, match=message):
        require_thick_outline(discretize(case))


@pytest.mark.parametrize("spacing", [0.02, 0.01, 0.006])
def test_the_mass_of_a_column_with_vertical_sides_is_exact(spacing: float) -> None:
    """Plane strain: rho h_i (r_i - h_i tan(slope) / 2)."""
    case = load_case("inclined-channel", ["geometry.sides=vertical", f"grid.spacing={spacing}"])
    made, size = build_model(case), case.geometry
    exact = 1550.0 * size.h_i * (size.r_i - 0.5 * size.h_i * np.tan(np.radians(10.0)))
    assert made.column_mass == pytest.approx(exact, rel=1e-13)
    potential = 9.81 * np.cos(np.radians(10.0)) * float(made.points.m @ made.points.x[:, 1])
    assert column_shape(case, made.discretization).potential_energy(9.81) == pytest.approx(potential, rel=0.01)


@pytest.mark.parametrize("model", ["plane", "axisymmetric"])
@pytest.mark.parametrize("outline", [HEAP, TRAPEZOID, EMBANKMENT], ids=["heap", "trapezoid", "embankment"])
def test_layers_of_an_outline_have_their_exact_mass_weight_and_energy(outline: Outline, model: str) -> None:
    """Whole rows of points: the mass of a layer is its density times the area of the outline between its ends."""
    size = discretize(case_of(outline, "grid.spacing=0.006", f"geometry.model={model}"))
    lines = size.row_height * np.arange(size.rows + 1)
    text = ", ".join(
        f"{{ from = {lines[low]}, to = {lines[high]}, material = {{ density = {density} }} }}"
        for low, high, density in ((0, 4, 2000.0), (6, 8, 3000.0))
    )
    case = case_of(
        outline, "grid.spacing=0.006", f"geometry.model={model}", "geometry.base=rigid", "material.density=1000",
        f"layers=[{text}]", "stages.initial_stress=k0",
    )  # fmt: skip
    made = build_model(case)
    volumes = _volumes(outline, np.array([0.0, size.r_i]), lines, 1 if model == "plane" else 2)[0]
    for kind, rows in ((2, slice(0, 4)), (3, slice(6, 8))):
        density = case.materials[kind].density
        assert made.points.m[made.points.kind == kind].sum() == pytest.approx(density * volumes[rows].sum(), rel=1e-12)
    potential = 9.81 * float(made.points.m @ made.points.x[:, 1])
    assert column_shape(case, made.discretization).potential_energy(9.81) == pytest.approx(potential, rel=0.01)
    lowest = made.points.x[:, 1] < 1.01 * made.points.x[:, 1].min()
    x, y = made.points.x[lowest].T
    above = [material_above(outline, x, np.maximum(y, end)) for end in (0.0, *lines[[4, 6, 8]])]
    weight = 9.81 * (2000.0 * (above[0] - above[1]) + 1000.0 * (above[1] - above[2] + above[3]))
    weight += 9.81 * 3000.0 * (above[2] - above[3])
    np.testing.assert_allclose(made.points.sigma[lowest, 1], -weight, rtol=1e-12, atol=1e-9)
