"""The phases of a step in their order: the stress is updated last (the paper), first, or last with velocities anew.

USF and MUSL as in Bardenhagen 2002 (doi:10.1006/jcph.2002.7103): USF takes the strain from the nodal velocities of P2G,
before the forces; MUSL from the velocities that the moved points give to the nodes again, with the weights of the old
positions. USF's time step and its look at the points know the velocities and places before the step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.kernels.grid_update import clear, find_velocities, update_grid
from mpmcol.mpm.kernels.particle_update import make_update_points
from mpmcol.mpm.kernels.particle_update_split import make_move, make_strain
from mpmcol.mpm.kernels.transfer import make_transfer
from mpmcol.mpm.kernels.transfer_common import make_p2g
from mpmcol.mpm.settings import Scheme


def make_step(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., Any]:
    """One step in the order that the scheme names."""
    return ORDERS[scheme.stress_order](dimension, column_law, base_law, scheme)


def _make_usl(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., Any]:
    p2g = make_p2g(make_transfer(dimension, scheme.basis))
    update_points = make_update_points(dimension, column_law, base_law, scheme)

    @device
    @variant(dimension, column_law, base_law, *scheme)
    def usl(rows, grid, tiles, settings, laws, smallest_mass, dt, moved, node_report, tile_report):
        """Nodes, then points and their stress."""
        column, base, c2_column, c2_base = laws
        clear(grid, tiles)
        p2g(rows, grid, tiles, settings)
        update_grid(grid, tiles, settings, smallest_mass, dt, node_report)
        update_points(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, tile_report)

    return usl


def _make_usf(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., Any]:
    p2g, move = make_p2g(make_transfer(dimension, scheme.basis)), make_move(dimension, scheme)
    strain = make_strain(dimension, column_law, base_law, scheme)

    @device
    @variant(dimension, column_law, base_law, *scheme)
    def usf(rows, grid, tiles, settings, laws, smallest_mass, dt, moved, node_report, tile_report):
        """Stress from the nodal velocities of P2G, then nodes, then points."""
        column, base, c2_column, c2_base = laws
        clear(grid, tiles)
        p2g(rows, grid, tiles, settings)
        find_velocities(grid, tiles, smallest_mass)
        strain(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, moved, tile_report)
        clear(grid, tiles)
        p2g(rows, grid, tiles, settings)
        update_grid(grid, tiles, settings, smallest_mass, dt, node_report)
        move(rows, grid, tiles, settings, dt, moved, tile_report)

    return usf


def _make_musl(
    dimension: int, column_law: ConstitutiveLaw, base_law: ConstitutiveLaw, scheme: Scheme
) -> Callable[..., Any]:
    p2g, move = make_p2g(make_transfer(dimension, scheme.basis)), make_move(dimension, scheme)
    strain = make_strain(dimension, column_law, base_law, scheme)

    @device
    @variant(dimension, column_law, base_law, *scheme)
    def musl(rows, grid, tiles, settings, laws, smallest_mass, dt, moved, node_report, tile_report):
        """Nodes, then points, then stress from what the points' new velocities are at the nodes."""
        column, base, c2_column, c2_base = laws
        clear(grid, tiles)
        p2g(rows, grid, tiles, settings)
        update_grid(grid, tiles, settings, smallest_mass, dt, node_report)
        move(rows, grid, tiles, settings, dt, moved, tile_report)
        clear(grid, tiles)
        p2g(rows, grid, tiles, settings)
        find_velocities(grid, tiles, smallest_mass)
        strain(rows, grid, tiles, settings, column, base, c2_column, c2_base, dt, moved, tile_report)

    return musl


ORDERS = {"usl": _make_usl, "usf": _make_usf, "musl": _make_musl}
