"""Statement of accuracy: runout and height of a run with intervals, and what these hold.

Two intervals are separated: what finer grids would give, by the error of such runs in the study, and what an experiment
would give. The second has the middle of the first, and its half-width is the root of the sum of the squares of that of
the first and of the error of the model. An interval that lacks a part is not given.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import hypot
from typing import Any

from mpmcol.io.results import Results
from mpmcol.studies.judgement import NAMES, STILL_MOVING, experiment_or_reason, measured_value
from mpmcol.studies.model_error import IN_STUDY, ModelError, model_errors
from mpmcol.studies.pareto.certify import ErrorBar
from mpmcol.studies.pareto.error_interval import CONFIDENCE, ErrorInterval
from mpmcol.studies.pareto.recommend import Recommendation


@dataclass(frozen=True)
class StatedQuantity:
    """A quantity with the parts of its intervals.

    value: of the run or, with error bars, extrapolated. converged: middle of what finer grids would give. grid: half
    the width of that interval, relative to its middle. error: of the run, from the study; None with error bars.
    """

    value: float
    unit_length: float  # m, that of a value of one
    converged: float
    grid: float
    error: ErrorInterval | None
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
            "error": self.error and asdict(self.error),
            "grid": self.grid,
            "model": model,
            "finer_grids": self._interval(self.grid),
            "experiment": None if model is None else self._interval(hypot(self.grid, model)),
            "experiments": [asdict(one) for one in self.model],
            "reason": self.reason,
        }

    def _interval(self, relative: float) -> dict[str, float]:
        width = relative * abs(self.converged)
        low, high = max(self.converged - width, 0.0), self.converged + width
        return {
            "low": low, "high": high, "low_length": low * self.unit_length, "high_length": high * self.unit_length,
        }  # fmt: skip


def make_statement(
    results: Results, advice: Recommendation, accuracy: float, bars: Sequence[ErrorBar] = (), corrected: bool = False
) -> dict[str, Any]:
    """Return the statement of a finished run as a record for JSON; `mpmcol explain accuracy` explains its keys.

    Args:
        results: of the run of the recommended configuration.
        advice: the recommendation that the run was made by.
        accuracy: the accuracy that was requested.
        corrected: whether it was that of values corrected for the error of the grid.
        bars: of runs at several spacings; they replace the errors of the study, and their values those of the run.
    """
    certified = {bar.quantity: bar for bar in bars}
    quantities = {name: _quantity(name, results, advice, certified.get(IN_STUDY[name])).as_dict() for name in NAMES}
    return {
        "requested": accuracy,
        "corrected": corrected,
        "confidence": CONFIDENCE,
        "source": "several spacings" if bars else "study",
        "variant": advice.variant,
        "cells": max(bars[0].runs) if bars else advice.cells,
        "cases": list(advice.cases),
        "outside_study": [str(one) for one in advice.differences],
        **quantities,
    }


def _quantity(name: str, results: Results, advice: Recommendation, bar: ErrorBar | None) -> StatedQuantity:
    geometry = results.case.geometry
    unit_length = geometry.r_i if name == "zeta" else geometry.h_i
    model = model_errors(name, results.case, advice.cases) if results.summary["at_rest"] else []
    reason = _reason(name, results, model)
    if bar:
        return StatedQuantity(bar.value, unit_length, bar.value, bar.relative, None, model, reason)
    _, value = measured_value(results.summary, name, geometry.r_i)
    error = advice.intervals[IN_STUDY[name]]
    return StatedQuantity(value, unit_length, error.factor * value, error.relative, error, model, reason)


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
