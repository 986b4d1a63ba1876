"""What several keys of a case must satisfy together: one line a rule."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from mpmcol.case.fields import shown
from mpmcol.experiments import EXPERIMENTS, column_kind


@dataclass(frozen=True)
class Rule:
    """`holds` takes the values of `keys`; `sentence` is about the first of them, and {1} names the second."""

    keys: tuple[str, ...]
    holds: Callable[..., bool]
    sentence: str


@dataclass(frozen=True)
class BrokenRule:
    """A rule that a case breaks, with the values that do so."""

    rule: Rule
    values: tuple[Any, ...]

    @property
    def key(self) -> str:
        """The key that the sentence is about."""
        return self.rule.keys[0]

    @property
    def sentence(self) -> str:
        """What was expected, naming the other keys and their values."""
        named = (f"{key} = {shown(value)}" for key, value in zip(self.rule.keys, self.values, strict=True))
        return self.rule.sentence.format(*named)


def broken_rules(values: Mapping[str, Any]) -> Iterator[BrokenRule]:
    """Check all rules whose keys are in `values` (dotted name to value, None if absent)."""
    for rule in RULES:
        if all(key in values for key in rule.keys):
            broken = BrokenRule(rule, tuple(values[key] for key in rule.keys))
            if not rule.holds(*broken.values):
                yield broken


def _less(smaller: float | None, larger: float | None) -> bool:
    return smaller is None or larger is None or smaller < larger


def _at_most(smaller: float, larger: float) -> bool:
    return smaller <= larger


def _rising(times: tuple[float, ...] | None) -> bool:
    return times is None or (len(times) > 0 and all(a < b for a, b in itertools.pairwise(times)))


def _experiment_fits(name: str, model: str, section: str) -> bool:
    return name not in EXPERIMENTS or EXPERIMENTS[name].model == column_kind(model, section)


_IN_SPACE = ("quarter", "full")
_SMALLER = "must be smaller than {1}"
_LARGER = "must be larger than {1}"
_AT_MOST = "must not exceed {1}"

RULES = (
    Rule(
        ("geometry.height", "geometry.aspect"),
        lambda h, a: h is None or a is None,
        "cannot stand beside {1}: give one of them",
    ),
    Rule(
        ("geometry.aspect", "geometry.height"),
        lambda a, h: h is not None or a is not None,
        "is missing: give geometry.aspect or geometry.height",
    ),
    Rule(
        ("geometry.release", "geometry.model"),
        lambda release, model: release == "one-sided" or model == "plane",
        'must be "one-sided" with {1}',
    ),
    Rule(
        ("geometry.section", "geometry.model"),
        lambda section, model: section == "cylinder" or model in _IN_SPACE,
        'must be "cylinder" with {1}',
    ),
    Rule(
        ("geometry.depth", "geometry.section"),
        lambda depth, section: depth is None or section == "box",
        "must be absent with {1}",
    ),
    Rule(
        ("grid.points_per_cell", "geometry.model"),
        lambda count, model: model in _IN_SPACE or count in (None, 1, 4, 9, 16),
        "must be 1, 4, 9 or 16 with {1}",
    ),
    Rule(
        ("grid.points_per_cell", "geometry.model"),
        lambda count, model: model not in _IN_SPACE or count in (None, 1, 8, 27),
        "must be 1, 8 or 27 with {1}",
    ),
    Rule(("grid.spacing", "geometry.radius"), _less, _SMALLER),
    Rule(("grid.spacing", "geometry.depth"), _less, _SMALLER),
    Rule(("grid.spacing", "geometry.height"), _less, _SMALLER),
    Rule(
        ("grid.spacing", "geometry.aspect", "geometry.radius"),
        lambda h, a, r: a is None or h < a * r,
        "must be smaller than the column's height, with {1} and {2}",
    ),
    Rule(
        ("geometry.base_thickness", "grid.spacing", "geometry.base"),
        lambda thickness, h, base: base == "rigid" or thickness >= h,
        "must be at least one cell, {1}",
    ),
    Rule(("geometry.domain_length", "geometry.radius"), lambda length, r: _less(r, length), _LARGER),
    Rule(("geometry.domain_height", "geometry.height"), lambda top, h: _less(h, top), _LARGER),
    Rule(
        ("geometry.domain_height", "geometry.aspect", "geometry.radius"),
        lambda top, a, r: top is None or a is None or a * r < top,
        "must be larger than the column's height, with {1} and {2}",
    ),
    Rule(("material.dilatancy_deg", "material.friction_deg"), _at_most, _AT_MOST),
    Rule(("material.dilatancy_peak_deg", "material.friction_peak_deg"), _at_most, _AT_MOST),
    Rule(("material.dilatancy_residual_deg", "material.friction_residual_deg"), _at_most, _AT_MOST),
    Rule(("material.friction_residual_deg", "material.friction_peak_deg"), _at_most, _AT_MOST),
    Rule(("material.dilatancy_residual_deg", "material.dilatancy_peak_deg"), _at_most, _AT_MOST),
    Rule(
        ("method.flip_fraction", "method.transfer"),
        lambda share, transfer: share == 1.0 or transfer in ("taylor-flip", "flip"),
        "must be left out with {1}, which has no FLIP velocity",
    ),
    Rule(
        ("method.kernel_correction", "method.basis"),
        lambda correction, basis: correction or basis != "linear",
        "must be left out with {1}, whose weights need none",
    ),
    Rule(
        ("method.transfer", "method.basis"),
        lambda transfer, basis: transfer != "apic" or basis != "linear",
        'cannot be "apic" with {1}, where its matrix is the velocity gradient: the same as "tpic"',
    ),
    Rule(
        ("method.transfer", "method.kernel_correction"),
        lambda transfer, correction: transfer != "apic" or correction,
        'cannot be "apic" with {1}: beside walls its matrix needs weights that add up to one',
    ),
    Rule(
        ("method.deactivate_base", "geometry.base"),
        lambda deactivated, base: not deactivated or base == "elastic",
        "must be left out with {1}, which has no points",
    ),
    Rule(
        ("stages.equilibrate.law", "material.law"),
        lambda stage, column: stage in (None, "elastic", column),
        'must be "elastic" or the column\'s own, {1}',
    ),
    Rule(("output.times",), _rising, "must be rising times, at least one"),
    Rule(
        ("score.experiment", "geometry.model", "geometry.section"),
        _experiment_fits,
        "is no experiment for {1} and {2}",
    ),
)
