"""Columns in space and their gates: volumes, the nodes that are held, and a gate on its way up."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.failure_modes.toolkit import G, advance_to, by_id
from mpmcol.mpm.grid import NODE, Grid, node_coordinates
from mpmcol.mpm.particles import BASE
from mpmcol.mpm.solver import Solver
from mpmcol.setup.discretization import Layout
from mpmcol.setup.model import Scene, build_scene, close_walls
from mpmcol.simulation.run import set_up

H, RADIUS, HEIGHT, DEPTH, DENSITY = 0.02, 0.1, 0.0875, 0.06, 2650.0
ROWS = 9  # of points over the height, which is not a whole number of half cells
CYLINDER = ("geometry.section=cylinder",)
BOX = ("geometry.section=box", f"geometry.depth={DEPTH}")
SECTIONS = pytest.mark.parametrize("section", [CYLINDER, BOX], ids=["cylinder", "box"])
MODELS = pytest.mark.parametrize(("model", "quarters"), [("quarter", 1), ("full", 4)])


def case_of(model: str, section: tuple[str, ...], *more: str) -> mpmcol.Case:
    keys = [f"geometry.model={model}", f"geometry.radius={RADIUS}", f"geometry.aspect={HEIGHT / RADIUS}"]
    law = ["stages.equilibrate.law=mohr-coulomb", "stages.initial_stress=k0"]
    return mpmcol.load_case("lube-quarter", [*keys, *section, *law, f"grid.spacing={H}", *more])


def scene_of(model: str, section: tuple[str, ...], *more: str) -> Scene:
    return build_scene(case_of(model, section, *more))


@MODELS
@pytest.mark.parametrize("depth", [DEPTH, 0.14], ids=["narrow", "wide"])
def test_a_box_holds_its_volume(model: str, quarters: int, depth: float) -> None:
    scene = scene_of(model, ("geometry.section=box", f"geometry.depth={depth}"))
    column = scene.points.kind != BASE
    assert scene.column_mass == pytest.approx(quarters * DENSITY * RADIUS * depth * HEIGHT, rel=1e-12)
    size = scene.layout.point_size / 2.0
    np.testing.assert_allclose(
        scene.points.x[column].max(axis=0), [RADIUS - size, HEIGHT - 0.5 * HEIGHT / ROWS, depth - size], rtol=1e-12
    )


@MODELS
@pytest.mark.parametrize("h", [0.02, 0.01, 0.005])
def test_a_cylinder_holds_its_volume_but_for_its_staircase(model: str, quarters: int, h: float) -> None:
    """The error of a circle made of squares falls a little faster than the size of the squares."""
    scene = scene_of(model, CYLINDER, f"grid.spacing={h}")
    exact = quarters * DENSITY * 0.25 * np.pi * RADIUS**2 * HEIGHT
    size = scene.layout.point_size
    assert abs(scene.column_mass / exact - 1.0) < 0.5 * (size / RADIUS) ** 1.3
    column = scene.points.kind != BASE
    assert RADIUS - size < np.hypot(*scene.points.x[column][:, ::2].T).max() < RADIUS


def held_by(grid: Grid) -> np.ndarray:
    """Which components of velocity are held (n_x, n_y, n_z, 3)."""
    address = grid.ax[:, None, None] + grid.ay[:, None] + grid.az
    return (grid.fixed[address // NODE][..., None] >> np.arange(3)) % 2 == 1


def gate_heights(scene: Scene) -> np.ndarray:
    """Heights (n,) in which any node between the walls and ends is held, the floor apart."""
    inner = slice(5 if scene.layout.is_full else 1, -5)
    y, held = node_coordinates(scene.grid)[1].ravel(), held_by(scene.grid)[inner, :, inner]
    return y[held.any(axis=(0, 2, 3)) & (y > -scene.layout.base + 1e-9)]


def expected_at(x: float, y: float, z: float, layout: Layout, opening: float) -> tuple[bool, bool, bool]:
    """What is held at one node, word for word."""
    near = 1e-9
    if y < -layout.base + near:
        return True, True, True
    low = -layout.length if layout.is_full else 0.0
    hold_x, hold_z = (c < low + near or c > layout.length - near for c in (x, z))
    if y > near:  # the last four cells before an open end
        hold_x, hold_z = hold_x or abs(x) > layout.length - 4.5 * H, hold_z or abs(z) > layout.length - 4.5 * H
    if y > near and y > opening - near:
        if layout.shape == "cylinder":
            beyond = x**2 + z**2 > (RADIUS - near) ** 2
            hold_x, hold_z = hold_x or beyond, hold_z or beyond
        else:
            hold_x, hold_z = hold_x or abs(x) > RADIUS - near, hold_z or abs(z) > DEPTH - near
    return hold_x, False, hold_z


@SECTIONS
@pytest.mark.parametrize("model", ["quarter", "full"])
@pytest.mark.parametrize("base", ["elastic", "rigid"])
@pytest.mark.parametrize("opening", [0.0, 0.05, np.inf], ids=["closed", "half open", "open"])
def test_walls_and_gate_hold_what_they_should(section: tuple[str, ...], model: str, base: str, opening: float) -> None:
    scene = scene_of(model, section, f"geometry.base={base}", "geometry.domain_length=0.3")
    close_walls(scene.grid, scene.layout, opening)
    xs, ys, zs = (axis.ravel() for axis in node_coordinates(scene.grid))
    expected = [[[expected_at(x, y, z, scene.layout, opening) for z in zs] for y in ys] for x in xs]
    np.testing.assert_array_equal(held_by(scene.grid), np.array(expected))


@SECTIONS
def test_the_gate_opens_from_the_bottom_up(section: tuple[str, ...]) -> None:
    scene = scene_of("full", section)
    y = node_coordinates(scene.grid)[1].ravel()
    for opening in (*np.arange(0.0, HEIGHT + 3 * H, 0.005), np.inf):
        close_walls(scene.grid, scene.layout, opening)
        np.testing.assert_array_equal(gate_heights(scene), y[(y > 1e-9) & (y > opening - 1e-9)])


@SECTIONS
def test_the_gate_rises_at_its_speed(section: tuple[str, ...], tmp_path: Path) -> None:
    """Looked at in a run each time it tells its progress."""
    speed, seen = 0.8, []

    def look(stage: str, share: float) -> None:
        if stage == "collapse" and share > 0.0:
            seen.append((run.solver.time, gate_heights(run.scene)))

    short = (f"stages.gate_speed={speed}", "stages.collapse.max_time_factor=0.2", "output.snapshots=1")
    case = case_of("quarter", section, *short)
    run = set_up(case, build_scene(case), tmp_path / "run", 1, look, lambda line: None)
    run.release()
    run.collapse()
    y = node_coordinates(run.scene.grid)[1].ravel()
    assert seen[-1][0] * speed > HEIGHT
    for time, heights in seen:
        np.testing.assert_array_equal(heights, y[(y > 1e-9) & (y > speed * time - 1e-9)])


def opened(section: tuple[str, ...], opening: float, duration: float) -> tuple[Scene, np.ndarray]:
    """The scene and its column's points after times of sqrt(h_i / g) behind a gate that stands at `opening`."""
    scene = scene_of("quarter", section)
    close_walls(scene.grid, scene.layout, opening)
    solver = Solver(scene.points, scene.grid, scene.collapse.settings, scene.collapse.column, scene.base)
    advance_to(solver, duration * scene.layout.fall_time(G))
    points = by_id(solver)
    return scene, points.x[points.kind != BASE]


def beyond(scene: Scene, x: np.ndarray) -> np.ndarray:
    """How far points are beyond the column's surface, m."""
    if scene.layout.shape == "cylinder":
        return np.hypot(x[:, 0], x[:, 2]) - RADIUS
    return np.maximum(x[:, 0] - RADIUS, x[:, 2] - DEPTH)


@SECTIONS
def test_a_closed_gate_holds_the_column(section: tuple[str, ...]) -> None:
    scene, x = opened(section, 0.0, 1.0)
    assert beyond(scene, x).max() < 0.0
    assert x[:, 1].max() > 0.97 * (HEIGHT - 0.005)


@SECTIONS
def test_a_gate_on_its_way_lets_out_what_is_below_it(section: tuple[str, ...]) -> None:
    """And less of it than without a gate."""
    scene, x = opened(section, 0.07, 2.0)
    out, above = beyond(scene, x), x[:, 1] > 0.07
    assert np.any(above) and out[above].max() < 0.0
    assert out.max() > 0.5 * H
    scene, x = opened(section, np.inf, 2.0)
    assert beyond(scene, x).max() > 1.5 * out.max()
