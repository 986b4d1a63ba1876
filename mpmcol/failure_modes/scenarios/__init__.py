"""The catalogue: a scene is an entry of SCENES in a file here, and the file a word in FAMILIES."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module

from mpmcol.failure_modes.scenario import Scene
from mpmcol.selection import select

FAMILIES = (
    "time_step",
    "walls",
    "moduli",
    "weights",
    "transfers",
    "quadrature",
    "locking",
    "motion",
    "damping",
    "opening",
    "initial",
    "softening",
    "collapses",
)

SCENES: dict[str, Scene] = {
    scene.name: scene for family in FAMILIES for scene in import_module(f"{__name__}.{family}").SCENES
}


def choose(names: Sequence[str]) -> list[Scene]:
    """The scenes of these names, or whose names begin with one and a hyphen; all of them without names.

    Raises UsageError for a name that means none.
    """
    return select(list(SCENES.values()), names, "scenario")
