"""Constraints between the keys of a case."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from mpmcol.case.constraint import AT_MOST, Constraint, at_most
from mpmcol.case.fields import shown
from mpmcol.case.geometry_constraints import GEOMETRY
from mpmcol.case.outline import is_rectangle
from mpmcol.experiments import EXPERIMENTS, column_kind


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


def _increasing(times: tuple[float, ...] | None) -> bool:
    return times is None or (len(times) > 0 and all(a < b for a, b in itertools.pairwise(times)))


def _experiment_fits(name: str, model: str, section: str) -> bool:
    return name not in EXPERIMENTS or EXPERIMENTS[name].model == column_kind(model, section)


FILTER_STRENGTH = 0.5  # default of method.filter_strength
_ORDERED = (  # the first must not exceed the second
    ("dilatancy_deg", "friction_deg"),
    ("dilatancy_peak_deg", "friction_peak_deg"),
    ("dilatancy_residual_deg", "friction_residual_deg"),
    ("friction_residual_deg", "friction_peak_deg"),
    ("dilatancy_residual_deg", "dilatancy_peak_deg"),
    ("cohesion_residual", "cohesion"),
    ("mu_s", "mu_2"),
)


def _of_material(table: str) -> Iterator[Constraint]:
    """Constraints between the parameters of a material, whose table has this name."""
    for smaller, larger in _ORDERED:
        yield Constraint((f"{table}.{smaller}", f"{table}.{larger}"), at_most, AT_MOST)
    yield Constraint(
        (f"{table}.friction_deg", f"{table}.cohesion"),
        lambda friction, cohesion: friction != 0.0 or cohesion != 0.0,
        "needs a cohesion, not {1}: material without both has no strength",
    )
    yield Constraint(
        (f"{table}.failure_strain", f"{table}.friction_deg", f"{table}.law"),
        lambda failure, friction, law: failure in (None, math.inf) or friction != 0.0 or law != "drucker-prager",
        "has no meaning with {1} and {2}, which has no apex: remove it",
    )
    for friction in ("friction_deg", "friction_peak_deg"):
        yield Constraint(
            (f"{table}.tension", f"{table}.cohesion", f"{table}.{friction}"),
            lambda tension, cohesion, phi: (
                not tension or not phi or tension <= cohesion / math.tan(math.radians(phi)) * (1.0 + 1e-9)
            ),
            "must not exceed c cot(phi), with {1} and {2}",
        )


CONSTRAINTS = (
    *GEOMETRY,
    *_of_material("material"),
    *_of_material("base_material"),
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
        "needs a wall at x = 0, which only a one-sided plane column has, not {1}, {2}: remove it; in 3D a wall "
        "with friction is one of [[walls]]",
    ),
    Constraint(
        ("friction.side_walls", "geometry.model"),
        lambda mu, model: mu is None or model == "plane",
        "needs a channel in plane strain, not {1}: remove it; in 3D the sides of a channel are [[walls]] with "
        "side_from or side_to, and friction",
    ),
    *(
        Constraint(
            keys,
            lambda one, other: one is None or other is not None,
            f"needs {keys[1]}, which is missing: give both, or neither",
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
