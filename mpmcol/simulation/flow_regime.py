"""Inertial number I and friction mu(I) of the flow of each material with that law, over the whole collapse.

At each record of the history the mass of the flowing points is added to a histogram of log I. The percentiles are
those of mass times time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from mpmcol.case import Case
from mpmcol.mpm.constitutive import mu_i
from mpmcol.mpm.particles import COLUMN, Points
from mpmcol.simulation.derived import derived_quantities

QUASI_STATIC = 1e-3  # I below which a flow is quasi-static (GDR MiDi 2004, doi:10.1140/epje/i2003-10153-0)
LARGEST = 1e3
PER_DECADE = 50
EDGES = np.geomspace(QUASI_STATIC, LARGEST, 6 * PER_DECADE + 1)
CENTRES = np.sqrt(EDGES[:-1] * EDGES[1:])
PERCENTILES = (0.05, 0.5, 0.95)
MOST_ILL_POSED = 0.1  # share of the flow


@dataclass(frozen=True)
class FlowRegime:
    """Percentiles 5, 50 and 95 of I and mu of the flow, in mass times time, and the share where it is ill-posed."""

    I_p5: float
    I_median: float
    I_p95: float
    mu_p5: float
    mu_median: float
    mu_p95: float
    ill_posed: float


class FlowHistogram:
    """Mass times number of records by I of each material with the mu(I) law, by kind of the points."""

    def __init__(self, case: Case) -> None:
        materials: tuple[Any, ...] = case.materials
        self.case = case
        self.materials = {kind: one for kind, one in enumerate(materials) if isinstance(one, mu_i.Material)}
        self.mass = np.zeros((len(self.materials), len(CENTRES)))

    def add(self, points: Points) -> None:
        """Add the present state of the points."""
        if not self.materials:
            return
        number = np.minimum(derived_quantities(self.case, points)["inertial_number"], CENTRES[-1])
        for mass, kind in zip(self.mass, self.materials, strict=True):
            own = points.kind == kind
            mass += np.histogram(number[own], EDGES, weights=points.m[own])[0]

    def memory(self) -> list[float]:
        """The sums, for a checkpoint."""
        return [float(mass) for mass in self.mass.flat]

    def set_memory(self, memory: Sequence[float]) -> None:
        """Continue from `memory`."""
        self.mass[:] = np.reshape(memory, self.mass.shape)

    @property
    def regimes(self) -> dict[int, FlowRegime]:
        """What the flow has reached so far, by kind of the points; without materials that have not flowed."""
        pairs = zip(self.materials.items(), self.mass, strict=True)
        return {kind: _regime(mass, material) for (kind, material), mass in pairs if mass.any()}

    def as_dict(self) -> dict[str, Any] | None:
        """The regime of the column's own material, for result.json."""
        return asdict(own) if (own := self.regimes.get(COLUMN)) else None

    def of_others(self) -> dict[str, Any] | None:
        """The regimes of base and layers by their names, for result.json; None without any."""
        names = self.case.material_names
        return {names[kind]: asdict(one) for kind, one in self.regimes.items() if kind != COLUMN} or None

    def notes(self) -> Iterator[str]:
        """What a user must know of the rates of the flow."""
        for kind, regime in self.regimes.items():
            if regime.ill_posed > MOST_ILL_POSED:
                yield _ill_posed_note(self.case.material_names[kind], regime, self.materials[kind])


def _regime(mass: np.ndarray, material: mu_i.Material) -> FlowRegime:
    numbers = CENTRES[np.searchsorted(np.cumsum(mass), np.array(PERCENTILES) * mass.sum())]
    ill_posed = mass[~mu_i.well_posed(CENTRES, material)].sum() / mass.sum()
    return FlowRegime(*map(float, (*numbers, *mu_i.friction_of(numbers, material), ill_posed)))


def _ill_posed_note(name: str, regime: FlowRegime, material: mu_i.Material) -> str:
    allowed = CENTRES[mu_i.well_posed(CENTRES, material)]
    limits = f"{allowed.min():.2g} to {allowed.max():.2g}" if len(allowed) else "no I"
    return (
        f"the mu(I) law is well-posed for I of {limits} (Barker et al. 2015); {100.0 * regime.ill_posed:.0f} % of "
        f"the flow of the {name} is outside: details of the flow depend on grid.spacing, so compare two spacings"
    )
