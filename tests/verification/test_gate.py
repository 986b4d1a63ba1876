"""Columns in three dimensions and their gates: volumes, held nodes, and the opening of the gate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.failure_modes.toolkit import G, advance_to, by_id
from mpmcol.mpm.grid import NODE, Grid, node_coordinates
from mpmcol.mpm.particles import BASE
from mpmcol.mpm.solver import Solver
from mpmcol.setup.discretization import Discretization
from mpmcol.setup.model import Model, build_model, set_boundaries
from mpmcol.simulation.run import start
from mpmcol.simulation.stages import Stages

H, RADIUS, HEIGHT, DEPTH, DENSITY = 0.02, 0.1, 0.0875, 0.06, 2650.0
ROWS = 9  # rows of points over the height, which is not a multiple of half a cell
CYLINDER = ("geometry.section=cylinder",)
BOX = ("geometry.section=box", f"geometry.depth={DEPTH}")
SECTIONS = pytest.mark.parametrize("section", [CYLINDER, BOX], ids=["cylinder", "box"])
MODELS = pytest.mark.parametrize(("kind", "quarters"), [("quarter", 1), ("full", 4)])


def case_of(kind: str, section: tuple[str, ...], *more: str) -> mpmcol.Case:
    keys = [f"geometry.model={kind}", f"geometry.radius={RADIUS}", f"geometry.aspect={HEIGHT / RADIUS}"]
    law = ["stages.equilibrate.law=mohr-coulomb", "stages.initial_stress=k0"]
    return mpmcol.load_case("lube-quarter", [*keys, *section, *law, f"grid.spacing={H}", *more])


def model_of(kind: str, section: tuple[str, ...], *more: str) -> Model:
    return build_model(case_of(kind, section, *more))


@MODELS
@pytest.mark.parametrize("depth", [DEPTH, 0.14], ids=["narrow", "wide"])
def test_a_box_has_its_exact_volume(kind: str, quarters: int, depth: float) -> None:
    model = model_of(kind, ("geometry.section=box", f"geometry.depth={depth}"))
    column = model.points.kind != BASE
    assert model.column_mass == pytest.approx(quarters * DENSITY * RADIUS * depth * HEIGHT, rel=1e-12)
    size = model.discretization.point_size / 2.0
    np.testing.assert_allclose(
        model.points.x[column].max(axis=0), [RADIUS - size, HEIGHT - 0.5 * HEIGHT / ROWS, depth - size], rtol=1e-12
    )


@MODELS
@pytest.mark.parametrize("h", [0.02, 0.01, 0.005])
def test_the_volume_of_a_cylinder_converges(kind: str, quarters: int, h: float) -> None:
    """Points on a square lattice approximate the circle; the error decreases faster than their distance."""
    model = model_of(kind, CYLINDER, f"grid.spacing={h}")
    exact = quarters * DENSITY * 0.25 * np.pi * RADIUS**2 * HEIGHT
    size = model.discretization.point_size
    assert abs(model.column_mass / exact - 1.0) < 0.5 * (size / RADIUS) ** 1.3
    column = model.points.kind != BASE
    assert RADIUS - size < np.hypot(*model.points.x[column][:, ::2].T).max() < RADIUS


def held_by(grid: Grid) -> np.ndarray:
    """Held components of the nodal velocity (n_x, n_y, n_z, 3)."""
    address = grid.ax[:, None, None] + grid.ay[:, None] + grid.az
    return (grid.fixed[address // NODE][..., None] >> np.arange(3)) % 2 == 1


def gate_heights(model: Model) -> np.ndarray:
    """Heights (n,) above the floor at which any node away from walls and open ends is held."""
    inner = slice(5 if model.discretization.is_full else 1, -5)
    y, held = node_coordinates(model.grid)[1].ravel(), held_by(model.grid)[inner, :, inner]
    return y[held.any(axis=(0, 2, 3)) & (y > -model.discretization.base + 1e-9)]


def expected_at(x: float, y: float, z: float, lengths: Discretization, opening: float) -> tuple[bool, bool, bool]:
    """Held components at one node, by the definition of the boundaries."""
    near = 1e-9
    if y < -lengths.base + near:
        return True, True, True
    low = -lengths.length if lengths.is_full else 0.0
    hold_x, hold_z = (c < low + near or c > lengths.length - near for c in (x, z))
    if y > near:  # the last four cells before an open end
        hold_x, hold_z = hold_x or abs(x) > lengths.length - 4.5 * H, hold_z or abs(z) > lengths.length - 4.5 * H
    if y > near and y > opening - near:
        if lengths.shape == "cylinder":
            beyond = x**2 + z**2 > (RADIUS - near) ** 2
            hold_x, hold_z = hold_x or beyond, hold_z or beyond
        else:
            hold_x, hold_z = hold_x or abs(x) > RADIUS - near, hold_z or abs(z) > DEPTH - near
    return hold_x, False, hold_z


@SECTIONS
@pytest.mark.parametrize("kind", ["quarter", "full"])
@pytest.mark.parametrize("base", ["elastic", "rigid"])
@pytest.mark.parametrize("opening", [0.0, 0.05, np.inf], ids=["closed", "half open", "open"])
def test_walls_ends_and_gate_hold_the_defined_nodes(
    section: tuple[str, ...], kind: str, base: str, opening: float
) -> None:
    model = model_of(kind, section, f"geometry.base={base}", "geometry.domain_length=0.3")
    set_boundaries(model.grid, model.discretization, opening)
    xs, ys, zs = (axis.ravel() for axis in node_coordinates(model.grid))
    expected = [[[expected_at(x, y, z, model.discretization, opening) for z in zs] for y in ys] for x in xs]
    np.testing.assert_array_equal(held_by(model.grid), np.array(expected))


@SECTIONS
def test_the_gate_opens_from_below(section: tuple[str, ...]) -> None:
    model = model_of("full", section)
    y = node_coordinates(model.grid)[1].ravel()
    for opening in (*np.arange(0.0, HEIGHT + 3 * H, 0.005), np.inf):
        set_boundaries(model.grid, model.discretization, opening)
        np.testing.assert_array_equal(gate_heights(model), y[(y > 1e-9) & (y > opening - 1e-9)])


@SECTIONS
def test_the_gate_rises_at_its_speed(section: tuple[str, ...], tmp_path: Path) -> None:
    """The held nodes are recorded at every progress report of a run."""
    speed, seen = 0.8, []

    def record(stage: str, share: float) -> None:
        if stage == "collapse" and share > 0.0:
            seen.append((stages.solver.time, gate_heights(stages.model)))

    short = (f"stages.gate_speed={speed}", "stages.collapse.max_time_factor=0.2", "output.snapshots=1")
    case = case_of("quarter", section, *short)
    stages = Stages(start(case, build_model(case), tmp_path / "run", show_progress=record))
    stages.release()
    stages.collapse()
    y = node_coordinates(stages.model.grid)[1].ravel()
    assert seen[-1][0] * speed > HEIGHT
    for time, heights in seen:
        np.testing.assert_array_equal(heights, y[(y > 1e-9) & (y > speed * time - 1e-9)])


def opened(section: tuple[str, ...], opening: float, duration: float) -> tuple[Model, np.ndarray]:
    """The model, and the positions of its column after `duration` sqrt(h_i / g) behind a gate open up to `opening`."""
    model = model_of("quarter", section)
    set_boundaries(model.grid, model.discretization, opening)
    solver = Solver(model.points, model.grid, model.collapse.settings, model.collapse.column, model.base)
    advance_to(solver, duration * model.discretization.fall_time(G))
    points = by_id(solver)
    return model, points.x[points.kind != BASE]


def beyond(model: Model, x: np.ndarray) -> np.ndarray:
    """Distance of points from the initial surface of the column, m; positive outside."""
    if model.discretization.shape == "cylinder":
        return np.hypot(x[:, 0], x[:, 2]) - RADIUS
    return np.maximum(x[:, 0] - RADIUS, x[:, 2] - DEPTH)


@SECTIONS
def test_a_closed_gate_holds_the_column(section: tuple[str, ...]) -> None:
    model, x = opened(section, 0.0, 1.0)
    assert beyond(model, x).max() < 0.0
    assert x[:, 1].max() > 0.97 * (HEIGHT - 0.005)


@SECTIONS
def test_a_partly_open_gate_releases_only_material_below_it(section: tuple[str, ...]) -> None:
    """And less of it than without a gate."""
    model, x = opened(section, 0.07, 2.0)
    out, above = beyond(model, x), x[:, 1] > 0.07
    assert np.any(above) and out[above].max() < 0.0
    assert out.max() > 0.5 * H
    model, x = opened(section, np.inf, 2.0)
    assert beyond(model, x).max() > 1.5 * out.max()
