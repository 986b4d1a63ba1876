"""Conditions of a column, material, slope and layers, by which experiments and studies are selected."""

from __future__ import annotations

from mpmcol.case.schema import Case
from mpmcol.experiments import OUTLINE, Conditions, Experiment, find_experiment


def conditions_of(case: Case) -> Conditions:
    """Friction angle (residual, of a softening material; None without friction), cohesion over rho g h_i, slope, ..."""
    material, geometry = case.material, case.geometry
    friction = getattr(material, "friction_deg", None) or getattr(material, "friction_residual_deg", None)
    weight = material.density * geometry.gravity * geometry.h_i
    return Conditions(
        friction, getattr(material, "cohesion", 0.0) / weight, geometry.slope_deg, bool(case.layers), bool(case.walls)
    )


def experiment_of(case: Case) -> Experiment:
    """The experiment of score.experiment; one without laws on a slope, for an outline, and with walls in the way.

    All published columns are rectangles on a horizontal base.
    """
    geometry = case.geometry
    section = OUTLINE if case.walls else geometry.column_section
    return find_experiment(case.score.experiment, geometry.model, section, geometry.slope_deg)
