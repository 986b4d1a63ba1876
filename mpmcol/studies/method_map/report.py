"""Report of a map: map.csv, map.md and the chart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from mpmcol.case.values import leaf_values
from mpmcol.io.atomic import atomic_write
from mpmcol.studies.method_map.assessment import FLOORS, AssessedPoint, MapReference
from mpmcol.studies.method_map.chart import map_chart
from mpmcol.studies.method_map.definition import MapDefinition
from mpmcol.studies.method_map.text import markdown
from mpmcol.sweep.table import Row, csv_text

CSV_FILE, TEXT_FILE, CHART_FILE = "map.csv", "map.md", "map.png"
MEASURED = ("zeta.front_height", "zeta.front_max", "beta", "at_rest", "time_over_tau", "steps", "core_seconds")


def write_report(
    definition: MapDefinition,
    references: Mapping[str, MapReference],
    assessed: Sequence[AssessedPoint],
    heading: str,
    out: Path,
) -> list[Path]:
    """Write table, text and chart into the folder `out`; return the files."""
    charts = map_chart(out / CHART_FILE, definition, assessed)
    atomic_write(out / CSV_FILE, csv_text(list(table_rows(assessed))).encode())
    atomic_write(out / TEXT_FILE, markdown(definition, references, assessed, charts, heading).encode())
    return [out / CSV_FILE, out / TEXT_FILE, *charts]


def table_rows(assessed: Sequence[AssessedPoint]) -> Iterator[Row]:
    """Yield a row for each point: choices, rating, metrics, measurements, and the cause of a failure."""
    keys = list(dict.fromkeys(key for one in assessed for key in one.point.choices))
    for one in assessed:
        point, assessment = one.point, one.assessment
        values = leaf_values(point.run.plan(Path()).case)
        row: Row = {"block": point.block, "panel": point.panel, "case": point.case}
        row |= {key: values.get(key) for key in keys} | {"default": point.is_default, "rating": assessment.rating}
        row |= {"exceeded": " ".join(assessment.exceeded), "cause": assessment.cause}
        row |= {f"{metric}.metric": assessment.metrics.get(metric) for metric in FLOORS}
        row |= {name: one.run.row[name] if one.run else None for name in MEASURED}
        yield row | {"folder": one.outcome.run.folder.name if one.outcome else None}
