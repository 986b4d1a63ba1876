"""Errors of a series of runs against the laws, at a spacing and in the limit of small ones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcol.measure import FRONTS
from mpmcol.studies.paper.report import Verdict
from mpmcol.studies.runs import Finished

FARTHEST = 3.05  # times the finest spacing
QUANTITIES = (*(f"zeta.{front}" for front in FRONTS), "beta")


@dataclass(frozen=True)
class Limit:
    """What a quantity tends to for small spacings, with the standard error of the fit."""

    value: float
    error: float


def extrapolate(h: Sequence[float], values: Sequence[float]) -> Limit | None:
    """Least-squares line y = y_0 + c h, first order as the base's gap and the front's thickness are; its y_0.

    Taken are the spacings up to FARTHEST times the finest: coarser ones are not on the line. The standard error is that
    of the scatter about the line. None for fewer than three spacings.
    """
    spacing, value = np.asarray(h, dtype=float), np.asarray(values, dtype=float)
    near = spacing <= FARTHEST * spacing.min(initial=np.inf)
    spacing, value = spacing[near], value[near]
    if len(set(spacing.tolist())) < 3:
        return None
    matrix = np.stack((np.ones(len(spacing)), spacing), axis=1)
    inverse = np.linalg.inv(matrix.T @ matrix)
    fit = inverse @ matrix.T @ value
    residual = value - matrix @ fit
    variance = float(residual @ residual) / (len(spacing) - 2)
    return Limit(float(fit[0]), float(np.sqrt(variance * inverse[0, 0])))


def law_of(row: Mapping[str, Any], quantity: str) -> float | None:
    """Value of the paper's law for a row; None outside its range."""
    value: float | None = row[f"law.{quantity.partition('.')[0]}"]
    return value


def compare(runs: Iterable[Finished], finest: Finished) -> dict[str, Any]:
    """One line of a table: the run at the finest spacing, its errors, and the limit over all spacings of `runs`."""
    runs, row = list(runs), finest.row
    line: dict[str, Any] = {"a": row["a"], "h_mm": 1e3 * row["spacing_used"], "points": row["column_points"]}
    for quantity in QUANTITIES:
        law, value = law_of(row, quantity), row[quantity]
        limit = extrapolate([run.row["spacing_used"] for run in runs], [run.row[quantity] for run in runs])
        line[quantity] = value
        line[f"{quantity} error"] = None if law is None else value / law - 1.0
        line[f"{quantity} limit"] = limit and limit.value
        line[f"{quantity} limit +-"] = limit and limit.error
        line[f"{quantity} limit error"] = None if law is None or limit is None else limit.value / law - 1.0
    line["law.zeta"], line["law.beta"] = row["law.zeta"], row["law.beta"]
    line["spread"], line["steps"], line["seconds"] = row["spread"], row["steps"], row["seconds"]
    return line


def summaries(
    lines: Sequence[Mapping[str, Any]], quantity: str, label: str, mean: float | None, largest: float | None = None
) -> list[Verdict]:
    """Mean |error| over a series, and the largest where the paper states one, at its spacing and in the limit."""
    found = []
    spacing = f"h = {max(line['h_mm'] for line in lines):.3g} mm" if lines else ""
    for column, where in ((f"{quantity} error", spacing), (f"{quantity} limit error", "extrapolated in h")):
        errors = {line["a"]: abs(line[column]) for line in lines if line[column] is not None}
        if not errors:
            continue
        average, worst = float(np.mean(list(errors.values()))), max(errors, key=lambda a: errors[a])
        told = f"{label}, {quantity}, {where}"
        found.append(Verdict(f"{told}, mean |error|", average, mean, mean, comment=f"{len(errors)} columns"))
        if largest is not None:
            found.append(Verdict(f"{told}, largest |error|", errors[worst], largest, largest, comment=f"a = {worst:g}"))
    return found
