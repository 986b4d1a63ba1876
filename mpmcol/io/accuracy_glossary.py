"""What `mpmcol run --accuracy` adds to the result: error bars (--certify), and the statement of accuracy."""

from __future__ import annotations

from mpmcol.io.glossary import Names

ERROR_BARS: Names = {
    "error_bars.QUANTITY": ("", "a quantity extrapolated to zero spacing (--certify); error_bars.json has the same"),
    "error_bars.QUANTITY.quantity": ("", "name of the quantity"),
    "error_bars.QUANTITY.runs": ("", "results of the runs by r_i/h, coarsest first"),
    "error_bars.QUANTITY.runs.CELLS": ("", "result of the run at this r_i/h"),
    "error_bars.QUANTITY.value": ("", "value extrapolated to zero spacing"),
    "error_bars.QUANTITY.from_order": ("", "half the difference of extrapolations with the lowest and highest order"),
    "error_bars.QUANTITY.from_misfit": ("", "two standard errors of the extrapolation"),
    "error_bars.QUANTITY.from_spacing": ("", "1.5 node spacings of the finest grid, the least error"),
    "error_bars.QUANTITY.error": (
        "",
        "half-width: order and misfit together, at least from_spacing and 1 % of the value",
    ),
    "error_bars.QUANTITY.cause": ("", "what determines the width of the bar"),
    "error_bars.QUANTITY.law": ("", "value that the experiment of the case leads to expect; null without one"),
    "error_bars.QUANTITY.law.experiment": ("", "who made the experiment"),
    "error_bars.QUANTITY.law.expected": ("", "value by the law of the experiment"),
    "error_bars.QUANTITY.law.scatter": ("", "relative scatter of the experiment"),
}
_INTERVAL: Names = {
    "low": ("", "lower end of the interval"),
    "high": ("", "upper end of the interval"),
    "low_length": ("m", "lower end of the interval as a length"),
    "high_length": ("m", "upper end of the interval as a length"),
}
_QUANTITY: Names = {
    "value": ("", "value of the run, or extrapolated with --certify"),
    "length": ("m", "that value as a length: the runout r_f - r_i, or the height h_f"),
    "error": ("", "relative error of the value on this grid, from the study; null with --certify"),
    "error.low": ("", "lower end of its interval"),
    "error.high": ("", "upper end of its interval"),
    "grid": ("", "half the width of the interval for finer grids, relative to its middle"),
    "model": ("", "part of the interval for experiments: largest relative difference with scatter; null without one"),
    "finer_grids": ("", "interval of what finer grids would give, from the error of this one"),
    **{f"finer_grids.{name}": entry for name, entry in _INTERVAL.items()},
    "experiment": ("", "interval of what an experiment would give, from grid and model; null where one is not known"),
    **{f"experiment.{name}": entry for name, entry in _INTERVAL.items()},
    "experiments": ("", "experiments that the case can be compared with, and the differences of the model from them"),
    "experiments.experiment": ("", "who made the experiment"),
    "experiments.expected": ("", "value by its law for the case"),
    "experiments.scatter": ("", "relative scatter of the experiment, taken as a standard deviation"),
    "experiments.difference": (
        "",
        "grid-converged value over that of the law, minus one, in the study; null if unknown",
    ),
    "reason": ("", "why there is no interval for experiments; empty if there is one"),
}
ACCURACY: Names = {
    "accuracy": ("", "statement of accuracy (--accuracy); accuracy.json has the same"),
    "accuracy.requested": ("", "accuracy that was requested"),
    "accuracy.corrected": ("", "whether it was that of values corrected for the error of the grid (--corrected)"),
    "accuracy.confidence": ("", "confidence of the intervals"),
    "accuracy.source": ("", "source of the error of the grid: study, or runs at several spacings (--certify)"),
    "accuracy.variant": ("", "variant of the method in the study"),
    "accuracy.cells": ("", "r_i / h of the run"),
    "accuracy.cases": ("", "cases of the study between which the case lies"),
    "accuracy.outside_study": ("", "how the case differs from the study; the intervals may be too narrow then"),
    "accuracy.QUANTITY": ("", "zeta (by front_height) or beta with its intervals"),
    **{f"accuracy.QUANTITY.{name}": entry for name, entry in _QUANTITY.items()},
}
