"""What a sweep leaves behind in its folder: table, slopes and charts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.experiments import Experiment, column_kind, find_experiment
from mpmcol.io.atomic import atomic_write
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.fits import SLOPES_FILE, Slope, fit_slopes, write_slopes
from mpmcol.sweep.series import ASPECT_COLUMN, Series, arrange, choose_axis
from mpmcol.sweep.table import CSV_FILE, HDF5_FILE, Row, csv_text, make_rows, write_hdf5

CHARTED = ("zeta", "beta")
FRONT_OF_MANY = "zeta.front_connected"  # where several series share a chart, only this definition is fitted in it


@dataclass(frozen=True)
class SweepReport:
    """Rows of all points, fitted slopes, and the files in the sweep's folder that hold them."""

    folder: Path
    rows: list[Row]
    slopes: list[Slope]
    files: list[Path]


@dataclass(frozen=True)
class Kind:
    """The points on one kind of column, which share experiments and charts."""

    name: str
    title: str
    experiment: Experiment
    axis: str
    series: list[Series]
    slopes: list[Slope]


def write_report(outcomes: Sequence[Outcome], out: Path) -> SweepReport:
    """Write table.csv, table.h5, slopes.csv and the charts into the sweep's folder, unless they are as they should be.

    table.csv is written last: where it is right, the others are, too.
    """
    rows = make_rows(outcomes)
    kinds = _kinds(outcomes, rows)
    slopes = [slope for kind in kinds for slope in kind.slopes]
    charts = {out / _chart_file(quantity, kind, kinds): (quantity, kind) for kind in kinds for quantity in CHARTED}
    files = [out / CSV_FILE, out / HDF5_FILE, *([out / SLOPES_FILE] if slopes else []), *charts]
    text = csv_text(rows).encode()
    if not (all(path.exists() for path in files) and (out / CSV_FILE).read_bytes() == text):
        write_hdf5(out, rows, outcomes)
        if slopes:
            write_slopes(out, slopes)
        for path, (quantity, kind) in charts.items():
            _draw(path, quantity, kind)
        atomic_write(out / CSV_FILE, text)
    return SweepReport(out, rows, slopes, files)


def _kinds(outcomes: Sequence[Outcome], rows: Sequence[Row]) -> list[Kind]:
    """The points that are done, by kind of column."""
    groups: dict[str, list[tuple[Outcome, Row]]] = {}
    for outcome, row in zip(outcomes, rows, strict=True):
        geometry = outcome.run.case.geometry
        if outcome.status == "done":
            groups.setdefault(column_kind(geometry.model, geometry.section), []).append((outcome, row))
    return [_kind(name, group) for name, group in groups.items()]


def _kind(name: str, group: list[tuple[Outcome, Row]]) -> Kind:
    point, rows = group[0][0].run, [row for _, row in group]
    geometry, keys = point.case.geometry, list(point.inputs)
    experiment = find_experiment(point.case.score.experiment, geometry.model, geometry.section)
    axis = choose_axis(rows, keys)
    series = arrange(rows, keys, axis)
    fitted = series if axis == ASPECT_COLUMN else []
    slopes = [slope for line in fitted for slope in fit_slopes(line.rows, experiment, line.label)]
    return Kind(name, point.case.title, experiment, axis, series, slopes)


def _chart_file(quantity: str, kind: Kind, kinds: Sequence[Kind]) -> str:
    return f"{quantity}.png" if len(kinds) == 1 else f"{quantity}-{kind.name}.png"


def _draw(path: Path, quantity: str, kind: Kind) -> None:
    from mpmcol.sweep.charts import sweep_chart

    shown = [slope for slope in kind.slopes if slope.quantity.startswith(quantity)]
    if len(kind.series) > 1:
        shown = [slope for slope in shown if slope.quantity in ("beta", FRONT_OF_MANY)]
    sweep_chart(path, quantity, kind.axis, kind.series, kind.experiment, shown, kind.title)
