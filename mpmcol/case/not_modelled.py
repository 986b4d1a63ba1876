"""Answers to keys for what `mpmcol` does not model, or for what another key gives; README.md lists the limitations."""

from __future__ import annotations

import re

from mpmcol.case.toml_lines import KeyPath

_LONGEST = 200  # characters of a key that are searched
_FLOOR = "base|basal|bed|bottom|boundary|contact|floor|gate|ground|interface|wall"
# patterns of whole parts of a key, between dots and underscores -> answer; the first that matches applies
_ANSWERS = {
    rf"({_FLOOR})_(friction|mu|roughness|slip)|(friction|mu|roughness|slip)_({_FLOOR})": (
        'friction with floor and walls is not modelled: geometry.base is an elastic layer, a "granular" bed or, as '
        '"rigid", a floor without slip, and walls are smooth'
    ),
    "slope(?!_deg)|sloped|inclination|inclined|incline|tilt|tilted": (
        "the slope of the base is geometry.slope_deg, in degrees"
    ),
    "water|pore|fluid|saturation|saturated|permeability|moisture|suction|drained|undrained": (
        "pore fluid is not modelled: the material is dry"
    ),
    "layer|layers|layering|stratum|strata": "layers are not modelled: the column is of one material",
    "obstacle|obstacles|barrier|barriers|baffle|pillar": "obstacles are not modelled",
    "viscosity|viscous|inertial|rheology|mu_i|mu_s|mu_0|mu_2|mus|mu2|i_?0|d50|grain_(size|diameter)|rate_dependent": (
        "dependence on the rate of strain, such as mu(I), is not modelled; friction is material.friction_deg"
    ),
    "mu|friction_coefficient|coefficient_of_friction|internal_friction|phi|friction_angle": (
        "friction is given as an angle: material.friction_deg, atan(mu) for a coefficient mu"
    ),
    "tension|tensile|tension_cutoff|cutoff|capillary|cohesive": (
        "the tensile strength follows from material.cohesion, which is that of Mohr-Coulomb"
    ),
}
_PATTERNS = {re.compile(rf"(?:^|_)(?:{parts})(?:_|$)"): answer for parts, answer in _ANSWERS.items()}


def answer_to(key: KeyPath) -> str | None:
    """The answer to an unknown key, found from its parts; None if there is no special one."""
    name = "_".join(key).lower()[:_LONGEST]
    return next((answer for pattern, answer in _PATTERNS.items() if pattern.search(name)), None)
