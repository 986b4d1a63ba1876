"""Size of the domain, from the expected runout."""

from __future__ import annotations

from math import radians, tan

from mpmcol.case import Case
from mpmcol.errors import UsageError
from mpmcol.experiments import expected_runout
from mpmcol.mpm.boundary import OPEN_END

RUNOUT_MARGIN = 0.5  # r_i beyond the longest runout among the experiments
RIGID_BASE_FACTOR = 2.0  # on the runout over a rigid base, where the empty part of the domain costs nothing
REFERENCE_FRICTION, LEAST_FRICTION = 33.0, 10.0  # degrees: sand of the experiments; lower values enlarge no further
HEADROOM_CELLS = 6
LEAST_CELLS = OPEN_END.zone_cells + 1  # between the column and the open ends or the top


def domain_size(case: Case, h: float) -> tuple[float, float]:
    """Length from wall or axis and height above the base, m; raises UsageError if given values are too small."""
    geometry = case.geometry
    runout = expected_runout(geometry.model, geometry.a, geometry.section) * _friction_runout_factor(case)
    runout *= RIGID_BASE_FACTOR if geometry.base == "rigid" else 1.0
    widest = max(geometry.r_i, geometry.depth or 0.0)
    length = geometry.domain_length or widest + geometry.r_i * (runout + RUNOUT_MARGIN) + OPEN_END.zone_cells * h
    height = geometry.domain_height or geometry.h_i + HEADROOM_CELLS * h
    for key, given, least in (
        ("domain_length", length, widest + LEAST_CELLS * h),
        ("domain_height", height, geometry.h_i + LEAST_CELLS * h),
    ):
        if given < least:
            raise UsageError(
                f"geometry.{key} = {given:g} m is too small for the column: at least {least:g} m are needed; "
                "increase it, or omit it to size the domain from the expected runout"
            )
    return length, height


def _friction_runout_factor(case: Case) -> float:
    """Runout relative to that of the reference sand: inversely proportional to tan(friction), at least 1."""
    material = case.material
    friction = getattr(material, "friction_residual_deg", getattr(material, "friction_deg", REFERENCE_FRICTION))
    return max(tan(radians(REFERENCE_FRICTION)) / tan(radians(max(friction, LEAST_FRICTION))), 1.0)
