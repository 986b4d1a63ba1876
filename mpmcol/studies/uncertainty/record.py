"""The analysis as a record for JSON, as rows of a table, and as text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from mpmcol.provenance import code_version
from mpmcol.studies.uncertainty.analysis import Analysis, Quantity
from mpmcol.studies.uncertainty.statistics import QUANTILES
from mpmcol.studies.uncertainty.variance_shares import VarianceShares
from mpmcol.sweep.names import short_names

RECORD_SCHEMA = 1
HEADINGS = ("mean", "sd", "5 %", "25 %", "median", "75 %", "95 %", "90 % interval of median")


def as_record(analysis: Analysis) -> dict[str, Any]:
    """The content of uncertainty.json."""
    plan = analysis.plan
    advice = plan.recommendation
    return {
        "schema": RECORD_SCHEMA,
        "title": plan.means.title,
        "version": code_version(),
        "seed": plan.seed,
        "samples": len(plan.runs),
        "done": analysis.done,
        "not_at_rest": analysis.not_at_rest,
        "inputs": [
            {
                "key": one.key,
                "unit": one.number.unit,
                "distribution": str(one.distribution),
                "mean": one.distribution.mean,
                "standard_deviation": one.distribution.standard_deviation,
            }
            for one in plan.inputs
        ],
        "realizations": list(plan.seeds),
        "configuration": advice
        and {
            "variant": advice.variant,
            "cells": advice.cells,
            "accuracy": plan.accuracy,
            "corrected": plan.corrected,
        },
        "quantities": [quantity_row(one) for one in analysis.quantities],
        "passes": [{"distance": one.distance, **asdict(one.probability)} for one in analysis.passes],
        "runs": [run.folder.name for run in plan.runs],
    }


def quantity_row(one: Quantity) -> dict[str, Any]:
    """A quantity as in uncertainty.json; flattened, a row of uncertainty.csv. None where there is no value."""
    low, high = one.statistics.median_interval or (None, None)
    statistics = asdict(one.statistics)
    shares = _shares_row(one.shares) if one.shares else {}
    return {
        "quantity": one.name,
        "unit": one.unit,
        **{name: statistics[name] for name in ("count", "mean", "standard_deviation")},
        **one.statistics.quantiles,
        "median_lo": low,
        "median_hi": high,
        **shares,
        "grid_standard_deviation": one.grid_deviation,
        "grid_share": one.grid_share,
    }


def _shares_row(shares: VarianceShares) -> dict[str, Any]:
    """Fit of the surface and shares; these are None where they are not given."""
    row = asdict(shares)
    if not shares.is_given:
        row |= {name: dict.fromkeys(row[name]) for name in ("first_order", "total")} | {
            "residual": None,
            "scatter": None,
        }
    return {**row, "note": shares.note or None}


def summary_lines(analysis: Analysis) -> Iterator[str]:
    """Counts, a table of the quantities, probabilities, and shares of the variance."""
    total = len(analysis.plan.runs)
    moving = f"; {analysis.not_at_rest} still moved at the end" if analysis.not_at_rest else ""
    yield "; ".join(
        [
            f"{analysis.done} of {total} runs of a Latin hypercube (seed {analysis.plan.seed}) are done{moving}",
            *analysis.plan.remarks,
        ]
    )
    if analysis.done < total:
        yield "  the others are in no statistics, which they may bias"
    width = max((len(label(one)) for one in analysis.quantities), default=0)
    if analysis.quantities:
        yield " " * width + "".join(f"{heading:>10}" for heading in HEADINGS[:-1]) + f"  {HEADINGS[-1]}"
    for one in analysis.quantities:
        yield f"{label(one):{width}}{_numbers(one)}"
    for passing in analysis.passes:
        found = passing.probability
        yield (
            f"front_height passes {passing.distance:g} m from the wall or axis in {found.met} of {found.count} runs: "
            f"probability {found.value:.3g} ({found.lo:.3g} to {found.hi:.3g} with 95 %)"
        )
    yield from _share_lines(analysis, width)


def _share_text(shares: VarianceShares, key: str) -> str:
    """Share of an input alone and, in brackets, with interactions, per cent."""
    if not shares.is_given:
        return "-"
    return f"{100.0 * shares.first_order[key]:.0f} ({100.0 * shares.total[key]:.0f})"


def _residual_text(shares: VarianceShares) -> str:
    """Share of the residual and, in brackets, of the scatter in it, per cent."""
    if not shares.is_given:
        return "-"
    scatter = "" if shares.scatter is None else f" ({100.0 * shares.scatter:.0f})"
    return f"{100.0 * shares.residual:.0f}{scatter}"


def label(one: Quantity) -> str:
    """Name of a quantity with its unit."""
    return one.name if one.unit in ("", "deg") else f"{one.name} [{one.unit}]"


def _numbers(one: Quantity) -> str:
    statistics = one.statistics
    values = [statistics.mean, statistics.standard_deviation, *(statistics.quantiles[name] for name in QUANTILES)]
    interval = statistics.median_interval
    text = f"{interval[0]:.4g} to {interval[1]:.4g}" if interval else "none"
    return "".join(f"{value:10.4g}" for value in values) + f"  {text}"


def _share_lines(analysis: Analysis, width: int) -> Iterator[str]:
    """A table of the shares of the variance, with the fit of the surface and the error of the grid."""
    names = short_names(one.key for one in analysis.plan.inputs)
    split = [(one, one.shares) for one in analysis.quantities if one.shares]
    if not names:
        yield "the variance is that of the realizations and of the scatter of the runs"
        return
    if not split:
        yield "the variance is not split: the runs are too few, or all equal"
        return
    columns = [f"{name:>{max(len(name), 12)}}" for name in names.values()]
    fit = "residual (scatter)    surface  R2: adjusted  cross-validated"
    yield f"{'variance, %':{width}}  {'  '.join(columns)}  {fit}  grid"
    for one, shares in split:
        inputs = [_share_text(shares, key) for key in names]
        cells = [f"{text:>{len(column)}}" for text, column in zip(inputs, columns, strict=True)]
        grid = (
            "not studied" if one.grid_share is None else f"{100.0 * one.grid_share:.0f} (sd {one.grid_deviation:.2g})"
        )
        yield (
            f"{label(one):{width}}  {'  '.join(cells)}  {_residual_text(shares):>18}  {shares.surface:>9}"
            f"  {shares.adjusted_r2:12.2f}  {shares.cross_validated_r2:15.2f}  {grid}"
        )
    yield from (f"  {label(one)}: {shares.note}" for one, shares in split if shares.note)
    yield f"  of each input alone (with interactions); residual: {analysis.plan.residual};"
    if not analysis.plan.seeds:
        yield "  the scatter is known for a single input only;"
    yield "  grid: variance of its error by the study, over its sum with the variance of the sample"
