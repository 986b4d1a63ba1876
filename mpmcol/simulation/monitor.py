"""What a run is looked at for at its checks: a list of tests on its numbers, each with likely cause and remedy.

The compiled loop itself stops at every step at points that are not finite, whose J left its bounds, that are too fast
or that reach the ends of the domain (`failure.py`); here stands what only a look at the whole can tell. A new
check is a function and a line in CHECKS.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.grid import NODE, Grid
from mpmcol.mpm.particles import BASE, COLUMN
from mpmcol.mpm.solver import Solver
from mpmcol.simulation.failure import OPEN, TIME_STEP, TOO_LONG, Fault, finite_fields, not_finite

ENERGIES = ("potential", "kinetic", "elastic")
MEMORY = 50  # rows of the history against which energy is compared
QUIET = 1e-3  # of the stress under the column: smaller ones are not told apart
DAMAGED = "damage to the run's numbers, in memory or by a fault of the code"
NOT_RETURNED = "a law whose return does not end on its surface, or " + DAMAGED
REPORT = "run it again; if it stops at the same step, the case and this message are worth an issue"
CHECK_LAW = "check `return_map` of the law; else " + REPORT


class View(NamedTuple):
    """What is looked at: the solver, the history whose last row is of now, and the scales of the column."""

    solver: Solver
    rows: Sequence[Mapping[str, Any]]
    start: Mapping[str, float]  # energies at the start of the ledger, J per metre or radian
    energy: float  # weight of the column times its height, J per metre or radian
    stress: float  # under the column, Pa
    tau: float  # sqrt(h_i / g), s


class Sign(NamedTuple):
    """What a check found: the number that shows it, and the point (its row) or the place, if there is one."""

    cause: str
    value: float
    row: int | None = None
    position: Sequence[float] | None = None


class Check(NamedTuple):
    """A test with its limit, and what it means where it finds something."""

    name: str
    find: Callable[[View, float], Sign | None]
    limit: float
    likely: str
    remedy: str
    smaller_step_helps: bool = False


def look(view: View) -> Fault | None:
    """The first fault that a check finds."""
    with np.errstate(all="ignore"):
        if (row := _first_unsound(view.solver, view.rows[-1])) is not None:
            return not_finite(view.solver, row if row >= 0 else None)
        for check in CHECKS:
            if sign := check.find(view, check.limit):
                return Fault(
                    check.name, sign.cause, sign.value, check.limit, check.likely, check.remedy, sign.row,
                    sign.position, check.smaller_step_helps,
                )  # fmt: skip
    return None


def _first_unsound(solver: Solver, row: Mapping[str, Any]) -> int | None:
    """Row of the first point with a number that is none, -1 where it is not a point's; None if all are sound.

    The energies tell of most numbers; a law takes a history that is none for one that does not yield.
    """
    points, used = solver.points, len(solver.bodies[COLUMN].law.STATE)
    total = sum(row[name] for name in ENERGIES) + points.opening.sum() + points.history[:, :used].sum()
    if np.isfinite(total):
        return None
    sound = np.logical_and.reduce(list(finite_fields(solver).values()))
    return -1 if sound.all() else int(sound.argmin())


def _energy(row: Mapping[str, Any]) -> float:
    return float(sum(row[name] for name in ENERGIES))


def energy_gain(view: View, limit: float) -> Sign | None:
    """Potential, kinetic and elastic energy together only fall: sand, damping and walls take, nothing gives."""
    past = [_energy(view.start), *(_energy(row) for row in view.rows[-MEMORY - 1 : -1])]
    gain = (_energy(view.rows[-1]) - min(past)) / (view.energy + view.start["kinetic"])
    if gain <= limit:
        return None
    points = view.solver.points
    own = points.m * np.sum(points.v**2, axis=1)
    return Sign("energy came from nowhere, in units of the column's weight times its height", gain, int(own.argmax()))


def ledger_residual(view: View, limit: float) -> Sign | None:
    """The work at the nodes is the change of potential energy, to round-off where positions follow the trapezoid."""
    solver = view.solver
    rule = 0.0 if solver.settings.position_factor == 0.5 else solver.dt * solver.time / view.tau**2
    residual = abs(view.rows[-1]["residual"]) / view.energy
    if residual <= limit + rule:
        return None
    return Sign("the energy ledger does not add up, in units of the column's weight times its height", residual)


def time_step(view: View, limit: float) -> Sign | None:
    """Waves and gravity leave a time step that is not far below that of a column at rest."""
    solver = view.solver
    waves = max(body.wave_speed2 for body in solver.bodies) ** 0.5
    share = solver.dt * (waves + solver.settings.free_speed) / (solver.settings.cfl * solver.grid.h)
    if share >= limit:
        return None
    points = solver.points
    speed = np.sqrt(solver.bodies[COLUMN].wave_speed2 * points.J) + np.linalg.norm(points.v, axis=1)
    return Sign("the time step collapsed, in units of that for waves and gravity", share, int(speed.argmax()))


def outside_surface(view: View, limit: float) -> Sign | None:
    """No point of the column bears more than its law allows, if that stays as it is."""
    return None if view.solver.bodies[COLUMN].law.STATE else _outside(view, limit)


def outside_softened_surface(view: View, limit: float) -> Sign | None:
    """The same of a law with a history: its surface moves within a step, after the return, as far as a step softens."""
    return _outside(view, limit) if view.solver.bodies[COLUMN].law.STATE else None


def _outside(view: View, limit: float) -> Sign | None:
    solver, quiet = view.solver, QUIET * view.stress
    law, params = solver.bodies[COLUMN].law, solver.bodies[COLUMN].params
    rows = np.flatnonzero(solver.points.kind != BASE)
    s1, s2, s3 = principal(*(component[rows] for component in solver.points.sigma.T))
    history = np.array([values[rows] for values in solver.points.history.T])
    scale = limit * (np.maximum(np.abs(s1), np.abs(s3)) + quiet)
    suspects = np.flatnonzero(law.may_yield(s1, s3, tuple(history), params) > scale)
    if not len(suspects):
        return None
    s1, s2, s3, scale, history = s1[suspects], s2[suspects], s3[suspects], scale[suspects], history[:, suspects]
    excess = np.full(len(suspects), np.inf)
    for known in (tuple(history), (0.0 * s1, 0.0 * s1)):  # softening goes on after the return of a step
        excess = np.minimum(excess, limit * law.return_map(s1, s2, s3, known, params)[-1] / scale)
    worst = int(excess.argmax())
    if excess[worst] <= limit:
        return None
    return Sign(
        "a stress lies outside the yield surface, in units of itself", excess[worst], int(rows[suspects[worst]])
    )


def senseless_nodes(view: View, limit: float) -> Sign | None:
    """Nodes have a mass that is not negative, and a velocity if they have one."""
    solver = view.solver
    assert solver.tiles is not None  # who looks has made steps
    tiles = solver.tiles.active // solver.grid.tile_doubles
    nodes = solver.grid.nodes.reshape(-1, solver.grid.tile_doubles)[tiles].reshape(-1, NODE)
    m = nodes[:, 0]
    if np.isfinite(nodes.sum()) and m.min() >= limit and not nodes[m == 0.0].any():
        return None
    bad = ~np.isfinite(nodes).all(axis=1) | (m < limit) | ((m == 0.0) & nodes.any(axis=1))
    first = int(np.flatnonzero(bad)[0])
    size = solver.grid.tile_doubles // NODE
    address = int(solver.tiles.active[first // size]) + first % size * NODE
    return Sign(
        "a node has no mass, or a velocity that is none", m[first], position=node_position(solver.grid, address)
    )


def node_position(grid: Grid, address: int) -> tuple[float, ...] | None:
    """Where the node at an address of `grid.nodes` is, m; None for one that only fills a tile."""
    found = np.argwhere(grid.ax[:, None, None] + grid.ay[:, None] + grid.az == address)
    if not len(found):
        return None
    origin = (grid.origin_x, grid.origin_y, grid.origin_z)
    place = tuple(float(x + grid.h * i) for x, i in zip(origin, found[0], strict=True))
    return place if grid.n_z > 1 else place[:2]


def principal(
    xx: np.ndarray, yy: np.ndarray, zz: np.ndarray, xy: np.ndarray, yz: np.ndarray, xz: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Principal stresses s1 >= s2 >= s3 (n,) from the components of stresses, to 1e-8 of their differences."""
    mean = (xx + yy + zz) / 3.0
    if not yz.any() and not xz.any():  # two dimensions
        centre, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
        radius = np.sqrt(half * half + xy * xy)
        largest, least = np.maximum(zz, centre + radius), np.minimum(zz, centre - radius)
        return largest, 3.0 * mean - largest - least, least
    a, b, c = xx - mean, yy - mean, zz - mean
    j2 = 0.5 * (a * a + b * b + c * c) + xy * xy + yz * yz + xz * xz
    j3 = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz)
    reach = np.sqrt(j2 / 3.0)
    lode = np.arccos(np.clip(0.5 * j3 / np.where(reach > 0.0, reach, 1.0) ** 3, -1.0, 1.0)) / 3.0
    largest, least = mean + 2.0 * reach * np.cos(lode), mean + 2.0 * reach * np.cos(lode + 2.0 * np.pi / 3.0)
    return largest, 3.0 * mean - largest - least, least


CHECKS = (
    Check("energy", energy_gain, 0.05, TOO_LONG + "; or sand so stiff that what is squeezed between nodes springs off",
          TIME_STEP + ", or lower material.youngs_modulus", smaller_step_helps=True),
    Check("ledger", ledger_residual, 1e-6, DAMAGED, REPORT),
    Check("time step", time_step, 0.1, "a point that swells without end, or damage to the clock",
          OPEN + "; else " + REPORT),
    Check("yield surface", outside_surface, 1e-6, NOT_RETURNED, CHECK_LAW),
    Check("yield surface", outside_softened_surface, 0.01, NOT_RETURNED, CHECK_LAW),
    Check("nodes", senseless_nodes, 0.0, DAMAGED, REPORT, smaller_step_helps=True),
)  # fmt: skip
