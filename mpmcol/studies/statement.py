"""Statement of accuracy: runout and height of a run with intervals, and what these hold.

Two intervals are separated: what finer grids would give, and what an experiment would give. Their half-widths are roots
of the sums of squares of their parts. An interval that lacks a part is not given.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import hypot, inf
from typing import Any

from mpmcol.io.results import Results
from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.judgement import NAMES, STILL_MOVING, experiment_or_reason, measured_value
from mpmcol.studies.model_error import IN_STUDY, ModelError, model_errors
from mpmcol.studies.pareto.certify import ErrorBar
from mpmcol.studies.pareto.recommend import Recommendation

CONFIDENCE = 0.9


@dataclass(frozen=True)
class StatedQuantity:
    """A quantity with the parts of its intervals, relative to the value."""

    value: float
    unit_length: float  # m, that of a value of one
    grid: float
    scatter: float
    model: Sequence[ModelError]
    reason: str  # why there is no interval for experiments; "" if there is one

    @property
    def model_part(self) -> float | None:
        """The largest part of all experiments; None without one."""
        return None if self.reason else max(one.part for one in self.model if one.part is not None)

    def as_dict(self) -> dict[str, Any]:
        """The record for JSON."""
        model = self.model_part
        return {
            "value": self.value,
            "length": self.value * self.unit_length,
            "grid": self.grid,
            "scatter": self.scatter,
            "model": model,
            "finer_grids": self._interval(self.grid, self.scatter),
            "experiment": None if model is None else self._interval(self.grid, self.scatter, model),
            "experiments": [asdict(one) for one in self.model],
            "reason": self.reason,
        }

    def _interval(self, *parts: float) -> dict[str, float]:
        width = hypot(*parts) * abs(self.value)
        low, high = max(self.value - width, 0.0), self.value + width
        return {
            "low": low, "high": high, "low_length": low * self.unit_length, "high_length": high * self.unit_length,
        }  # fmt: skip


def make_statement(
    results: Results, advice: Recommendation, accuracy: float, bars: Sequence[ErrorBar] = ()
) -> dict[str, Any]:
    """Return the statement of a finished run as a record for JSON; `mpmcol explain accuracy` explains its keys.

    Args:
        results: of the run of the recommended configuration.
        advice: the recommendation that the run was made by.
        accuracy: the accuracy that was requested.
        bars: of runs at several spacings; they replace the error bound of the study, and their values those of the run.
    """
    certified = {bar.quantity: bar for bar in bars}
    quantities = {name: _quantity(name, results, advice, certified.get(IN_STUDY[name])).as_dict() for name in NAMES}
    return {
        "requested": accuracy,
        "confidence": CONFIDENCE,
        "source": "several spacings" if bars else "study",
        "variant": advice.variant,
        "cells": max(bars[0].runs) if bars else advice.cells,
        "cases": list(advice.cases),
        "outside_study": [str(one) for one in advice.differences],
        **quantities,
    }


def _quantity(name: str, results: Results, advice: Recommendation, bar: ErrorBar | None) -> StatedQuantity:
    case, in_study = results.case, IN_STUDY[name]
    geometry = case.geometry
    if bar:
        value, grid, scatter = bar.value, bar.relative, 0.0  # the misfit of the bar contains the scatter
    else:
        _, value = measured_value(results.summary, name, geometry.r_i)
        grid, scatter = of_value(advice.errors[in_study]), NORMAL_90 * advice.scatter[in_study]
    model = model_errors(name, case, advice.cases) if results.summary["at_rest"] else []
    reason = _reason(name, results, model)
    return StatedQuantity(value, geometry.r_i if name == "zeta" else geometry.h_i, grid, scatter, model, reason)


def of_value(error: float) -> float:
    """Error relative to the computed value, from one relative to the converged value c: |v - c| <= e c, c > 0."""
    return error / (1.0 - error) if error < 1.0 else inf


def _reason(name: str, results: Results, model: Sequence[ModelError]) -> str:
    """Why there is no interval for experiments; "" if there is one."""
    if not results.summary["at_rest"]:
        return STILL_MOVING
    experiment, reason = experiment_or_reason(results.case)
    if experiment is None:
        return reason
    if not model:
        law = experiment.law(name)
        return f"{experiment.citation}: {law.gap(results.case.geometry.a) if law else f'no law for {name}'}"
    if all(one.difference is None for one in model):
        known = ", ".join(one.experiment for one in model)
        return f"the study has no column to compare with {known}: the error of the model is not known"
    return ""
