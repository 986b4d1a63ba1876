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

StepFactory = Callable[[int, ConstitutiveLaw, ConstitutiveLaw, Scheme], Callable[..., Any]]


class State(NamedTuple):
    """All that the steps of a simulation read and write."""

    rows: np.ndarray  # records of the points, flat
    grid: Grid
    contacts: Contacts
    tiles: Tiles
    settings: Settings
    bodies: Bodies
    smallest_mass: float  # of all points, kg
    node_report: np.ndarray  # (n_active, NODE_REPORT) of each tile of nodes
    tile_report: np.ndarray  # (n_tiles, TILE_REPORT) of each tile of points
    clock: np.ndarray  # (CLOCK,)
    ledger: np.ndarray  # (LEDGER,)


def make_step(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., Any]:
    """One step(state, dt, pending) in the order of the scheme; `pending` (n, 8) is a buffer for MUSL."""
    return STRESS_ORDERS[scheme.stress_order](dimension, column_law, base_law, scheme)


def _make_usl(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., Any]:
    p2g = make_p2g(dimension, scheme.basis)
    update_points = make_update_points(dimension, column_law, base_law, scheme)

    @device
    @variant(dimension, column_law, base_law, *scheme)
    def usl(state, dt, pending):
        """Nodes, then points and their stress."""
        rows, grid, contacts, tiles, settings, bodies, smallest_mass, node_report, tile_report, _, _ = state
        column, base, c2_column, c2_base = bodies
        side_rate = dt * contacts.side_friction
        clear(grid, tiles)
        p2g(rows, grid, tiles, settings)
        update_grid(grid, contacts, tiles, settings, smallest_mass, dt, node_report)
        update_points(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, side_rate, tile_report)

    return usl


def _make_usf(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., Any]:
    p2g, g2p = make_p2g(dimension, scheme.basis), make_g2p(dimension, scheme)
    update_stresses = make_update_stresses(dimension, column_law, base_law, scheme)

    @device
    @variant(dimension, column_law, base_law, *scheme)
    def usf(state, dt, pending):
        """Stress from the nodal velocities of P2G, then nodes, then points."""
        rows, grid, contacts, tiles, settings, bodies, smallest_mass, node_report, tile_report, _, _ = state
        column, base, c2_column, c2_base = bodies
        side_rate = dt * contacts.side_friction
        clear(grid, tiles)
        p2g(rows, grid, tiles, settings)
        find_velocities(grid, contacts, tiles, smallest_mass)
        update_stresses(
            rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, side_rate, pending, tile_report
        )
        clear(grid, tiles)
        p2g(rows, grid, tiles, settings)
        update_grid(grid, contacts, tiles, settings, smallest_mass, dt, node_report)
        g2p(rows, grid, tiles, settings, dt, pending, tile_report)

    return usf


def _make_musl(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., Any]:
    p2g, g2p = make_p2g(dimension, scheme.basis), make_g2p(dimension, scheme)
    update_stresses = make_update_stresses(dimension, column_law, base_law, scheme)

    @device
    @variant(dimension, column_law, base_law, *scheme)
    def musl(state, dt, pending):
        """Nodes, then points, then stress from the nodal velocities that follow from the new point velocities."""
        rows, grid, contacts, tiles, settings, bodies, smallest_mass, node_report, tile_report, _, _ = state
        column, base, c2_column, c2_base = bodies
        side_rate = dt * contacts.side_friction
        clear(grid, tiles)
        p2g(rows, grid, tiles, settings)
        update_grid(grid, contacts, tiles, settings, smallest_mass, dt, node_report)
        g2p(rows, grid, tiles, settings, dt, pending, tile_report)
        clear(grid, tiles)
        p2g(rows, grid, tiles, settings)
        find_velocities(grid, contacts, tiles, smallest_mass)
        update_stresses(
            rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, side_rate, pending, tile_report
        )

    return musl


STRESS_ORDERS: dict[str, StepFactory] = {"usl": _make_usl, "usf": _make_usf, "musl": _make_musl}
