"""Conditions of a column, by which experiments and studies are selected, and the experiments that a case has."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mpmcol.case.schema import Case
from mpmcol.experiments import (
    EXPERIMENTS,
    Conditions,
    Experiment,
    column_kind,
    find_experiment,
    without_laws,
)


def conditions_of(case: Case) -> Conditions:
    """Material, base, side walls and release of a column."""
    material, geometry, friction = case.material, case.geometry, case.friction
    angle = getattr(material, "friction_deg", None) or getattr(material, "friction_residual_deg", None)
    weight = material.density * geometry.gravity * geometry.h_i
    speed = case.stages.gate_speed if case.stages.gate else 0.0
    return Conditions(
        angle,
        getattr(material, "cohesion", 0.0) / weight,
        geometry.slope_deg,
        has_layers=bool(case.layers),
        has_walls=bool(case.walls),
        has_bed=geometry.base == "granular",
        floor_friction=math.inf if friction.floor is None else friction.floor,
        channel_width=(friction.channel_width if friction.side_walls else None) or math.inf,
        friction_variation=getattr(material, "friction_variation", 0.0),
        release_speed=speed / math.sqrt(geometry.gravity * geometry.h_i),
    )


def experiment_of(case: Case) -> Experiment:
    """The experiment of score.experiment; if it does not apply, one without laws whose title is the reason."""
    own = _own(case)
    reason = own.misfit(conditions_of(case)) if own.laws else ""
    return without_laws(f"{own.citation} does not apply: {reason}") if reason else own


def applicable_experiments(case: Case) -> list[Experiment]:
    """The experiments with which a case can be compared, first that of the case.

    They have been made with this kind of column, in similar conditions, and at this aspect ratio.
    """
    geometry, conditions = case.geometry, conditions_of(case)
    kind = column_kind(geometry.model, geometry.column_section)
    others = [one for one in EXPERIMENTS.values() if one.model == kind and one.kind == "laboratory"]
    return [one for one in dict.fromkeys((_own(case), *others)) if one.applies(geometry.a, conditions)]


def compared_experiment(case: Case) -> Experiment:
    """The first of `applicable_experiments`; or one without laws, whose title is the reason why there is none."""
    if found := applicable_experiments(case):
        return found[0]
    own = _own(case)
    if not own.laws:
        return own
    gaps = dict.fromkeys(law.gap(case.geometry.a) for law in own.laws)
    reason = own.misfit(conditions_of(case)) or ", ".join(gaps)
    return without_laws(f"no published experiment applies; {own.citation}: {reason}")


def common_experiments(cases: Sequence[Case]) -> tuple[Experiment, list[Experiment]]:
    """As `experiment_of`, and all others on this kind of column; only those that apply to every case."""
    own = [experiment_of(case) for case in cases]
    unfit = [one for one in own if not one.laws]
    experiment = unfit[0] if unfit else own[0]
    if unfit and len({one.title for one in own}) > 1:  # the reason is that of the first of them
        experiment = without_laws(experiment.title.replace(": ", f" to {len(unfit)} of {len(own)} runs: ", 1))
    geometry = cases[0].geometry
    kind = column_kind(geometry.model, geometry.column_section)
    others = [one for one in EXPERIMENTS.values() if one.model == kind and one != experiment]
    return experiment, [one for one in others if not any(one.misfit(conditions_of(case)) for case in cases)]


def _own(case: Case) -> Experiment:
    geometry = case.geometry
    return find_experiment(case.score.experiment, geometry.model, geometry.column_section)
