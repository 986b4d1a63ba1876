"""Run-time consistency checks: a list of tests of the whole state, each with probable cause and remedy.

The compiled loop itself stops in every step at points that are not finite, whose J is outside its limits, that are too
fast or outside the domain (`failure.py`). A new check is a function and an entry of CHECKS.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.constitutive.invariants import invariants_of
from mpmcol.mpm.grid import NODE, Grid
from mpmcol.mpm.solver import Solver
from mpmcol.simulation.failure import (
    LOWER_TIME_STEP,
    OPENING_STRAIN,
    TIME_STEP_TOO_LARGE,
    Failure,
    finite_fields,
    not_finite,
)

ENERGY_WINDOW = 50  # rows of the history to which the energy is compared
STRESS_FLOOR = 1e-3  # of the stress under the column: smaller stresses count as zero
CORRUPTED = "corrupted numbers: a hardware fault or a program error"
NO_RETURN = "a law whose return mapping does not end on its yield surface, or " + CORRUPTED
REPORT = "repeat the run; if it stops at the same step, report the case and this message"
CHECK_LAW = "check `return_map` of the law; else " + REPORT


class CheckedState(NamedTuple):
    """What the checks examine: the solver, the history up to now, and the scales of the column."""

    solver: Solver
    rows: Sequence[Mapping[str, Any]]  # of the history; the last one is of the present state
    initial_energies: Mapping[str, float]  # at the start of the ledger, J (per metre or radian in two dimensions)
    energy: float  # m g h_i of the column, J
    stress: float  # under the column, Pa
    fall_time: float  # sqrt(h_i / g), s


class Violation(NamedTuple):
    """What a check found: the value that violates its limit, and the row of the point or the position, if known."""

    cause: str
    value: float
    row: int | None = None
    position: Sequence[float] | None = None


class StateCheck(NamedTuple):
    """A test with its limit, and the probable cause and the remedy of a violation."""

    name: str
    find: Callable[[CheckedState, float], Violation | None]
    limit: float
    likely: str
    remedy: str
    smaller_step_helps: bool = False


def find_failure(state: CheckedState) -> Failure | None:
    """The failure that the first violated check describes; None if the state is valid."""
    with np.errstate(all="ignore"):
        if (row := _first_not_finite(state.solver, state.rows[-1])) is not None:
            return not_finite(state.solver, row if row >= 0 else None)
        for check in CHECKS:
            if found := check.find(state, check.limit):
                return Failure(
                    check=check.name,
                    cause=found.cause,
                    value=found.value,
                    limit=check.limit,
                    likely=check.likely,
                    remedy=check.remedy,
                    row=found.row,
                    position=found.position,
                    smaller_step_helps=check.smaller_step_helps,
                )
    return None


def _first_not_finite(solver: Solver, row: Mapping[str, Any]) -> int | None:
    """Row of the first point with a number that is not finite; -1 if the number is not of a point; None if all are.

    The sum of the energies covers most fields. The history of the law is summed separately: a law with a NaN in it does
    not yield.
    """
    points, used = solver.points, max(len(body.law.STATE) for body in solver.bodies)
    total = _stored_energy(row) + points.opening.sum() + points.history[:, :used].sum()
    if np.isfinite(total):
        return None
    is_finite = np.logical_and.reduce(list(finite_fields(solver).values()))
    return -1 if is_finite.all() else int(is_finite.argmin())


def _stored_energy(row: Mapping[str, Any]) -> float:
    return float(row["potential"] + row["kinetic"] + row["elastic"])  # of hundreds of rows at each check


def energy_gain(state: CheckedState, limit: float) -> Violation | None:
    """The sum of potential, kinetic and elastic energy cannot rise: sand, damping and walls only dissipate."""
    past = [
        _stored_energy(state.initial_energies),
        *(_stored_energy(row) for row in state.rows[-ENERGY_WINDOW - 1 : -1]),
    ]
    gain = (_stored_energy(state.rows[-1]) - min(past)) / (state.energy + state.initial_energies["kinetic"])
    if gain <= limit:
        return None
    points = state.solver.points
    kinetic = points.m * np.sum(points.v**2, axis=1)
    return Violation("spurious energy gain, normalised by m g h_i", gain, int(kinetic.argmax()))


def ledger_residual(state: CheckedState, limit: float) -> Violation | None:
    """The work at the nodes is the change of potential energy: to round-off with the trapezoidal position update."""
    solver = state.solver
    rule = 0.0 if solver.settings.position_factor == 0.5 else solver.dt * solver.time / state.fall_time**2
    residual = abs(state.rows[-1]["residual"]) / state.energy
    if residual <= limit + rule:
        return None
    return Violation("the energy ledger does not close, residual normalised by m g h_i", residual)


def time_step(state: CheckedState, limit: float) -> Violation | None:
    """Waves and free fall do not reduce the time step far below that of a column at rest."""
    solver = state.solver
    wave_speed = max(body.wave_speed2 for body in solver.bodies) ** 0.5
    ratio = solver.dt * (wave_speed + solver.settings.free_speed) / (solver.settings.cfl * solver.grid.h)
    if ratio >= limit:
        return None
    points = solver.points
    speed = np.sqrt(solver.wave_speeds2() * points.J) + np.linalg.norm(points.v, axis=1)
    return Violation("the time step collapsed, normalised by that of waves and free fall", ratio, int(speed.argmax()))


def outside_surface(state: CheckedState, limit: float) -> Violation | None:
    """The stress of no point is outside a constant yield surface."""
    return _outside(state, limit, (kind for kind, body in enumerate(state.solver.bodies) if not body.law.STATE))


def outside_softened_surface(state: CheckedState, limit: float) -> Violation | None:
    """The same for a law with history, whose surface moves after the return mapping by the softening of one step."""
    return _outside(state, limit, (kind for kind, body in enumerate(state.solver.bodies) if body.law.STATE))


def _outside(state: CheckedState, limit: float, kinds: Iterable[int]) -> Violation | None:
    """The first violation among points of these kinds."""
    return next(filter(None, (_outside_of_kind(state, limit, kind) for kind in kinds)), None)


def _outside_of_kind(state: CheckedState, limit: float, kind: int) -> Violation | None:
    solver, floor = state.solver, STRESS_FLOOR * state.stress
    law, params = solver.bodies[kind].law, solver.bodies[kind].params
    rows = np.flatnonzero(solver.points.kind == kind)
    if not len(rows):
        return None
    principal = principal_stresses(*(component[rows] for component in solver.points.sigma.T))
    s1, _, s3 = principal
    history = np.array([values[rows] for values in solver.points.history.T])
    scale = limit * (np.maximum(np.abs(s1), np.abs(s3)) + floor)
    stress = np.array(invariants_of(*principal) if law.INVARIANTS else principal)
    suspects = np.flatnonzero(law.may_yield(stress[0], stress[-1], tuple(history), params) > scale)
    if not len(suspects):
        return None
    stress, scale, history = stress[:, suspects], scale[suspects], history[:, suspects]
    excess = np.full(len(suspects), np.inf)
    intact = (0.0 * history[0], history[1])
    for known in (tuple(history), intact):  # the first variable grows after the return mapping of a step
        excess = np.minimum(excess, limit * law.return_map(*stress, known, params, dt=0.0)[-1] / scale)
    worst = int(excess.argmax())
    if excess[worst] <= limit:
        return None
    return Violation(
        "a stress is outside the yield surface, normalised by its magnitude",
        excess[worst],
        int(rows[suspects[worst]]),
    )


def invalid_nodes(state: CheckedState, limit: float) -> Violation | None:
    """Nodes have finite values and no negative mass; nodes without mass have no velocity."""
    solver = state.solver
    assert solver.tiles is not None  # checks follow steps
    tiles = solver.tiles.active // solver.grid.tile_doubles
    nodes = solver.grid.nodes.reshape(-1, solver.grid.tile_doubles)[tiles].reshape(-1, NODE)
    m = nodes[:, 0]
    if np.isfinite(nodes.sum()) and m.min() >= limit and not nodes[m == 0.0].any():
        return None
    is_invalid = ~np.isfinite(nodes).all(axis=1) | (m < limit) | ((m == 0.0) & nodes.any(axis=1))
    first = int(np.flatnonzero(is_invalid)[0])
    size = solver.grid.tile_doubles // NODE
    address = int(solver.tiles.active[first // size]) + first % size * NODE
    return Violation(
        "a node has a negative mass, a velocity without mass, or a value that is not finite (NaN)",
        m[first],
        position=node_position(solver.grid, address),
    )


def node_position(grid: Grid, address: int) -> tuple[float, ...] | None:
    """Position of the node at an address of `grid.nodes`, m; None if the address only pads a tile."""
    found = np.argwhere(grid.ax[:, None, None] + grid.ay[:, None] + grid.az == address)
    if not len(found):
        return None
    origin = (grid.origin_x, grid.origin_y, grid.origin_z)
    position = tuple(float(x + grid.h * i) for x, i in zip(origin, found[0], strict=True))
    return position if grid.n_z > 1 else position[:2]


def principal_stresses(
    xx: np.ndarray, yy: np.ndarray, zz: np.ndarray, xy: np.ndarray, yz: np.ndarray, xz: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Principal stresses s1 >= s2 >= s3 (n,) of stresses given by component, to 1e-8 of their differences.

    Closed form with the Lode angle, for arrays of points. The kernels have their own form for vector registers.
    """
    mean = (xx + yy + zz) / 3.0
    if not yz.any() and not xz.any():  # two dimensions
        centre, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
        radius = np.sqrt(half * half + xy * xy)
        largest, least = np.maximum(zz, centre + radius), np.minimum(zz, centre - radius)
        return largest, 3.0 * mean - largest - least, least
    a, b, c = xx - mean, yy - mean, zz - mean
    j2 = 0.5 * (a * a + b * b + c * c) + xy * xy + yz * yz + xz * xz
    j3 = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz)
    radius = np.sqrt(j2 / 3.0)
    lode = np.arccos(np.clip(0.5 * j3 / np.where(radius > 0.0, radius, 1.0) ** 3, -1.0, 1.0)) / 3.0
    largest, least = mean + 2.0 * radius * np.cos(lode), mean + 2.0 * radius * np.cos(lode + 2.0 * np.pi / 3.0)
    return largest, 3.0 * mean - largest - least, least


CHECKS = (
    StateCheck(
        name="energy",
        find=energy_gain,
        limit=0.05,
        likely=TIME_STEP_TOO_LARGE + "; or sand so stiff that points squeezed between nodes rebound",
        remedy=LOWER_TIME_STEP + ", or lower material.youngs_modulus",
        smaller_step_helps=True,
    ),
    StateCheck(name="ledger", find=ledger_residual, limit=1e-6, likely=CORRUPTED, remedy=REPORT),
    StateCheck(
        name="time step",
        find=time_step,
        limit=0.1,
        likely="a point that dilates without bound, or a corrupted clock",
        remedy=OPENING_STRAIN + "; else " + REPORT,
    ),
    StateCheck(name="yield surface", find=outside_surface, limit=1e-6, likely=NO_RETURN, remedy=CHECK_LAW),
    StateCheck(name="yield surface", find=outside_softened_surface, limit=0.01, likely=NO_RETURN, remedy=CHECK_LAW),
    StateCheck(
        name="nodes", find=invalid_nodes, limit=0.0, likely=CORRUPTED, remedy=REPORT, smaller_step_helps=True
    ),
)  # fmt: skip
