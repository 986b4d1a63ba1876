"""The time step of a case, compared with the stability limit of a single particle anywhere in its column."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import floor, isinf, sqrt
from typing import NamedTuple

from mpmcol.case import Case
from mpmcol.mpm.boundary import AXIS, CONTACT, FREE, NO_SLIP, OPEN_END, BoundaryType
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.setup.geometry import domain_faces, points_per_axis
from mpmcol.setup.stability_limit import MIDWAY, TRANSFER_COEFFICIENTS, SingleParticle, single_particle_limit


class Position(NamedTuple):
    """Position of a particle along one axis, in cells, and the boundary at the first node of that axis."""

    s: float
    face: BoundaryType


BETWEEN_NODES = Position(MIDWAY, FREE)
BESIDE_WALL = Position(CONTACT.gap, CONTACT)  # of [[walls]]


def axis_gap(case: Case) -> float:
    """Least distance of particles from the axis, in h: that of the boundary, but no more than their initial one."""
    return min(AXIS.gap, 0.5 / points_per_axis(case))


def case_limit(case: Case) -> tuple[float, str]:
    """The largest time.cfl for which a single particle of the column is stable everywhere, and its critical position.

    Along each axis the critical positions are midway between nodes, and as close to a wall, the floor or the axis as
    particles are allowed; next to a wall with friction, a particle that separates from it is the least stable. For
    linear shape functions it is a line of nodes, where no time step is stable.
    """
    if isinf(SHAPE_FUNCTIONS[case.method.basis].STIFFNESS):
        return 0.0, "on a line of nodes"
    return min((_limit(case, positions), _describe(positions)) for positions in _critical_positions(case))


def _critical_positions(case: Case) -> Iterator[tuple[Position, ...]]:
    """In the domain, and beside one face of a wall that stands in it."""
    axes = tuple(_positions_along_axes(case))
    yield from product(*axes)
    for axis in range(len(axes) if case.walls else 0):
        yield from product(*axes[:axis], [BESIDE_WALL], *axes[axis + 1 :])


def _positions_along_axes(case: Case) -> Iterator[tuple[Position, ...]]:
    """Along x, y and, in 3D, z. The column does not reach open ends, nor the floor below an elastic base."""
    for low, _ in domain_faces(case):
        if low == OPEN_END or (low == NO_SLIP and case.geometry.base == "elastic"):
            yield (BETWEEN_NODES,)
        else:
            yield BETWEEN_NODES, Position(axis_gap(case) if low == AXIS else low.gap, low)


def _limit(case: Case, positions: tuple[Position, ...]) -> float:
    """The smallest limit among the materials of the column and of a granular bed."""
    moving = case.materials if case.geometry.base == "granular" else (case.material, *case.materials[2:])
    return min(_limit_of(case, positions, nu) for nu in {material.poissons_ratio for material in moving})


def _limit_of(case: Case, positions: tuple[Position, ...], nu: float) -> float:
    method = case.method
    return single_particle_limit(
        SingleParticle(
            position=tuple(each.s for each in positions),
            nu=nu,
            faces=tuple(each.face for each in positions),
            axisymmetric=case.geometry.model == "axisymmetric" and positions[0] != BESIDE_WALL,  # far from the axis
            transfer=method.transfer,
            flip_fraction=method.flip_fraction,
            basis=method.basis,
            correction=method.kernel_correction,
        )
    )


def _describe(positions: tuple[Position, ...]) -> str:
    names = [each.face.name for each in positions if each.face != FREE]
    if not names:
        return "midway between nodes"
    return "next to " + " and ".join(_counted(name, names.count(name)) for name in dict.fromkeys(names))


def _counted(name: str, count: int) -> str:
    noun, *rest = name.split(" with ")
    return f"the {name}" if count == 1 else " with ".join([f"{('two', 'three')[count - 2]} {noun}s", *rest])


def time_step_limit(case: Case) -> str:
    """The stability limit of a single particle in this case, as a clause of a message."""
    limit, where = case_limit(case)
    if limit == 0.0:
        return f'with method.basis = "{case.method.basis}" no time step is stable for a single particle {where}'
    return f"a single particle {where} is stable up to {rounded_down(limit):g} in this case"


def rounded_down(limit: float) -> float:
    """A limit of time.cfl with two digits; a value that a message proposes must not exceed the limit."""
    return floor(100.0 * limit) / 100.0


def time_step_warnings(case: Case) -> list[str]:
    """A warning if time.cfl exceeds the stability limit of a single particle."""
    cfl, (limit, where) = case.time.cfl, case_limit(case)
    if limit == 0.0:
        return [
            f'method.basis = "{case.method.basis}": with time.cfl = {cfl:g} a single particle is unstable within '
            f"{_unstable_distance(case):.2g} h of a line of nodes along each axis; decrease time.cfl if it diverges"
        ]
    if cfl <= limit:
        return []
    return [
        f"time.cfl = {cfl:g} exceeds {rounded_down(limit):g}, the stability limit of a single particle {where}; "
        "decrease time.cfl if the run diverges"
    ]


def _unstable_distance(case: Case) -> float:
    """Distance from a line of nodes, in h, within which linear shape functions are unstable for a single particle.

    With weights 1 - s and s and gradients -1 and 1, in cells, omega^2 = (1 + (d - 1) nu / (1 - nu)) / (s (1 - s)) in
    units of (c / h)^2 if s is the distance along every axis; it is solved for omega dt = 2 (sqrt(2) without the Taylor
    term).
    """
    nu, taylor = case.material.poissons_ratio, TRANSFER_COEFFICIENTS[case.method.transfer][0]
    lateral = (1.0 + (case.geometry.dimension - 1) * nu / (1.0 - nu)) * (1.0 if taylor else 2.0)
    return 0.5 - 0.5 * sqrt(max(1.0 - case.time.cfl**2 * lateral, 0.0))
