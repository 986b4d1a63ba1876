"""Deactivation of the base far from the column: inactive points, held nodes, and the effect on a collapse."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.errors import CaseError
from mpmcol.failure_modes.toolkit import advance_steps, advance_to, by_id
from mpmcol.mpm.boundary import INACTIVE_BITS, hold_components
from mpmcol.mpm.grid import NODE, TILE, Grid
from mpmcol.mpm.particles import COLUMN
from mpmcol.mpm.settings import PAPER, Scheme
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.shape_functions.quadratic import base_node
from mpmcol.mpm.solver import Solver
from tests.support.sand_column import DAMPED, collapse, ledger_of

DIMENSIONS = pytest.mark.parametrize("d", [2, 3])
WHOLE_DOMAIN = 1000  # tiles: with this margin all points are active


def sorted_collapse(d: int, margin: int, scheme: Scheme = PAPER) -> tuple[Solver, int]:
    """The sorted collapse problem with a partly inactive base, and its number of active points."""
    solver = collapse(DAMPED, d, scheme=scheme, margin=margin)
    solver.sort()
    return solver, active_points(solver)


def active_points(solver: Solver) -> int:
    assert solver.tiles is not None
    return int(solver.tiles.start[-1])


def axes_of(grid: Grid, d: int) -> list[tuple[float, int, np.ndarray]]:
    """First node (m), number of nodes, and their offsets along each axis."""
    origin, counts = (grid.origin_x, grid.origin_y, grid.origin_z), (grid.n_x, grid.n_y, grid.n_z)
    return list(zip(origin, counts, (grid.ax, grid.ay, grid.az), strict=True))[:d]


def nodes_of(x: np.ndarray, grid: Grid, basis: str, travel: float) -> np.ndarray:
    """Numbers of the nodes that points at `x` (n, d) touch, now and after `travel` cells to all sides."""
    total = np.zeros((len(x), 1), np.int64)
    for axis, (origin, count, offsets) in enumerate(axes_of(grid, x.shape[1])):
        s = (x[:, [axis]] - origin) / grid.h + travel * np.array([-1.0, 0.0, 1.0])
        s = np.clip(s, 1e-9, count - 1 - 1e-9).reshape(-1, 1)
        first = SHAPE_FUNCTIONS[basis].evaluate(s, 0.5, count - 1.5, True)[0][:, 0].astype(int).reshape(len(x), -1)
        reached = np.concatenate([offsets[first + k] for k in range(SHAPE_FUNCTIONS[basis].WIDTH)], axis=1)
        total = (total[:, :, None] + reached[:, None, :]).reshape(len(x), -1)
    return np.unique(total // NODE)


@pytest.mark.parametrize(("d", "margin"), [(2, 1), (2, 3), (3, 1)])
def test_only_tiles_beyond_the_margin_are_inactive(d: int, margin: int) -> None:
    solver, active = sorted_collapse(d, margin)
    axes = enumerate(axes_of(solver.grid, d))
    first = [[base_node((x - o) / solver.grid.h, n) for x in solver.points.x[:, axis]] for axis, (o, n, _) in axes]
    tile, column = np.array(first).T // TILE, solver.points.kind == COLUMN
    occupied, number = np.unique(tile, axis=0, return_inverse=True)
    own = np.unique(tile[column], axis=0)
    distance = np.array([np.abs(own - each).max(axis=1).min() for each in occupied])[number.ravel()]
    assert np.all(distance[:active] <= margin) and np.all(distance[active:] > margin)
    assert 0.2 < active / len(column) < 0.95


@DIMENSIONS
@pytest.mark.parametrize("basis", list(SHAPE_FUNCTIONS))
def test_nodes_of_inactive_points_are_held_and_the_column_reaches_none_of_them(basis: str, d: int) -> None:
    """For the nodes of active tiles, and for column points anywhere within their travel before the next sort."""
    solver, active = sorted_collapse(d, 1, Scheme(basis=basis))
    assert solver.tiles is not None
    points, grid, size = solver.points, solver.grid, solver.grid.tile_doubles // NODE
    nodes = (solver.tiles.active[:, None] // NODE + np.arange(size)).ravel()
    held = np.flatnonzero(grid.fixed & INACTIVE_BITS)
    hold_components(grid, *d * (False,))  # as when the gate is lifted
    np.testing.assert_array_equal(np.flatnonzero(grid.fixed), held)
    touched = np.intersect1d(nodes_of(points.x[active:], grid, basis, 0.0), nodes)
    assert len(touched) and np.all(np.isin(touched, held))
    column = points.x[points.kind == COLUMN]
    assert not np.any(np.isin(nodes_of(column, grid, basis, 0.999 * SHAPE_FUNCTIONS[basis].TRAVEL_LIMIT), held))


@DIMENSIONS
def test_held_nodes_stay_at_rest_while_the_others_fall(d: int) -> None:
    solver, _ = sorted_collapse(d, 1)
    advance_steps(solver, 1)
    assert solver.tiles is not None
    nodes, held = solver.grid.nodes.reshape(-1, NODE), (solver.grid.fixed & INACTIVE_BITS) > 0
    masses, velocities = nodes[:, 0], nodes[:, 1 : 1 + d]
    assert np.all(velocities[held] == 0.0) and np.any(masses[held] > 0.0)
    free = ~held & (masses > 0.0) & (solver.grid.fixed == 0)
    assert np.any(free) and np.all(np.any(velocities[free] != 0.0, axis=1))


@DIMENSIONS
def test_tiles_become_active_as_the_flow_arrives_and_inactive_points_keep_their_state(d: int) -> None:
    solver, first = sorted_collapse(d, 1)
    before, inactive = by_id(solver), solver.points.id[first:]
    advance_to(solver, {2: 0.2, 3: 0.1}[d])
    last = active_points(solver)
    assert last > 1.1 * first
    still = solver.points.id[last:]
    assert len(still) > 20 and np.all(np.isin(still, inactive))
    np.testing.assert_array_equal(by_id(solver).rows[still], before.rows[still])
    activated = np.setdiff1d(inactive, still)
    assert np.all(np.any(by_id(solver).rows[activated] != before.rows[activated], axis=1))


@pytest.mark.parametrize("wall_impulse", [True, False], ids=["impulse", "no impulse"])
@pytest.mark.parametrize(
    ("d", "axisymmetric"), [(2, False), (2, True), (3, False)], ids=["plane", "axisymmetric", "3D"]
)
def test_the_ledger_closes_while_tiles_become_active(d: int, axisymmetric: bool, wall_impulse: bool) -> None:
    """Inactive points keep their energy, and the nodes beside them are held like a wall."""
    ledger = ledger_of(DAMPED._replace(axisymmetric=axisymmetric, wall_impulse=wall_impulse), d, margin=1)
    assert ledger.potential < -0.4
    assert abs(ledger.residual) <= 1e-6


@DIMENSIONS
def test_a_margin_as_wide_as_the_domain_changes_no_bit(d: int) -> None:
    rows = []
    for margin in (0, WHOLE_DOMAIN):
        solver = collapse(DAMPED, d, margin=margin)
        advance_to(solver, 0.05)
        rows.append(solver.points.rows)
    np.testing.assert_array_equal(*rows)


@pytest.mark.parametrize("stress_filter", ["none", "flow"])
def test_a_run_deactivates_the_base_from_the_release(stress_filter: str, tmp_path: Path) -> None:
    """One fall time later the front and the stress of the base agree with a fully active base.

    With the stress filter the stress does so on average: below the edge of the column it differs by 2 % at four points.
    """
    keys = [
        f"method.stress_filter={stress_filter}",
        "grid.spacing=0.01",
        "stages.collapse.max_time_factor=1.0",
        "output.snapshots=1",
    ]
    still, moved = (
        mpmcol.run(mpmcol.load_case("coarse-channel", [*keys, f"method.deactivate_base={value}"]), tmp_path / value)
        for value in ("true", "false")
    )
    shares, stress = [], []
    for results in (still, moved):
        last = results.snapshot(-1)
        base = np.argsort(last.arrays["id"])[-np.sum(~last.column) :]  # numbered after the column
        shares.append(np.mean(np.all(last.arrays["displacement"][base] == 0.0, axis=1)))
        stress.append(last.arrays["stress"][base])
    assert 0.2 < shares[0] < 0.9 and shares[1] == 0.0
    difference, largest = np.abs(stress[0] - stress[1]), np.abs(stress[1]).max()
    assert np.sqrt(np.mean(difference**2)) < 2e-3 * largest
    assert difference.max() < {"none": 1e-2, "flow": 3e-2}[stress_filter] * largest
    assert still.measure().zeta["front_max"] == pytest.approx(moved.measure().zeta["front_max"], abs=1e-3)
    flow = still.history["stage"] == "collapse"
    assert np.abs(still.history["residual"][flow]).max() < 1e-9 * still.history["damping"][flow].max()


def test_deactivation_is_refused_for_a_rigid_floor() -> None:
    rigid = ["geometry.base=rigid", "method.wall_impulse=true"]
    with pytest.raises(CaseError, match="deactivate_base = true: must be false with geometry.base"):
        mpmcol.load_case("coarse-channel", [*rigid, "method.deactivate_base=true"])
