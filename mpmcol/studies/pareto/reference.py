"""Grid-converged reference of a case, from scheme variants that are refined independently."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mpmcol.measure import FRONTS, Array
from mpmcol.measure.profile_distance import area_between, mean_height, stations
from mpmcol.studies.convergence import ConvergedValue, combine, converged_value
from mpmcol.studies.runs import CompletedRun

QUANTITIES = (*(f"zeta.{front}" for front in FRONTS), "beta")
PROFILE = "profile"

Levels = Mapping[float, Sequence[CompletedRun]]  # runs of a variant by r_i / h


@dataclass(frozen=True)
class ConvergedReference:
    """Grid-converged values of a case, and the mean profile of the two finest variants."""

    values: Mapping[str, ConvergedValue]  # by quantity
    refinements: Sequence[Mapping[str, ConvergedValue]]  # values of each variant alone
    x: Array  # m
    height: Array  # m, at x
    height_error: float  # half the area between these two profiles, relative to the area of the mean

    def uncertainty(self, quantity: str) -> float:
        """Return the relative standard error of a quantity, or of the profile."""
        if quantity == PROFILE:
            return self.height_error
        converged = self.values[quantity]
        return converged.error / abs(converged.value)


def make_reference(variants: Sequence[Levels]) -> ConvergedReference | None:
    """Make the reference from two refinements or more; None if one of them has too few runs."""
    refinements = [extrapolate(levels) for levels in variants]
    if any(len(values) < len(QUANTITIES) for values in refinements):
        return None
    by_finest = sorted(variants, key=lambda levels: max(levels), reverse=True)
    finest = [[run.results.measure(-1) for run in levels[max(levels)]] for levels in by_finest[:2]]
    x = stations([deposit for deposits in finest for deposit in deposits])
    one, other = (mean_height(deposits, x) for deposits in finest)
    height = (one + other) / 2.0
    return ConvergedReference(
        values={quantity: combine([values[quantity] for values in refinements]) for quantity in QUANTITIES},
        refinements=refinements,
        x=x,
        height=height,
        height_error=area_between(one, height),
    )


def extrapolate(levels: Levels) -> dict[str, ConvergedValue]:
    """Extrapolate the quantities of one variant to zero spacing; without those for which there are too few runs."""
    rows = [run.row for runs in levels.values() for run in runs]
    spacings = [row["spacing_used"] for row in rows]
    found = {quantity: converged_value(spacings, [row[quantity] for row in rows]) for quantity in QUANTITIES}
    return {quantity: value for quantity, value in found.items() if value}
