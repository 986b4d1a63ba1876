"""The catalogue: each module of MODULES lists its scenarios in SCENARIOS."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module

from mpmcol.errors import select
from mpmcol.failure_modes.scenario import Scenario

MODULES = (
    "time_step",
    "walls",
    "moduli",
    "weights",
    "transfers",
    "quadrature",
    "locking",
    "motion",
    "damping",
    "noise",
    "opening",
    "initial",
    "heaps",
    "friction",
    "slopes",
    "beds",
    "layers",
    "softening",
    "collapses",
)

SCENARIOS: dict[str, Scenario] = {
    scenario.name: scenario for module in MODULES for scenario in import_module(f"{__name__}.{module}").SCENARIOS
}


def select_scenarios(names: Sequence[str]) -> list[Scenario]:
    """The scenarios or groups of these names ("wall" selects "wall-corner"); all scenarios if no names are given.

    Raises UsageError for an unknown name.
    """
    return select(list(SCENARIOS.values()), names, "scenario")
