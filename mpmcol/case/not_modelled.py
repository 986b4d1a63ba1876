"""Answers to keys for what `mpmcol` does not model, or for what another key gives; README.md lists the limitations."""

from __future__ import annotations

import re

from mpmcol.case.toml_lines import KeyPath

_LONGEST = 200  # characters of a key that are searched
_WALL = "base|basal|bed|bottom|boundary|contact|gate|ground|interface|wall"
_FRICTION = "friction|mu|roughness|slip"
# patterns of whole parts of a key, between dots and underscores -> answer; the first that matches applies
_ANSWERS = {
    rf"(floor|{_WALL})_({_FRICTION})|friction_({_WALL})|(mu|roughness|slip)_(floor|{_WALL})": (
        'friction with floor and walls is given in the table friction: friction.floor, with geometry.base = "rigid", '
        "and friction.back_wall"
    ),
    "slope(?!_deg)|sloped|inclination|inclined|incline|tilt|tilted": (
        "the slope of the base is geometry.slope_deg, in degrees"
    ),
    "water|pore|fluid|saturation|saturated|permeability|moisture|suction|drained": (
        "pore fluid is not modelled: the material is dry"
    ),
    "undrained|s_?u|c_?u|tresca": (
        "undrained shear strength is material.cohesion with material.friction_deg = 0, of law mohr-coulomb"
    ),
    "layer|layering|stratum|strata": "layers of the column are [[layers]]",
    "obstacle|obstacles|barrier|barriers|baffle|pillar|dam": "obstacles and end walls are boxes: [[walls]]",
    "viscosity|viscous|inertial|rheology|mu_i|mu_0|mus|mu2|i0|d50|grain_size|rate_dependent": (
        'friction that depends on the rate of strain is material.law = "mu-i", with mu_s, mu_2, I_0, '
        "grain_diameter and grain_density; there is no viscosity"
    ),
    "mu(?!_[s2])|friction_coefficient|coefficient_of_friction|internal_friction|phi|friction_angle": (
        "friction is given as an angle: material.friction_deg, atan(mu) for a coefficient mu; of law mu-i as the "
        "coefficients mu_s and mu_2"
    ),
    "tensile|cutoff|capillary|cohesive": (
        "the tensile strength is material.tension, of the Mohr-Coulomb laws, at most material.cohesion / "
        "tan(friction_deg)"
    ),
}
_PATTERNS = {re.compile(rf"(?:^|_)(?:{parts})(?:_|$)"): answer for parts, answer in _ANSWERS.items()}


# names of a friction coefficient or angle, and where they belong in the tables whose own keys are friction
_COEFFICIENT = re.compile(
    r"mu|phi|delta|angle|coefficient|roughness|(mu|coefficient)_?friction|friction_?(deg|angle|coefficient)"
)
_OF_TABLE = {
    "friction": 'give it to floor, back_wall or side_walls: a coefficient such as 0.4, or an angle such as "22 deg"',
    "walls": 'the friction of a wall is its key friction: a coefficient such as 0.4, or an angle such as "22 deg"',
}


def answer_to(key: KeyPath) -> str | None:
    """The answer to an unknown key, found from its parts; None if there is no special one."""
    if key[0] in _OF_TABLE and len(key) > 1 and _COEFFICIENT.fullmatch(key[-1].lower()[:_LONGEST]):
        return _OF_TABLE[key[0]]
    name = "_".join(key).lower()[:_LONGEST]
    return next((answer for pattern, answer in _PATTERNS.items() if pattern.search(name)), None)
