"""The catalogue: a scene is an entry of SCENES in a file here, and the file a word in FAMILIES."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module

from mpmcol.errors import UsageError
from mpmcol.failure_modes.scenario import Scene

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
    for name in names:
        if not any(scene.answers_to(name) for scene in SCENES.values()):
            near = get_close_matches(name, SCENES, n=1)
            hint = f"did you mean {near[0]!r}?" if near else "mpmcol stability --list names them"
            raise UsageError(f"no scene is called {name!r}; {hint}")
    return [scene for scene in SCENES.values() if not names or any(scene.answers_to(name) for name in names)]
