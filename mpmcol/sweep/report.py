"""Report of a sweep in its folder: table, slopes and charts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mpmcol.case import common_experiments
from mpmcol.experiments import Experiment, column_kind
from mpmcol.io.atomic import atomic_write
from mpmcol.setup.column_shape import column_shape
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.fits import SLOPES_FILE, Slope, fit_slopes, write_slopes
from mpmcol.sweep.notes import notes_on_results
from mpmcol.sweep.runs import PlannedRun
from mpmcol.sweep.series import ASPECT_COLUMN, Series, choose_axis, group_rows
from mpmcol.sweep.table import CSV_FILE, HDF5_FILE, Row, make_rows, table_text, write_hdf5

if TYPE_CHECKING:
    from mpmcol.plotting.figures import Heading

CHARTED = ("zeta", "beta")
FRONT_OF_MANY = "zeta.front_connected"  # the only front with fitted lines in a chart of several series


@dataclass(frozen=True)
class SweepReport:
    """Rows of all runs, fitted slopes, the files that contain them, and notes on the results."""

    folder: Path
    rows: list[Row]
    slopes: list[Slope]
    files: list[Path]
    notes: list[str]


@dataclass(frozen=True)
class ChartGroup:
    """The runs on one kind of column, which share experiments and charts."""

    name: str
    heading: Heading
    experiment: Experiment
    others: list[Experiment]
    axis: str
    series: list[Series]
    slopes: list[Slope]


def write_report(outcomes: Sequence[Outcome], out: Path) -> SweepReport:
    """Write table.csv, table.h5, slopes.csv and the charts into the sweep's folder, unless they are up to date.

    table.csv is written last, so that an up-to-date table implies up-to-date other files.
    """
    rows = make_rows(outcomes)
    groups = _chart_groups(outcomes, rows)
    slopes = [slope for group in groups for slope in group.slopes]
    charts = {out / _chart_file(quantity, group, groups): (quantity, group) for group in groups for quantity in CHARTED}
    files = [out / CSV_FILE, out / HDF5_FILE, *([out / SLOPES_FILE] if slopes else []), *charts]
    text = table_text(rows).encode()
    if not (all(path.exists() for path in files) and (out / CSV_FILE).read_bytes() == text):
        write_hdf5(out, rows, outcomes)
        if slopes:
            write_slopes(out, slopes)
        else:  # those of other runs in this folder
            (out / SLOPES_FILE).unlink(missing_ok=True)
        for path in _charts_in(out) - charts.keys():  # likewise
            path.unlink(missing_ok=True)
        for path, (quantity, group) in charts.items():
            _draw(path, quantity, group)
        atomic_write(out / CSV_FILE, text)
    return SweepReport(out, rows, slopes, files, notes_on_results(outcomes))


def _chart_groups(outcomes: Sequence[Outcome], rows: Sequence[Row]) -> list[ChartGroup]:
    """The runs that are done, by kind of column."""
    groups: dict[str, list[tuple[Outcome, Row]]] = {}
    for outcome, row in zip(outcomes, rows, strict=True):
        geometry = outcome.run.case.geometry
        if outcome.status == "done":
            groups.setdefault(column_kind(geometry.model, geometry.column_section), []).append((outcome, row))
    return [_chart_group(name, group) for name, group in groups.items()]


def _chart_group(name: str, group: list[tuple[Outcome, Row]]) -> ChartGroup:
    runs, rows = [outcome.run for outcome, _ in group], [row for _, row in group]
    keys, (experiment, others) = list(runs[0].inputs), common_experiments([run.case for run in runs])
    axis = choose_axis(rows, keys)
    series = group_rows(rows, keys, axis)
    fitted = series if axis == ASPECT_COLUMN else []
    slopes = [slope for line in fitted for slope in fit_slopes(line.rows, experiment, line.label)]
    from mpmcol.plotting.captions import noted

    return ChartGroup(name, noted(_heading(runs), experiment), experiment, others, axis, series, slopes)


def _heading(runs: Sequence[PlannedRun]) -> Heading:
    from mpmcol.plotting.captions import common_heading

    return common_heading(runs[0].case.title, [(run.case, column_shape(run.case, run.discretization)) for run in runs])


def _chart_file(quantity: str, group: ChartGroup, groups: Sequence[ChartGroup]) -> str:
    return f"{quantity}.png" if len(groups) == 1 else f"{quantity}-{group.name}.png"


def _charts_in(out: Path) -> set[Path]:
    return {path for quantity in CHARTED for path in (out / f"{quantity}.png", *out.glob(f"{quantity}-*.png"))}


def _draw(path: Path, quantity: str, group: ChartGroup) -> None:
    from mpmcol.sweep.charts import sweep_chart

    shown = [slope for slope in group.slopes if slope.quantity.startswith(quantity)]
    if len(group.series) > 1:
        shown = [slope for slope in shown if slope.quantity in ("beta", FRONT_OF_MANY)]
    sweep_chart(
        path,
        quantity,
        group.axis,
        group.series,
        group.experiment,
        others=group.others,
        slopes=shown,
        heading=group.heading,
    )
