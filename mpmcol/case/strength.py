"""Strength of the column's material, by which experiments and studies are selected."""

from __future__ import annotations

from mpmcol.case.schema import Case
from mpmcol.experiments import Strength


def strength_of(case: Case) -> Strength:
    """Friction angle (residual, of a softening material; None without friction) and cohesion over rho g h_i."""
    material, geometry = case.material, case.geometry
    friction = getattr(material, "friction_deg", None) or getattr(material, "friction_residual_deg", None)
    weight = material.density * geometry.gravity * geometry.h_i
    return Strength(friction, getattr(material, "cohesion", 0.0) / weight)
