"""Results of a figure: a table, charts, and comparisons with the numbers that the paper states."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import common_experiments, load_case
from mpmcol.io.atomic import atomic_write
from mpmcol.measure import FRONTS
from mpmcol.plotting.figures import Heading
from mpmcol.studies.convergence import first_order_value
from mpmcol.studies.markdown import document, images, table
from mpmcol.studies.runs import CompletedRun
from mpmcol.sweep.charts import sweep_chart
from mpmcol.sweep.series import ASPECT_COLUMN, Series
from mpmcol.sweep.table import csv_text

QUANTITIES = (*(f"zeta.{front}" for front in FRONTS), "beta")

Draw = Callable[[Path], object]
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Comparison:
    """A computed number and that of the paper. With the unit "%" numbers are ratios: 0.036 is 3.6 %."""

    name: str
    computed: float | None  # None: no value, for example the undisturbed radius of an eroded top
    stated: float | None = None  # by the paper
    limit: float | None = None  # largest magnitude with which the paper's statement is met
    unit: str = "%"
    comment: str = ""

    @property
    def is_met(self) -> bool | None:
        """Whether the computed number is within the limit; None without a limit or a number."""
        return None if self.limit is None or self.computed is None else abs(self.computed) <= self.limit

    def __str__(self) -> str:
        verdict = {True: "met", False: "missed", None: ""}[self.is_met]
        stated = "" if self.stated is None else f"paper {self._format(self.stated)}"
        parts = [f"{self.name}: {self._format(self.computed)}", stated, verdict, self.comment]
        return "; ".join(part for part in parts if part)

    def _format(self, value: float | None) -> str:
        if value is None:
            return "none"
        return f"{100.0 * value:.1f} %" if self.unit == "%" else f"{value:.4g} {self.unit}".strip()


@dataclass(frozen=True)
class FigureResult:
    """Table, comparisons and charts of a figure; charts are drawn if the table has rows."""

    rows: Sequence[Row]
    comparisons: Sequence[Comparison]
    charts: Mapping[str, Draw] = field(default_factory=dict)  # by file name


def series_row(runs: Iterable[CompletedRun], finest: CompletedRun) -> dict[str, Any]:
    """Return the row of a column: results on the finest grid, grid-converged values from `runs`, errors of both.

    Errors are relative to the laws of the paper and None outside their range.
    """
    runs, row = list(runs), finest.row
    line: dict[str, Any] = {"a": row["a"], "h_mm": 1e3 * row["spacing_used"], "points": row["column_points"]}
    for quantity in QUANTITIES:
        law, value = row[f"law.{quantity.partition('.')[0]}"], row[quantity]
        converged = first_order_value([run.row["spacing_used"] for run in runs], [run.row[quantity] for run in runs])
        line[quantity] = value
        line[f"{quantity} error"] = None if law is None else value / law - 1.0
        line[f"{quantity} converged"] = converged and converged.value
        line[f"{quantity} converged +-"] = converged and converged.error
        line[f"{quantity} converged error"] = None if law is None or converged is None else converged.value / law - 1.0
    line["law.zeta"], line["law.beta"] = row["law.zeta"], row["law.beta"]
    line |= {name: row[name] for name in ("spread", "at_rest", "steps", "seconds")}
    return line


def law_charts(files: Mapping[str, str], cases: Iterable[str], series: Sequence[Series], title: str) -> dict[str, Draw]:
    """Charts of runout or height over the aspect ratio, beside the experiments that apply to the cases.

    files: name of the chart -> "zeta" or "beta".
    """
    experiment, others = common_experiments([load_case(name) for name in cases])
    options: dict[str, Any] = {"series": series, "experiment": experiment, "others": others, "heading": Heading(title)}
    return {
        name: partial(sweep_chart, quantity=quantity, axis=ASPECT_COLUMN, **options) for name, quantity in files.items()
    }


def error_summary(
    rows: Sequence[Row], quantity: str, label: str, mean: float | None, largest: float | None = None
) -> list[Comparison]:
    """Compare the mean |error| of a series, and the largest if the paper states one, on the grid and grid-converged."""
    comparisons = []
    spacing = f"h = {max(row['h_mm'] for row in rows):.3g} mm" if rows else ""
    for column, where in ((f"{quantity} error", spacing), (f"{quantity} converged error", "grid-converged")):
        errors = {row["a"]: abs(row[column]) for row in rows if row[column] is not None}
        if not errors:
            continue
        average, worst = float(np.mean(list(errors.values()))), max(errors, key=lambda a: errors[a])
        name, count = f"{label}, {quantity}, {where}", f"{len(errors)} columns"
        comparisons.append(Comparison(f"{name}, mean |error|", average, mean, mean, comment=count))
        if largest is not None:
            which = f"a = {worst:g}"
            comparisons.append(Comparison(f"{name}, largest |error|", errors[worst], largest, largest, comment=which))
    return comparisons


def write_figure(result: FigureResult, name: str, title: str, heading: str, out: Path) -> list[Path]:
    """Write NAME.csv, NAME.md and the charts of a figure into the folder `out`; return the files."""
    charts = {out / chart: draw for chart, draw in result.charts.items()} if result.rows else {}
    files = [out / f"{name}.csv", out / f"{name}.md"]
    atomic_write(files[0], rounded_csv(result.rows).encode())
    atomic_write(files[1], markdown(result, title, heading).encode())
    for path, draw in charts.items():
        draw(path)
    return [*files, *charts]


def rounded_csv(rows: Sequence[Row]) -> str:
    """Format rows with equal columns as CSV, numbers with six digits; "" without rows."""
    return csv_text([{name: _rounded(value) for name, value in row.items()} for row in rows]) if rows else ""


def _rounded(value: Any) -> Any:
    return f"{value:.6g}" if isinstance(value, float) else value


def markdown(result: FigureResult, title: str, heading: str) -> str:
    """Format comparisons, table and links to the charts."""
    rows = [[_format(value) for value in row.values()] for row in result.rows]
    return document(
        [f"# {title}"],
        [heading],
        [f"* {comparison}" for comparison in result.comparisons],
        table(list(result.rows[0]), rows) if rows else (),
        images(Path(chart) for chart in result.charts),
    )


def _format(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
