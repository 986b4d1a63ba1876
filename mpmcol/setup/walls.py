"""The walls of a case: their friction, and whether their forces are recorded."""

from __future__ import annotations

from typing import NamedTuple

from mpmcol.case import Case
from mpmcol.case.walls import BACK_WALL, FLOOR, GATE_WALL
from mpmcol.mpm.boundary import Boundary

FACES = {(1, 0): FLOOR, (0, 0): BACK_WALL}  # axis and side of a face of the domain -> name of the wall


class Wall(NamedTuple):
    """A wall whose nodes are in the table of contacts."""

    name: str
    friction: float | None  # coefficient; None if it holds its nodes


def recorded_walls(case: Case) -> tuple[Wall, ...]:
    """Those of [[walls]], those with friction and, if the case asks for forces, floor, back wall and a gate."""
    geometry, friction = case.geometry, case.friction
    walls = [Wall(FLOOR, friction.floor)]
    if geometry.model == "plane" and geometry.release == "one-sided":
        walls.append(Wall(BACK_WALL, friction.back_wall))
    if case.stages.gate:
        walls.append(Wall(GATE_WALL, None))
    walls += [Wall(wall.name, wall.friction) for wall in case.walls]
    return tuple(wall for wall in walls if case.output.wall_forces or wall.friction is not None)


def as_wall(boundary: Boundary, name: str, walls: tuple[Wall, ...]) -> Boundary:
    """A boundary with number and friction of the wall of this name; unchanged if there is none."""
    for number, wall in enumerate(walls):
        if wall.name == name:
            return boundary._replace(wall=number, friction=wall.friction or 0.0)
    return boundary


def side_friction(case: Case) -> float:
    """2 mu / W of the side walls of a channel of width W, 1/m; 0 without friction."""
    friction = case.friction
    return 2.0 * (friction.side_walls or 0.0) / (friction.channel_width or 1.0)
