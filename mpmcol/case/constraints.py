"""Constraints between the keys of a case."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from mpmcol.case.fields import shown
from mpmcol.case.outline import Outline, extent, is_rectangle
from mpmcol.experiments import EXPERIMENTS, column_kind


@dataclass(frozen=True)
class Constraint:
    """A condition on the values of `keys`; the message is about the first key, {1} in it is replaced by the second."""

    keys: tuple[str, ...]
    holds: Callable[..., bool]
    message: str


@dataclass(frozen=True)
class ViolatedConstraint:
    """A constraint that a case violates, with the values of its keys."""

    constraint: Constraint
    values: tuple[Any, ...]

    @property
    def key(self) -> str:
        """The key that the message is about."""
        return self.constraint.keys[0]

    @property
    def message(self) -> str:
        """What was expected, with the other keys and their values."""
        named = (f"{key} = {shown(value)}" for key, value in zip(self.constraint.keys, self.values, strict=True))
        return self.constraint.message.format(*named)


def violations(values: Mapping[str, Any]) -> Iterator[ViolatedConstraint]:
    """Check all constraints whose keys are in `values` (dotted name to value, None if absent)."""
    for constraint in CONSTRAINTS:
        if all(key in values for key in constraint.keys):
            violation = ViolatedConstraint(constraint, tuple(values[key] for key in constraint.keys))
            if not constraint.holds(*violation.values):
                yield violation


def _less(smaller: float | None, larger: float | None) -> bool:
    return smaller is None or larger is None or smaller < larger


def _at_most(smaller: float | None, larger: float | None) -> bool:
    return smaller is None or larger is None or smaller <= larger


def _increasing(times: tuple[float, ...] | None) -> bool:
    return times is None or (len(times) > 0 and all(a < b for a, b in itertools.pairwise(times)))


def _experiment_fits(name: str, model: str, section: str) -> bool:
    return name not in EXPERIMENTS or EXPERIMENTS[name].model == column_kind(model, section)


def _not_both(one: Any, other: Any) -> bool:
    return one is None or other is None


def _ends_before(outline: Outline | None, limit: float | None, axis: int) -> bool:
    return outline is None or limit is None or extent(outline)[axis] < limit


def _top_is_wide(
    sides: str, slope: float, model: str, radius: float | None, height: float | None, aspect: float | None
) -> bool:
    """Whether a plane column with vertical sides has a top: r_i > h_i tan(slope)."""
    if sides == "normal" or model != "plane" or radius is None:
        return True
    return radius > (radius * (aspect or 0.0) if height is None else height) * math.tan(math.radians(slope))


FILTER_STRENGTH = 0.5  # default of method.filter_strength
_3D = ("quarter", "full")
_ORDERED_ANGLES = (
    ("dilatancy", "friction"),
    ("dilatancy_peak", "friction_peak"),
    ("dilatancy_residual", "friction_residual"),
    ("friction_residual", "friction_peak"),
    ("dilatancy_residual", "dilatancy_peak"),
)
_SMALLER = "must be smaller than {1}"
_LARGER = "must be larger than {1}"
_AT_MOST = "must not exceed {1}"

_NOT_BOTH = "must not be given together with {1}: remove one of them"

CONSTRAINTS = (
    Constraint(("geometry.height", "geometry.aspect"), _not_both, _NOT_BOTH),
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
    Constraint(("geometry.radius", "geometry.outline"), _not_both, _NOT_BOTH),
    Constraint(("geometry.height", "geometry.outline"), _not_both, _NOT_BOTH),
    Constraint(("geometry.aspect", "geometry.outline"), _not_both, _NOT_BOTH),
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
    Constraint(("grid.spacing", "geometry.radius"), _less, _SMALLER),
    Constraint(("grid.spacing", "geometry.depth"), _less, _SMALLER),
    Constraint(("grid.spacing", "geometry.height"), _less, _SMALLER),
    Constraint(
        ("grid.spacing", "geometry.aspect", "geometry.radius"),
        lambda h, a, r: a is None or r is None or h < a * r,
        "must be smaller than the column's height, with {1} and {2}",
    ),
    Constraint(
        ("grid.spacing", "geometry.outline"),
        lambda h, outline: outline is None or h < min(extent(outline)),
        "must be smaller than the largest x and y of {1}",
    ),
    Constraint(
        ("geometry.base_thickness", "grid.spacing", "geometry.base"),
        lambda thickness, h, base: base == "rigid" or thickness >= h,
        "must be at least one cell high, {1}",
    ),
    Constraint(("geometry.domain_length", "geometry.radius"), lambda length, r: _less(r, length), _LARGER),
    Constraint(("geometry.domain_height", "geometry.height"), lambda top, h: _less(h, top), _LARGER),
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
    *(
        Constraint((f"{table}.{smaller}_deg", f"{table}.{larger}_deg"), _at_most, _AT_MOST)
        for table in ("material", "base_material")
        for smaller, larger in _ORDERED_ANGLES
    ),
    *(
        Constraint((f"{table}.cohesion_residual", f"{table}.cohesion"), _at_most, _AT_MOST)
        for table in ("material", "base_material")
    ),
    *(Constraint((f"{table}.mu_s", f"{table}.mu_2"), _at_most, _AT_MOST) for table in ("material", "base_material")),
    *(
        Constraint(
            (f"{table}.friction_deg", f"{table}.cohesion"),
            lambda friction, cohesion: friction != 0.0 or cohesion != 0.0,
            "needs a cohesion, not {1}: material without both has no strength",
        )
        for table in ("material", "base_material")
    ),
    *(
        Constraint(
            (f"{table}.tension", f"{table}.cohesion", f"{table}.friction_deg"),
            lambda tension, cohesion, friction: (
                not tension or not friction or tension <= cohesion / math.tan(math.radians(friction)) * (1.0 + 1e-9)
            ),
            "must not exceed c cot(phi), with {1} and {2}",
        )
        for table in ("material", "base_material")
    ),
    Constraint(
        ("method.flip_fraction", "method.transfer"),
        lambda fraction, transfer: fraction == 1.0 or transfer in ("taylor-flip", "flip"),
        "has no meaning with {1}, which has no FLIP update: remove it",
    ),
    Constraint(
        ("method.kernel_correction", "method.basis"),
        lambda correction, basis: correction or basis != "linear",
        "has no meaning with {1}, which needs no correction: remove it",
    ),
    Constraint(
        ("method.stress_filter", "method.kernel_correction"),
        lambda stress_filter, correction: stress_filter in (None, "none") or correction,
        'must be "none" with {1}: averages beside walls need the correction',
    ),
    Constraint(
        ("method.filter_strength", "method.stress_filter"),
        lambda strength, stress_filter: strength == FILTER_STRENGTH or stress_filter != "none",
        "has no meaning with {1}: remove it",
    ),
    Constraint(
        ("method.transfer", "method.basis"),
        lambda transfer, basis: transfer != "apic" or basis != "linear",
        'must not be "apic" with {1}, where it equals "tpic": use "tpic"',
    ),
    Constraint(
        ("method.transfer", "method.kernel_correction"),
        lambda transfer, correction: transfer != "apic" or correction,
        'must not be "apic" with {1}: APIC requires shape functions that sum to one next to walls',
    ),
    Constraint(
        ("friction.floor", "geometry.base"),
        lambda mu, base: mu is None or base == "rigid",
        'needs a rigid floor, not {1}: set geometry.base = "rigid"',
    ),
    *(
        Constraint(
            (key, "method.wall_impulse"),
            lambda value, impulse: value is None or value is False or impulse,
            "needs the reaction of walls, not {1}: set method.wall_impulse = true",
        )
        for key in ("friction.floor", "friction.back_wall", "output.wall_forces")
    ),
    Constraint(
        ("friction.back_wall", "geometry.model", "geometry.release"),
        lambda mu, model, release: mu is None or (model == "plane" and release == "one-sided"),
        "needs a wall at x = 0, which only a one-sided plane column has, not {1}, {2}: remove it",
    ),
    Constraint(
        ("friction.side_walls", "geometry.model"),
        lambda mu, model: mu is None or model == "plane",
        "needs a channel in plane strain, not {1}: remove it",
    ),
    *(
        Constraint(
            keys,
            lambda one, other: one is None or other is not None,
            "is given, but {1}: give both, or neither",
        )
        for keys in itertools.permutations(("friction.side_walls", "friction.channel_width"))
    ),
    Constraint(
        ("output.wall_forces", "method.deactivate_base"),
        lambda forces, deactivate: not forces or not deactivate,
        "must be false with {1}: an inactive base transmits no forces to the floor",
    ),
    Constraint(
        ("method.deactivate_base", "geometry.base"),
        lambda deactivate, base: not deactivate or base == "elastic",
        "must be false with {1}: a rigid floor has no material points, and a granular bed moves",
    ),
    Constraint(
        ("base_material.law", "geometry.base"),
        lambda law, base: law is None or (law != "elastic") == (base == "granular"),
        'must be "elastic" with an elastic or rigid base and another law with a granular one, {1}',
    ),
    Constraint(
        ("stages.equilibrate.law", "material.law"),
        lambda stage_law, law: stage_law in (None, "elastic", law),
        'must be "elastic" or that of the column, {1}',
    ),
    Constraint(
        ("stages.gate_speed", "stages.gate"),
        lambda speed, gate: gate or speed == math.inf,
        "has no meaning with {1}: remove it",
    ),
    Constraint(("output.times",), _increasing, "must be at least one time, in increasing order"),
    Constraint(
        ("score.experiment", "geometry.model", "geometry.section"),
        _experiment_fits,
        "is for another kind of column than {1} and {2}",
    ),
    Constraint(
        ("score.experiment", "geometry.outline"),
        lambda name, outline: name == "paper" or outline is None or is_rectangle(outline),
        "has no meaning with {1}: published columns are rectangles; remove it",
    ),
)
