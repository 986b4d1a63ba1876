"""Size of the domain, from the expected runout."""

from __future__ import annotations

from math import radians, tan

from mpmcol.case import Case
from mpmcol.case.slope import case_slope_factor
from mpmcol.case.walls import WallTable
from mpmcol.errors import UnfitCase
from mpmcol.experiments import expected_runout
from mpmcol.mpm.boundary import OPEN_END

RUNOUT_MARGIN = 0.5  # r_i beyond the longest runout among the experiments
RIGID_BASE_FACTOR = 2.0  # on the runout over a rigid base, where the empty part of the domain costs nothing
REFERENCE_FRICTION, LEAST_FRICTION = 33.0, 10.0  # degrees: sand of the experiments; lower values enlarge no further
HEADROOM_CELLS = 6
LEAST_CELLS = OPEN_END.zone_cells + 1  # between the column and the open ends or the top


def domain_size(case: Case, h: float) -> tuple[float, float]:
    """Length from wall or axis and height above the base, m; raises UnfitCase if given values are too small."""
    geometry = case.geometry
    enough = default_length(case, h), default_height(case, h)
    length, height = geometry.domain_length or enough[0], geometry.domain_height or enough[1]
    for key, given, column, default in (
        ("domain_length", length, _half_width(case), enough[0]),
        ("domain_height", height, geometry.h_i, enough[1]),
    ):
        if given < column + LEAST_CELLS * h:
            raise UnfitCase(
                f"geometry.{key}",
                f"geometry.{key} = {given:g} m is too small for the column, {column:g} m: its last {LEAST_CELLS} cells "
                f"are not usable, so that {max(usable(given, h), 0.0):.4g} m are left",
                f"set {default:.4g} m, or omit it",
            )
    return length, height


def usable(length: float, h: float) -> float:
    """Part of the length or height of a domain that the flow can use, m: the cells at its end arrest or stop it."""
    return length - LEAST_CELLS * h


def default_length(case: Case, h: float) -> float:
    """Length of the domain that is sized by the expected runout and contains all walls, m.

    In two dimensions it ends within an end wall, in which the zone of the open end is.
    """
    walls = [max(abs(end) for end in wall.along if end is not None) + LEAST_CELLS * h for wall in case.walls]
    closed = closing_walls(case)
    if closed and case.geometry.dimension == 2:
        return min(wall.from_ for wall in closed) + LEAST_CELLS * h
    zeta = expected_zeta(case) * (RIGID_BASE_FACTOR if case.geometry.base == "rigid" else 1.0)
    length = _half_width(case) + case.geometry.r_i * (zeta + RUNOUT_MARGIN) + OPEN_END.zone_cells * h
    return max([length, *walls])


def default_height(case: Case, h: float) -> float:
    """Height of the domain above the base, m, with room above the column and the walls."""
    return max([case.geometry.h_i, *(wall.height or 0.0 for wall in case.walls)]) + HEADROOM_CELLS * h


def closing_walls(case: Case) -> list[WallTable]:
    """The end walls that the flow cannot pass."""
    return [wall for wall in case.walls if wall.closes]


def expected_front(case: Case) -> float:
    """Distance of the farthest front of experiments on such a column, as on its slope, from the wall or axis, m.

    In two dimensions it is at most that of an end wall.
    """
    front = _half_width(case) + case.geometry.r_i * expected_zeta(case)
    return min([front, *(wall.from_ for wall in closing_walls(case) if case.geometry.dimension == 2)])


def expected_zeta(case: Case) -> float:
    """Runout over r_i, the longest among the experiments, and longer for lower friction and on a slope."""
    geometry = case.geometry
    factor = _friction_runout_factor(case) * case_slope_factor(case)
    return expected_runout(geometry.model, geometry.a, geometry.section) * factor


def _half_width(case: Case) -> float:
    """Largest distance of the column from wall or axis: upslope at its top if its sides are vertical, m."""
    geometry = case.geometry
    leaning = geometry.lean * geometry.h_i if geometry.model == "full" else 0.0
    return max(geometry.r_i + leaning, geometry.depth or 0.0)


def _friction_runout_factor(case: Case) -> float:
    """Runout relative to that of the reference sand: inversely proportional to the least friction, at least 1."""
    material = case.material
    friction = getattr(material, "friction_residual_deg", getattr(material, "friction_deg", REFERENCE_FRICTION))
    least = tan(radians(max(friction, LEAST_FRICTION)))
    if case.friction.floor is not None:
        least = min(least, max(case.friction.floor, tan(radians(LEAST_FRICTION))))
    return max(tan(radians(REFERENCE_FRICTION)) / least, 1.0)
