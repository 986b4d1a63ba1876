"""What a figure of the paper becomes: a table, charts, and a verdict on every number that the paper states."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mpmcol.io.atomic import atomic_write

Draw = Callable[[Path], object]


@dataclass(frozen=True)
class Verdict:
    """One number beside the paper's. Shares and errors are relative: 0.036 is 3.6 %."""

    number: str
    ours: float | None  # None: there is none, as for the undisturbed radius of an eroded top
    paper: float | None = None
    limit: float | None = None  # what ours must not exceed; the number is then met or missed
    unit: str = "%"
    comment: str = ""

    @property
    def met(self) -> bool | None:
        """Whether ours is within the limit; None without one."""
        return None if self.limit is None or self.ours is None else abs(self.ours) <= self.limit

    def __str__(self) -> str:
        ending = {True: "met", False: "missed", None: ""}[self.met]
        paper = "" if self.paper is None else f"paper {self._shown(self.paper)}"
        parts = [f"{self.number}: {self._shown(self.ours)}", paper, ending, self.comment]
        return "; ".join(part for part in parts if part)

    def _shown(self, value: float | None) -> str:
        if value is None:
            return "none"
        return f"{100.0 * value:.1f} %" if self.unit == "%" else f"{value:.4g} {self.unit}".strip()


@dataclass(frozen=True)
class Report:
    """A figure as it came out; charts are drawn where there are rows."""

    rows: Sequence[Mapping[str, Any]]
    verdicts: Sequence[Verdict]
    charts: Mapping[str, Draw] = field(default_factory=dict)  # by file name


def write_report(report: Report, name: str, title: str, heading: str, out: Path) -> list[Path]:
    """Write NAME.csv, NAME.md and the charts of a figure into `out`; returns the files."""
    charts = report.charts if report.rows else {}
    files = [out / f"{name}.csv", out / f"{name}.md", *(out / chart for chart in charts)]
    atomic_write(files[0], csv_text(report.rows).encode())
    atomic_write(files[1], markdown(report, title, heading).encode())
    for chart, draw in charts.items():
        draw(out / chart)
    return files


def csv_text(rows: Sequence[Mapping[str, Any]]) -> str:
    """Rows of equal columns, numbers with six digits."""
    text = io.StringIO()
    if rows:
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({name: _cell(value) for name, value in row.items()} for row in rows)
    return text.getvalue()


def markdown(report: Report, title: str, heading: str) -> str:
    """Verdicts and table for a reader."""
    lines = [f"# {title}", "", heading, ""]
    lines += [f"* {verdict}" for verdict in report.verdicts]
    if report.rows:
        names = list(report.rows[0])
        lines += ["", f"| {' | '.join(names)} |", "|---" * len(names) + "|"]
        lines += [f"| {' | '.join(_shown(value) for value in row.values())} |" for row in report.rows]
    lines += ["", *(f"![{chart}]({chart})" for chart in report.charts)]
    return "\n".join(lines).rstrip() + "\n"


def _cell(value: Any) -> Any:
    return f"{value:.6g}" if isinstance(value, float) else value


def _shown(value: Any) -> str:
    if value is None or value == "":
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
