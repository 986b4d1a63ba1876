"""Files and text of a fit: values with standard errors, their parts, evaluations, the fitted case."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import load_case, resolved_toml
from mpmcol.io.atomic import atomic_write
from mpmcol.io.values import to_json
from mpmcol.provenance import environment
from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.fit import RUNS, Fit
from mpmcol.studies.fit.identify import remarks
from mpmcol.studies.fit.quantities import ASSUMED_ERROR, FRONT, QUANTITIES
from mpmcol.studies.fit.search import CAUSES
from mpmcol.studies.fit.unknowns import settings
from mpmcol.studies.frame import ENVIRONMENT_FILE
from mpmcol.studies.markdown import document, images

FIT_FILE, EVALUATIONS_FILE, CASE_FILE = "fit.json", "evaluations.csv", "fitted.toml"
TEXT_FILE = "fit.md"
CHART_FILE, PROFILE_CHART_FILE = "fit.png", "profile.png"
FIT_SCHEMA = 1
POOR = 4.0  # misfit, in standard errors squared per degree of freedom, from which on it is reported


@dataclass(frozen=True)
class FittedValue:
    """An unknown with its value, its standard error and the parts of that by cause; None if it exceeds the range."""

    key: str
    unit: str
    value: float
    error: float | None
    parts: dict[str, float] | None

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        if self.error is None or self.parts is None:
            return f"{self.key} = {self.value:.4g}{unit}, not determined"
        parts = ", ".join(f"{cause} {part:.2g}" for cause, part in self.parts.items())
        half = NORMAL_90 * self.error
        low, high = self.value - half, self.value + half
        return (
            f"{self.key} = {self.value:.4g} +- {self.error:.2g}{unit} (standard error; 90 %: {low:.4g} to {high:.4g}; "
            f"{parts})"
        )


def fitted_values(fit: Fit) -> list[FittedValue]:
    """The unknowns; standard errors are larger by the misfit where that is larger than the errors explain."""
    found, scale = fit.solution.precision, excess(fit)
    values = []
    for k, unknown in enumerate(fit.unknowns):
        width = (unknown.high - unknown.low) * scale
        is_known = found is not None and found.errors[k] < 1.0  # of the range
        error = float(width * found.errors[k]) if found is not None and is_known else None
        parts = {cause: float(width * found.part(cause)[k]) for cause in CAUSES} if found and is_known else None
        value = unknown.low + float(fit.solution.shares[k]) * (unknown.high - unknown.low)
        values.append(FittedValue(unknown.key, unknown.unit, value, error, parts))
    return values


def excess(fit: Fit) -> float:
    """Factor of the standard errors, at least 1: square root of chi squared per degree of freedom."""
    freedom = fit.solution.freedom
    return max(sqrt(fit.solution.chi_squared / freedom), 1.0) if freedom else 1.0


def lines(fit: Fit) -> Iterator[str]:
    """The answer in words."""
    yield from map(str, fitted_values(fit))
    solution, grid = fit.solution, fit.solution.last.level
    unstated = ", ".join(target.name for target in fit.targets if not target.is_stated)
    if unstated:
        yield f"{unstated}: standard error of the measurement not stated, {ASSUMED_ERROR:.0%} assumed"
    if grid.errors is None:
        yield "without the error of the grid, which is not studied for these settings (--accuracy chooses studied ones)"
    for target, fitted in zip(fit.targets, _by_target(fit, solution.fitted), strict=True):
        difference = np.sqrt(np.mean((fitted - target.values) ** 2))
        unit = f" {target.unit}" if target.unit else ""
        if len(fitted) == 1:
            yield f"{target.name} {fitted[0]:.4g}{unit} with these values, measured {target.values[0]:.4g}{unit}"
        else:
            yield f"{target.name}: root mean square difference {1e3 * difference:.3g} mm with these values"
    if solution.freedom and solution.chi_squared > POOR * solution.freedom:
        yield (
            f"the case does not reproduce all measurements: misfit {sqrt(solution.chi_squared / solution.freedom):.1f} "
            "standard errors, by which those of the values are enlarged"
        )
    yield from remarks(fit.unknowns, fit.targets, solution)
    seconds = sum(one.core_seconds for one in solution.evaluations)
    runs = sum(len(one.folders) for one in solution.evaluations)
    yield f"{runs} runs, {seconds:.3g} core-seconds; grid of the answer: r_i/h = {grid.cells:g}"


def record(fit: Fit) -> dict[str, Any]:
    """Content of fit.json."""
    solution, grid = fit.solution, fit.solution.last.level
    found = solution.precision
    return {
        "schema": FIT_SCHEMA,
        "folder": str(fit.folder),
        "unknowns": [
            {"key": one.key, "value": one.value, "standard_error": one.error, "parts": one.parts, "unit": one.unit,
             "low": unknown.low, "high": unknown.high}
            for one, unknown in zip(fitted_values(fit), fit.unknowns, strict=True)
        ],
        "correlation": None if found is None else found.correlation.tolist(),
        "targets": [
            {"name": target.name, "unit": target.unit, "measured": target.values.tolist(),
             "standard_error": target.errors.tolist(), "x": target.x.tolist(), "fitted": fitted.tolist()}
            for target, fitted in zip(fit.targets, _by_target(fit, solution.fitted), strict=True)
        ],
        "front": FRONT,
        "chi_squared": solution.chi_squared,
        "degrees_of_freedom": solution.freedom,
        "grid": {"cells": grid.cells, "overrides": list(grid.overrides), "errors": grid.errors},
        "remarks": list(remarks(fit.unknowns, fit.targets, solution)),
        "runs": sum(len(one.folders) for one in solution.evaluations),
        "core_seconds": sum(one.core_seconds for one in solution.evaluations),
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
    heading = "".join(f"# {line}\n" for line in map(str, fitted_values(fit)))
    return heading + resolved_toml(load_case(fit.source, [*fit.overrides, *values]))


def _text(fit: Fit, charts: Sequence[Path]) -> str:
    """Content of fit.md: the answer with its charts."""
    title = load_case(fit.source, fit.overrides).title
    return document([f"# Fit: {title}"], (f"* {line}" for line in lines(fit)), *([one] for one in images(charts)))


def _table(fit: Fit) -> str:
    """A row for each run: level, folder, unknowns and all quantities."""
    text = io.StringIO()
    keys = [unknown.key for unknown in fit.unknowns]
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["level", "folder", *keys, *(_column(name) for name in QUANTITIES)])
    for one in fit.solution.evaluations:
        values = [unknown.at(float(share)) for unknown, share in zip(fit.unknowns, one.shares, strict=True)]
        for folder, deposit in zip(one.folders, one.deposits, strict=True):
            quantities = [QUANTITIES[name].of(deposit) for name in QUANTITIES]
            writer.writerow([one.level.name, f"{RUNS}/{folder.name}", *values, *quantities])
    return text.getvalue()


def _column(name: str) -> str:
    unit = QUANTITIES[name].unit
    return f"{name} [{unit}]" if unit else name


def _by_target(fit: Fit, values: np.ndarray) -> list[np.ndarray]:
    return np.split(values, np.cumsum([len(target.values) for target in fit.targets])[:-1])
