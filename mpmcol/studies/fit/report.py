"""Files and text of a fit: values with standard errors, their parts, evaluations, the fitted case."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from mpmcol.case import load_case, resolved_toml
from mpmcol.io.atomic import atomic_write
from mpmcol.io.names import ENVIRONMENT_FILE
from mpmcol.io.values import to_json
from mpmcol.provenance import environment
from mpmcol.studies.fit import RUNS, Fit
from mpmcol.studies.fit.agreement import Comparison, signed
from mpmcol.studies.fit.identify import remarks
from mpmcol.studies.fit.levels import Level
from mpmcol.studies.fit.quantities import ASSUMED_ERROR, FRONT, MEANINGS, unit_of
from mpmcol.studies.fit.unknowns import settings
from mpmcol.studies.fit.values import fitted_values
from mpmcol.studies.markdown import document, images, table

FIT_FILE, EVALUATIONS_FILE, CASE_FILE = "fit.json", "evaluations.csv", "fitted.toml"
TEXT_FILE = "fit.md"
CHART_FILE, PROFILE_CHART_FILE = "fit.png", "profile.png"
FIT_SCHEMA = 1
MEASURED_COLUMNS = (
    "measurement", "measured", "its standard error", "computed", "standard error of the difference, by all causes",
    "difference, standard errors",
)  # fmt: skip


def lines(fit: Fit) -> Iterator[str]:
    """The answer in words: first what is not reproduced, then values, measurements and remarks."""
    agreement, solution, grid = fit.agreement, fit.solution, fit.solution.last.level
    statement = agreement.statement
    if statement:
        yield statement
    yield from map(str, fitted_values(fit))
    yield from map(str, agreement.comparisons)
    unstated = ", ".join(target.name for target in fit.targets if not target.is_stated)
    if unstated:
        yield f"{unstated}: standard error of the measurement not stated, {ASSUMED_ERROR:.0%} assumed"
    if grid.errors is None:
        yield "grid not known: its error is not studied for these settings (--accuracy chooses studied ones)"
    if not statement and agreement.scale > 1.0:
        yield f"standard errors enlarged by {agreement.scale:.3g}, the root of chi squared per degree of freedom"
    yield from (remark for remark in remarks(fit.unknowns, fit.targets, solution) if remark != statement)
    seconds = sum(one.core_seconds for one in solution.evaluations)
    runs = sum(len(one.folders) for one in solution.evaluations)
    yield f"{runs} runs, {seconds:.3g} core-seconds; grid of the answer: r_i/h = {grid.cells:g}{_corrected(fit, grid)}"


def _corrected(fit: Fit, grid: Level) -> str:
    if grid.errors is None or not any(target.is_corrected for target in fit.targets):
        return ""
    runout, height = (f"{factor - 1.0:+.1%}" for factor in grid.factors)
    return f"; computed values are corrected for its error: zeta {runout}, beta {height}"


def record(fit: Fit) -> dict[str, Any]:
    """Content of fit.json."""
    solution, grid, agreement = fit.solution, fit.solution.last.level, fit.agreement
    found = solution.precision
    return {
        "schema": FIT_SCHEMA,
        "folder": str(fit.folder),
        "reproduced": agreement.is_reproduced,
        "converged": solution.is_converged,
        "unknowns": [
            {"key": one.key, "value": one.value, "standard_error": one.error, "parts": one.parts,
             "interval": one.interval and list(one.interval), "end": one.end, "unit": one.unit, "low": one.low,
             "high": one.high}
            for one in fitted_values(fit)
        ],
        "correlation": None if found is None else found.correlation.tolist(),
        "targets": [_target(one) for one in agreement.comparisons],
        "front": FRONT,
        "chi_squared": agreement.chi_squared,
        "degrees_of_freedom": agreement.freedom,
        "scale": agreement.scale,
        "grid": {
            "cells": grid.cells, "overrides": list(grid.overrides), "errors": grid.errors and grid.errors._asdict(),
            "factors": grid.factors._asdict(),
        },
        "remarks": list(remarks(fit.unknowns, fit.targets, solution)),
        "runs": sum(len(one.folders) for one in solution.evaluations),
        "core_seconds": sum(one.core_seconds for one in solution.evaluations),
    }  # fmt: skip


def _target(one: Comparison) -> dict[str, Any]:
    target = one.target
    return {
        "name": target.name, "unit": target.unit, "x": target.x.tolist(), "measured": target.values.tolist(),
        "standard_error": target.errors.tolist(), "fitted": one.computed.tolist(),
        "error_of_difference": one.errors.tolist(), "difference": one.differences.tolist(),
        "reproduced": one.is_reproduced,
    }  # fmt: skip


def write_report(fit: Fit) -> list[Path]:
    """Write record, table, fitted case and charts; returns the files."""
    from mpmcol.studies.fit.chart import profile_chart, response_chart

    charts = [*response_chart(fit, fit.folder / CHART_FILE), *profile_chart(fit, fit.folder / PROFILE_CHART_FILE)]
    texts = {
        FIT_FILE: to_json(record(fit)), EVALUATIONS_FILE: _table(fit), CASE_FILE: fitted_case(fit),
        TEXT_FILE: _text(fit, charts), ENVIRONMENT_FILE: to_json(environment(), indent=1),
    }  # fmt: skip
    for name, text in texts.items():
        atomic_write(fit.folder / name, text.encode() + (b"" if text.endswith("\n") else b"\n"))
    return [*(fit.folder / name for name in texts), *charts]


def fitted_case(fit: Fit) -> str:
    """The case with the fitted values, on the grid of the case."""
    values = settings(fit.unknowns, fit.solution.shares)
    statement = [fit.agreement.statement] if fit.agreement.statement else []
    heading = "".join(f"# {line}\n" for line in [*statement, *map(str, fitted_values(fit))])
    return heading + resolved_toml(load_case(fit.source, [*fit.overrides, *values]))


def _text(fit: Fit, charts: Sequence[Path]) -> str:
    """Content of fit.md: the answer, measured and computed values, and the charts."""
    title = load_case(fit.source, fit.overrides).title
    answer = (f"* {line}" for line in lines(fit))
    compared = table(MEASURED_COLUMNS, _measured_rows(fit))
    return document([f"# Fit: {title}"], answer, compared, *([one] for one in images(charts)))


def _measured_rows(fit: Fit) -> Iterator[list[str]]:
    """A row for each measured value."""
    for one in fit.agreement.comparisons:
        target = one.target
        stations = [f" at r = {x:.4g} m" for x in target.x] or [""]
        columns = (stations, target.values, target.errors, one.computed, one.errors, one.differences)
        for station, measured, error, computed, total, difference in zip(*columns, strict=True):
            unit = f" ({target.unit})" if target.unit else ""
            yield [
                f"{target.name}{station}{unit}",
                f"{measured:.4g}",
                f"{error:.2g}",
                f"{computed:.4g}",
                f"{total:.2g}",
                signed(difference),
            ]


def _table(fit: Fit) -> str:
    """A row for each run: level, folder, unknowns and all quantities."""
    text = io.StringIO()
    keys = [unknown.key for unknown in fit.unknowns]
    writer = csv.writer(text, lineterminator="\n")
    names = list(MEANINGS)
    writer.writerow(["level", "folder", *keys, *map(_column, names)])
    for one in fit.solution.evaluations:
        values = [unknown.at(float(share)) for unknown, share in zip(fit.unknowns, one.shares, strict=True)]
        for folder, quantities in zip(one.folders, one.quantities, strict=True):
            writer.writerow(
                [one.level.name, f"{RUNS}/{folder.name}", *values, *(quantities.get(name) for name in names)]
            )
    return text.getvalue()


def _column(name: str) -> str:
    unit = unit_of(name)
    return f"{name} [{unit}]" if unit else name
