"""Sequences of the phases of a step: stress updated last (USL, the paper's), first (USF), or modified last (MUSL).

Bardenhagen 2002 (doi:10.1006/jcph.2002.7103). USF takes the strain increment from the nodal velocities of P2G, before
the forces; MUSL from the velocities of the moved points, which are mapped to the nodes again with the weights of the
old positions. With USF, the next time step and the check of the points use the velocities and positions before the
step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.contact import Contacts
from mpmcol.mpm.grid import Grid, Tiles
from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.kernels.grid_update import clear, find_velocities, update_grid
from mpmcol.mpm.kernels.particle_update import Bodies, make_update_points
from mpmcol.mpm.kernels.particle_update_split import make_g2p, make_update_stresses
from mpmcol.mpm.kernels.transfer import make_p2g
from mpmcol.mpm.settings import Scheme, Settings


class State(NamedTuple):
    """All that the steps of a simulation read and write."""

    rows: np.ndarray  # records of the points, flat
    grid: Grid
    spare: Grid  # the same with other nodes
    contacts: Contacts
    tiles: Tiles
    shares: np.ndarray  # see `grid.share_tiles`
    settings: Settings
    bodies: Bodies
    smallest_mass: float  # of all points, kg
    node_report: np.ndarray  # (n_active, NODE_REPORT) of each tile of nodes
    tile_report: np.ndarray  # (n_tiles, TILE_REPORT) of each tile of points
    clock: np.ndarray  # (CLOCK,)
    ledger: np.ndarray  # (LEDGER,)


class Steps(NamedTuple):
    """Compiled functions of a scheme.

    begin(state) prepares the nodes for the first step of a call. step(state, grid, spare, dt, has_next, pending) is one
    step on the nodes of `grid`, and prepares those of `spare` if the call has a next one; `pending` (n, 8) is a buffer
    for MUSL.
    """

    begin: Callable[..., Any]
    step: Callable[..., Any]


def alternates(scheme: Scheme) -> bool:
    """Whether steps use the nodes of `grid` and of `spare` in turn."""
    return scheme.stress_order == "usl"


def make_steps(dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme) -> Steps:
    """The step in the order of the scheme."""
    return STRESS_ORDERS[scheme.stress_order](dimension, column_law, base_law, scheme)


def make_begin(dimension: int, scheme: Scheme) -> Callable[..., Any]:
    """`begin` of USL."""
    p2g = make_p2g(dimension, scheme.basis)

    @device
    @variant(dimension, scheme.basis)
    def begin(state):
        """P2G of the first step; that of every other step is part of the update of the points before it."""
        clear(state.grid, state.tiles)
        p2g(state.rows, state.grid, state.tiles, state.shares, state.settings)

    return begin


def _make_usl(dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme) -> Steps:
    update_points = make_update_points(dimension, column_law, base_law, scheme)

    @device
    @variant(dimension, column_law, base_law, *scheme)
    def usl(state, grid, spare, dt, has_next, pending):
        """Nodes, then points and their stress, and P2G of the next step."""
        rows, _, _, contacts, tiles, shares, settings, bodies, smallest_mass, node_report, tile_report, _, _ = state
        column, base, c2_column, c2_base = bodies
        side_rate = dt * contacts.side_friction
        update_grid(grid, spare.nodes, contacts, tiles, settings, smallest_mass, dt, node_report)
        update_points(
            rows, grid, spare, tiles, shares, settings, column, base, c2_column, c2_base, dt, side_rate, has_next,
            tile_report,
        )  # fmt: skip

    return Steps(make_begin(dimension, scheme), usl)


def _make_usf(dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme) -> Steps:
    p2g, g2p = make_p2g(dimension, scheme.basis), make_g2p(dimension, scheme)
    update_stresses = make_update_stresses(dimension, column_law, base_law, scheme)

    @device
    @variant(dimension, column_law, base_law, *scheme)
    def usf(state, grid, spare, dt, has_next, pending):
        """Stress from the nodal velocities of P2G, then nodes, then points."""
        rows, _, _, contacts, tiles, shares, settings, bodies, smallest_mass, node_report, tile_report, _, _ = state
        column, base, c2_column, c2_base = bodies
        side_rate = dt * contacts.side_friction
        clear(grid, tiles)
        p2g(rows, grid, tiles, shares, settings)
        find_velocities(grid, contacts, tiles, smallest_mass)
        update_stresses(
            rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, side_rate, pending, tile_report
        )
        clear(grid, tiles)
        p2g(rows, grid, tiles, shares, settings)
        update_grid(grid, spare.nodes[:0], contacts, tiles, settings, smallest_mass, dt, node_report)
        g2p(rows, grid, tiles, settings, dt, pending, tile_report)

    return Steps(_begin_nothing, usf)


def _make_musl(dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme) -> Steps:
    p2g, g2p = make_p2g(dimension, scheme.basis), make_g2p(dimension, scheme)
    update_stresses = make_update_stresses(dimension, column_law, base_law, scheme)

    @device
    @variant(dimension, column_law, base_law, *scheme)
    def musl(state, grid, spare, dt, has_next, pending):
        """Nodes, then points, then stress from the nodal velocities that follow from the new point velocities."""
        rows, _, _, contacts, tiles, shares, settings, bodies, smallest_mass, node_report, tile_report, _, _ = state
        column, base, c2_column, c2_base = bodies
        side_rate = dt * contacts.side_friction
        clear(grid, tiles)
        p2g(rows, grid, tiles, shares, settings)
        update_grid(grid, spare.nodes[:0], contacts, tiles, settings, smallest_mass, dt, node_report)
        g2p(rows, grid, tiles, settings, dt, pending, tile_report)
        clear(grid, tiles)
        p2g(rows, grid, tiles, shares, settings)
        find_velocities(grid, contacts, tiles, smallest_mass)
        update_stresses(
            rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, side_rate, pending, tile_report
        )

    return Steps(_begin_nothing, musl)


@device
def _begin_nothing(state):
    """Nothing: every step starts with P2G."""


StepFactory = Callable[[int, ConstitutiveLaw, ConstitutiveLaw, Scheme], Steps]
STRESS_ORDERS: dict[str, StepFactory] = {"usl": _make_usl, "usf": _make_usf, "musl": _make_musl}
