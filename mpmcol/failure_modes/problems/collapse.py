"""Collapse of a shipped case on a coarse grid, run in a temporary folder."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

from mpmcol.case import load_case
from mpmcol.simulation.run import run

FEW_FILES = ("output.snapshots=1",)


class CollapseResult(NamedTuple):
    """Fronts, largest volume ratio, energies, stresses and history of a complete run."""

    front_max: float  # m
    front_height: float  # m
    zeta: float  # by front_height
    largest_J: float
    dissipation: dict[str, float]  # as in result.json
    stress: dict[str, float]
    history: dict[str, np.ndarray]


@cache
def collapsed(case: str, *overrides: str) -> CollapseResult:
    """A complete run of a case with overrides; raises NumericalFailure if it diverges."""
    with TemporaryDirectory() as folder:
        results = run(load_case(case, [*overrides, *FEW_FILES]), Path(folder) / "run", threads=1)
        measured = results.measure()
        return CollapseResult(
            measured.front["front_max"],
            measured.front["front_height"],
            measured.zeta["front_height"],
            results.summary["worst_J"][1],
            results.summary["dissipation"],
            results.summary["stress"],
            results.history,
        )
