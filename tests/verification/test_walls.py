"""Walls that stand in the domain, against closed forms and against faces of the domain."""

from __future__ import annotations

from math import radians, tan

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import G, advance_to, by_id, elastic_body, joined, lattice, make_solver, points_at
from mpmcol.mpm.boundary import CONTACT, NO_SLIP, ROLLER, WALL_GAP, Boundary, apply_boundaries, face
from mpmcol.mpm.contact import make_contacts, wall_impulses
from mpmcol.mpm.grid import Grid, allocate_grid
from mpmcol.mpm.kernels.loop import L_DAMPING, L_GRID, L_NODE_WORK, L_WALLS
from mpmcol.mpm.particles import Points
from mpmcol.mpm.settings import Scheme, Settings
from mpmcol.mpm.solver import Solver
from mpmcol.mpm.wall_cells import with_walls
from mpmcol.setup.wall_boxes import WallBox, cells_in_walls, wall_boundaries

H, SIDE, STIFF = 0.1, 0.4, 1e7  # m, m, Pa
CELLS = (30, 16, 10)
DAM = WallBox("dam", (12, 0, 3), (14, 5, 7))
END = WallBox("end", (12, 0, 0), (17, 16, 10))
FLOOR_WALL, DAM_WALL = 0, 1
FAST, SOFT = 20.0, 1.0  # m/s, Pa: linear functions have no stable time step for single points that are stiff
LEVEL = Settings(gravity_y=-G, cfl=0.4)
WEIGHTLESS = Settings(gravity_y=0.0, cfl=0.4)
DIMENSIONS = pytest.mark.parametrize("d", [2, 3])


def cut(box: WallBox, d: int) -> WallBox:
    return WallBox(box.name, box.low[:d], box.high[:d])


def grid_with(box: WallBox | None, d: int, mu: float, ends: tuple[Boundary, ...] = ()) -> tuple[Grid, list[Boundary]]:
    """A grid with a floor of friction mu, wall 0, and a box of the same friction, wall 1."""
    grid = allocate_grid((0.0,) * d, H, CELLS[:d])
    boundaries = [face(grid, CONTACT, 1, 0)._replace(wall=FLOOR_WALL, friction=mu), *ends]
    if box is not None:
        grid = with_walls(grid, cells_in_walls(grid, (cut(box, d),)))
        boundaries += [each._replace(wall=DAM_WALL, friction=mu) for each in wall_boundaries(grid, cut(box, d))]
    return grid, boundaries


def solver_of(
    points: Points,
    grid: Grid,
    boundaries: list[Boundary],
    settings: Settings,
    scheme: Scheme | None = None,
    stiffness: float = STIFF,
) -> Solver:
    apply_boundaries(grid, boundaries)
    solver = make_solver(points, grid, settings, body=elastic_body(youngs_modulus=stiffness))
    solver.scheme = scheme or solver.scheme
    solver.contacts = make_contacts(grid, boundaries)
    return solver


def block(d: int, *corner: float) -> Points:
    low = np.array((*corner, 0.3)[:d])
    return points_at(lattice(tuple(low), tuple(low + SIDE), H / 2), H / 2)


def momentum(points: Points) -> np.ndarray:
    return points.m @ points.v


@DIMENSIONS
def test_a_sliding_block_is_stopped_by_a_dam_with_the_impulse_of_its_momentum(d: int) -> None:
    """A block that slides on a frictionless floor hits a dam that is as high as the block, and rebounds."""
    points = block(d, 0.6, 0.0)
    points.v[:, 0] = 2.0
    solver = solver_of(points, *grid_with(DAM, d, 0.0), WEIGHTLESS)
    start, m = momentum(points), points.m.sum()
    advance_to(solver, 0.3)
    impulses = wall_impulses(solver.contacts, 2)
    assert momentum(solver.points)[0] < -0.3 * start[0]
    np.testing.assert_allclose(impulses[:, :d].sum(axis=0), start - momentum(solver.points), atol=1e-13 * m)
    assert impulses[FLOOR_WALL, 0] == 0.0 and impulses[DAM_WALL, 0] > 1.3 * start[0]


@DIMENSIONS
def test_impulses_of_floor_and_dam_and_gravity_change_the_momentum(d: int) -> None:
    """A block that falls on the edge of a dam, over both of its upper corners, and slides off; with friction."""
    points = block(d, 1.0, 0.7)
    points.v[:, 0] = 1.0
    solver = solver_of(points, *grid_with(DAM, d, 0.3), LEVEL._replace(alpha_d=0.0))
    start, m = momentum(points), points.m.sum()
    potential = m * G * (points.m @ points.x[:, 1]) / m
    advance_to(solver, 0.8)
    gravity = m * solver.time * np.array([0.0, -G, 0.0])[:d]
    impulses = wall_impulses(solver.contacts, 2)
    balance = momentum(solver.points) - start - gravity + impulses[:, :d].sum(axis=0)
    np.testing.assert_allclose(balance / m, 0.0, atol=1e-12)
    assert impulses[DAM_WALL, 1] < -0.5 * m
    fallen = potential - G * (solver.points.m @ solver.points.x[:, 1])
    grid, stress, damping, walls = solver.ledger[[L_GRID, L_NODE_WORK, L_DAMPING, L_WALLS]]
    assert grid + stress + damping + walls == pytest.approx(fallen, rel=1e-11)


@DIMENSIONS
@pytest.mark.parametrize("kind", [CONTACT, ROLLER], ids=lambda kind: kind.name)
def test_an_end_wall_equals_the_end_of_the_domain(d: int, kind: object) -> None:
    """A block pressed against a smooth wall by its weight along x: the same motion as at a smooth end of the domain."""
    settings = LEVEL._replace(gravity_x=0.5 * G)
    states = []
    for box, cells in ((END, CELLS), (None, (END.low[0], *CELLS[1:]))):
        points = block(d, 0.8, 0.0)
        grid, boundaries = grid_with(box, d, 0.0)
        if box is None:
            grid = allocate_grid((0.0,) * d, H, cells[:d])
            floor = face(grid, CONTACT, 1, 0)._replace(wall=FLOOR_WALL)
            boundaries = [floor, face(grid, kind, 0, 1)._replace(wall=DAM_WALL)]  # type: ignore[arg-type]
        solver = solver_of(points, grid, boundaries, settings)
        advance_to(solver, 0.012)  # before it rebounds, which a smooth end of the domain prevents
        states.append((by_id(solver).x, wall_impulses(solver.contacts, 2)))
    np.testing.assert_allclose(states[0][0], states[1][0], rtol=1e-11)
    np.testing.assert_allclose(states[0][1], states[1][1], rtol=1e-8, atol=1e-8 * states[1][1][DAM_WALL, 0])
    assert states[0][1][DAM_WALL, 0] > 0.0


def swarm(d: int, box: WallBox) -> Points:
    """Single points around a wall that fly in all directions, many of them toward it and its edges."""
    rng = np.random.default_rng(5)
    low, high = H * np.array(box.low), H * np.array(box.high)
    start = rng.uniform(low - 3.0 * H, high + 3.0 * H, (400, d))
    start = start[~((start > low - 0.2 * H) & (start < high + 0.2 * H)).all(axis=1) & (start[:, 1] > 0.2 * H)]
    points = points_at(start, H / 2)
    points.v[:] = 4.0 * ((low + high) / 2.0 - start) + rng.normal(0.0, 2.0, start.shape)
    near = points_at(np.concatenate([_before_faces(low, high, rng), _before_edges(low, high, rng)]), H / 2)
    near.v[:] = np.where(near.x < low, FAST, np.where(near.x > high, -FAST, 0.0))
    return joined(points, near)


def _before_faces(low: np.ndarray, high: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Positions before the two vertical faces, hardly farther than points may come."""
    x = rng.uniform(low + 0.3 * H, high - 0.3 * H, (40, len(low)))
    x[:20, 0], x[20:, 0] = low[0] - rng.uniform(0.1, 0.2, 20) * H, high[0] + rng.uniform(0.1, 0.2, 20) * H
    return x


def _before_edges(low: np.ndarray, high: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Positions in the cells at the two upper edges, close to the edges."""
    x = rng.uniform(low + 0.3 * H, high - 0.3 * H, (40, len(low)))
    x[:, 1] = high[1] + rng.uniform(0.005, 0.05, 40) * H
    x[:20, 0], x[20:, 0] = low[0] - rng.uniform(0.005, 0.05, 20) * H, high[0] + rng.uniform(0.005, 0.05, 20) * H
    return x


@pytest.mark.parametrize(
    ("d", "scheme"),
    [
        (2, Scheme()),
        (3, Scheme()),
        (2, Scheme(basis="linear")),
        pytest.param(2, Scheme(basis="cubic"), marks=pytest.mark.slow),
    ],
    ids=str,
)
def test_no_point_enters_a_wall(d: int, scheme: Scheme) -> None:
    """Over faces, edges and corners; beside a face points keep their distance, but not in the cells at its edges."""
    box = cut(DAM, d)
    solver = solver_of(swarm(d, box), *grid_with(DAM, d, 0.0), WEIGHTLESS, scheme, SOFT)
    inside, nearest = 0, np.inf
    low, high = H * np.array(box.low), H * np.array(box.high)
    for _ in range(150):
        solver.advance(np.inf, max_steps=1)
        x = solver.points.x
        assert np.all(np.isfinite(x))
        inside += int(((x > low) & (x < high)).all(axis=1).sum())
        before = (np.abs(x - (low + high) / 2.0)[:, 1:] < (high - low)[1:] / 2.0 - 0.2 * H).all(axis=1)
        nearest = min(nearest, np.where(before, np.abs(x[:, 0] - (low + high)[0] / 2.0), np.inf).min())
    assert inside == 0
    assert nearest >= (high - low)[0] / 2.0 + (1.0 - 1e-9) * WALL_GAP * H


@DIMENSIONS
def test_a_wall_separates_the_material_on_its_sides(d: int) -> None:
    """Material that hits one side of a wall of two cells does not move material that touches the other side."""
    box = WallBox("thin", (12, 0, 0), (14, 16, 10))
    left, right = block(d, 0.7, 0.0), block(d, 1.4, 0.0)
    points = joined(left, right)
    points.v[: len(left), 0] = 2.0
    solver = solver_of(points, *grid_with(box, d, 0.0), WEIGHTLESS)
    advance_to(solver, 0.2)
    still = by_id(solver)
    assert np.abs(still.v[len(left) :]).max() < 1e-12 < 0.5 < np.abs(still.v[: len(left), 0]).max()


def test_a_block_on_a_dam_rests_or_slides_by_its_friction() -> None:
    """On top of a wide step, tilted by 10 degrees: it rests with mu = tan 20, and slides with mu = 0."""
    step = WallBox("step", (8, 0), (24, 4))
    gravity = LEVEL._replace(gravity_x=G * np.sin(radians(10.0)), gravity_y=-G * np.cos(radians(10.0)))
    moved = []
    for mu in (tan(radians(20.0)), 0.0):
        solver = solver_of(block(2, 1.2, 0.4), *grid_with(step, 2, mu), gravity._replace(alpha_d=0.3 if mu else 0.0))
        advance_to(solver, 0.2)
        start = momentum(solver.points)[0] / solver.points.m.sum()
        began = solver.time
        advance_to(solver, 0.5)
        moved.append((momentum(solver.points)[0] / solver.points.m.sum() - start) / (solver.time - began))
    assert abs(moved[0]) < 0.01 * G
    assert moved[1] == pytest.approx(G * np.sin(radians(10.0)), rel=1e-10)


def test_a_floor_without_slip_below_a_wall() -> None:
    """At the foot of a wall the floor carries its own impulse, and the wall the horizontal one."""
    grid, box = allocate_grid((0.0, 0.0), H, CELLS[:2]), cut(DAM, 2)
    grid = with_walls(grid, cells_in_walls(grid, (box,)))
    boundaries = [face(grid, NO_SLIP, 1, 0)._replace(wall=FLOOR_WALL)]
    boundaries += [each._replace(wall=DAM_WALL) for each in wall_boundaries(grid, box)]
    solver = solver_of(block(2, 0.8, 0.0), grid, boundaries, LEVEL._replace(gravity_x=G, alpha_d=0.5))
    advance_to(solver, 0.4)
    solver.contacts.sums[:] = 0.0
    began = solver.time
    advance_to(solver, began + 0.1)
    force, weight = wall_impulses(solver.contacts, 2) / (solver.time - began), solver.points.m.sum() * G
    assert force.sum(axis=0)[:2] == pytest.approx([weight, -weight], rel=1e-3)
    assert force[DAM_WALL, 0] > 0.2 * weight and abs(force[DAM_WALL, 1]) < 0.01 * weight
