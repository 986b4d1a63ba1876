"""What the results of `mpmcol sweep --uncertain` hold; the names are as in `glossary.py`."""

from __future__ import annotations

UNCERTAINTY = "uncertainty.csv"
QUANTITY_NAMES = {  # columns of uncertainty.csv; values in the unit of the quantity
    "quantity": ("", "name of the quantity in result.json; in 3D the mean around the axis"),
    "unit": ("", "unit of the quantity"),
    "count": ("", "number of runs with a value"),
    "mean": ("", "mean"),
    "standard_deviation": ("", "standard deviation, with count - 1"),
    "p5": ("", "quantile 5 %"),
    "p25": ("", "quantile 25 %"),
    "median": ("", "median"),
    "p75": ("", "quantile 75 %"),
    "p95": ("", "quantile 95 %"),
    "median_lo": (
        "",
        "lower end of the 90 % interval of the median, an order statistic; null below 5 values",
    ),
    "median_hi": ("", "upper end of that interval"),
    "surface": ("", "response surface that splits the variance: quadratic or linear; null if the runs are too few"),
    "r2": ("", "share of the variance of the sample that the surface explains"),
    "adjusted_r2": ("", "that share, corrected for the number of coefficients"),
    "cross_validated_r2": ("", "that share for runs that are left out of the fit, one at a time"),
    "first_order.INPUT": (
        "",
        "share of an input alone in the variance (first-order Sobol index); null if cross_validated_r2 is negative",
    ),
    "total.INPUT": ("", "share of an input with its interactions (total Sobol index); null as first_order"),
    "residual": (
        "",
        "1 - adjusted_r2: share of the scatter of runs, of realizations of random fields, and of terms that the "
        "surface omits; null as first_order",
    ),
    "scatter": (
        "",
        "share of the scatter about a smooth function of the input, by neighbouring values; null for several inputs "
        "and with realizations",
    ),
    "note": ("", "why shares are not given or not reliable; null if cross_validated_r2 is at least 0.5"),
    "grid_standard_deviation": ("", "standard deviation of the error of the grid by the study; null if not studied"),
    "grid_share": ("", "variance of that error over its sum with the variance of the sample"),
}
RECORD_NAMES = {  # uncertainty.json
    "schema": ("", "version of the format"),
    "title": ("", "title of the case"),
    "version": ("", "version of mpmcol that made the analysis"),
    "seed": ("", "seed of the Latin hypercube"),
    "samples": ("", "number of runs of the sample"),
    "done": ("", "number of runs that are done; the others are in no statistics"),
    "not_at_rest": ("", "number of these whose column still moved at the end"),
    "inputs": ("", "one entry for each uncertain key"),
    "inputs.key": ("", "key of the case"),
    "inputs.unit": ("", "unit of the key"),
    "inputs.distribution": ("", "distribution of its values, as --uncertain takes it"),
    "inputs.mean": ("", "mean of the distribution"),
    "inputs.standard_deviation": ("", "standard deviation of the distribution"),
    "realizations": ("", "keys of the seeds of random fields, of which each run has one of its own"),
    "configuration": ("", "configuration of all runs that --accuracy chose; null without it"),
    "configuration.variant": ("", "variant of the method in the study"),
    "configuration.cells": ("", "r_i / h at the means of the inputs"),
    "configuration.accuracy": ("", "relative error of runout and height that was asked for"),
    "configuration.corrected": ("", "whether runout, front and height are corrected for the error of the grid"),
    "quantities": ("", "rows of uncertainty.csv"),
    **{f"quantities.{name}": entry for name, entry in QUANTITY_NAMES.items()},
    "passes": ("", "one entry for each distance of --passes"),
    "passes.distance": ("m", "distance from the wall or axis"),
    "passes.count": ("", "number of runs"),
    "passes.met": ("", "number of runs in which front_height passes the distance"),
    "passes.value": ("", "probability that it does: met over count"),
    "passes.lo": ("", "lower end of its 95 % interval (Wilson)"),
    "passes.hi": ("", "upper end of that interval"),
    "runs": ("", "folders of the runs in that of the sweep"),
}
