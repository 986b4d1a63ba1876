"""Constraints between the keys of the column, its domain and its grid."""

from __future__ import annotations

import math

from mpmcol.case.constraint import LARGER, NOT_BOTH, SMALLER, Constraint, less, not_both
from mpmcol.case.outline import Outline, extent

_3D = ("quarter", "full")


def _ends_before(outline: Outline | None, limit: float | None, axis: int) -> bool:
    return outline is None or limit is None or extent(outline)[axis] < limit


def _top_is_wide(
    sides: str, slope: float, model: str, radius: float | None, height: float | None, aspect: float | None
) -> bool:
    """Whether a plane column with vertical sides has a top: r_i > h_i tan(slope)."""
    if sides == "normal" or model != "plane" or radius is None:
        return True
    return radius > (radius * (aspect or 0.0) if height is None else height) * math.tan(math.radians(slope))


GEOMETRY = (
    Constraint(("geometry.height", "geometry.aspect"), not_both, NOT_BOTH),
    Constraint(
        ("geometry.radius", "geometry.outline"),
        lambda radius, outline: radius is not None or outline is not None,
        "is missing: give geometry.radius, or geometry.outline for a column that is no rectangle",
    ),
    Constraint(
        ("geometry.aspect", "geometry.height", "geometry.outline"),
        lambda a, h, outline: h is not None or a is not None or outline is not None,
        "is missing: give geometry.aspect or geometry.height",
    ),
    Constraint(("geometry.radius", "geometry.outline"), not_both, NOT_BOTH),
    Constraint(("geometry.height", "geometry.outline"), not_both, NOT_BOTH),
    Constraint(("geometry.aspect", "geometry.outline"), not_both, NOT_BOTH),
    Constraint(
        ("geometry.outline", "geometry.model"),
        lambda outline, model: outline is None or model not in _3D,
        'must be absent with {1}: outlines are for "plane" and "axisymmetric"',
    ),
    Constraint(
        ("geometry.release", "geometry.model"),
        lambda release, model: release == "one-sided" or model == "plane",
        'must be "one-sided" with {1}',
    ),
    Constraint(
        ("geometry.slope_deg", "geometry.model"),
        lambda slope, model: slope == 0.0 or model in ("plane", "full"),
        'must be 0 with {1}: a slope is not symmetric about the axis of the column; use "plane" or "full"',
    ),
    Constraint(
        ("geometry.slope_deg", "geometry.release"),
        lambda slope, release: slope == 0.0 or release == "one-sided",
        'must be 0 with {1}: the two sides of a slope differ; use "one-sided"',
    ),
    Constraint(
        ("geometry.sides", "geometry.slope_deg"),
        lambda sides, slope: sides == "normal" or slope > 0.0,
        "has no meaning with {1}, where vertical sides are normal to the base: remove it",
    ),
    Constraint(
        ("geometry.sides", "geometry.outline"),
        lambda sides, outline: sides == "normal" or outline is None,
        "must be absent with {1}: its points describe the sides",
    ),
    Constraint(
        ("geometry.sides", "stages.initial_stress", "geometry.model"),
        lambda sides, stress, model: sides == "normal" or stress != "k0" or model == "plane",
        'must be "normal" with {1} and {2}: only gravity loading finds the stress of a column that leans to all sides; '
        'set stages.initial_stress = "gravity"',
    ),
    Constraint(
        (
            "geometry.sides",
            "geometry.slope_deg",
            "geometry.model",
            "geometry.radius",
            "geometry.height",
            "geometry.aspect",
        ),
        _top_is_wide,
        "leads the front of the column to the wall below its top, with {1}, {3}, {4} and {5}: give a larger "
        "geometry.radius, or describe the triangle by geometry.outline",
    ),
    Constraint(
        ("geometry.section", "geometry.model"),
        lambda section, model: section == "cylinder" or model in _3D,
        'must be "cylinder" with {1}',
    ),
    Constraint(
        ("geometry.depth", "geometry.section"),
        lambda depth, section: depth is None or section == "box",
        "has no meaning with {1}: remove it",
    ),
    Constraint(
        ("grid.points_per_cell", "geometry.model"),
        lambda number, model: model in _3D or number in (None, 1, 4, 9, 16),
        "must be 1, 4, 9 or 16 with {1}",
    ),
    Constraint(
        ("grid.points_per_cell", "geometry.model"),
        lambda number, model: model not in _3D or number in (None, 1, 8, 27),
        "must be 1, 8 or 27 with {1}",
    ),
    Constraint(("grid.spacing", "geometry.radius"), less, SMALLER),
    Constraint(("grid.spacing", "geometry.depth"), less, SMALLER),
    Constraint(("grid.spacing", "geometry.height"), less, SMALLER),
    Constraint(
        ("grid.spacing", "geometry.aspect", "geometry.radius"),
        lambda h, a, r: a is None or r is None or h < a * r or h >= r,  # the latter is reported above
        "must be smaller than the column's height, with {1} and {2}",
    ),
    Constraint(
        ("grid.spacing", "geometry.outline"),
        lambda h, outline: outline is None or h < min(extent(outline)),
        "must be smaller than the largest x and y of {1}",
    ),
    Constraint(
        ("geometry.base_thickness", "grid.spacing", "geometry.base", "geometry.radius"),
        lambda thickness, h, base, r: base == "rigid" or thickness >= h or not less(h, r),  # the latter: as above
        "must be at least one cell high, {1}",
    ),
    Constraint(("geometry.domain_length", "geometry.radius"), lambda length, r: less(r, length), LARGER),
    Constraint(("geometry.domain_height", "geometry.height"), lambda top, h: less(h, top), LARGER),
    Constraint(
        ("geometry.domain_height", "geometry.aspect", "geometry.radius"),
        lambda top, a, r: top is None or a is None or r is None or a * r < top,
        "must be larger than the column's height, with {1} and {2}",
    ),
    Constraint(
        ("geometry.domain_length", "geometry.outline"),
        lambda length, outline: _ends_before(outline, length, 0),
        "must be larger than the largest x of {1}",
    ),
    Constraint(
        ("geometry.domain_height", "geometry.outline"),
        lambda top, outline: _ends_before(outline, top, 1),
        "must be larger than the largest y of {1}",
    ),
)
