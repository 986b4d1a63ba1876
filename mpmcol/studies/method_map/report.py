"""What a map becomes: map.csv, map.md, environment.json and the chart."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from mpmcol.case.schema import leaf_values
from mpmcol.io.atomic import atomic_write
from mpmcol.provenance import environment
from mpmcol.studies.method_map.chart import map_chart
from mpmcol.studies.method_map.definition import Map
from mpmcol.studies.method_map.text import markdown
from mpmcol.studies.method_map.verdict import FLOORS, Judged, Reference
from mpmcol.sweep.table import Row, csv_text

CSV_FILE, TEXT_FILE, ENVIRONMENT_FILE, CHART_FILE = "map.csv", "map.md", "environment.json", "map.png"
MEASURED = ("zeta.front_height", "zeta.front_max", "beta", "at_rest", "time_over_tau", "steps", "core_seconds")


def write_report(map_: Map, references: Mapping[str, Reference], judged: Sequence[Judged], out: Path) -> list[Path]:
    """Write tables and chart into `out`; returns the files."""
    about = environment()
    charts = map_chart(out / CHART_FILE, map_, judged)
    atomic_write(out / CSV_FILE, csv_text(list(table_rows(judged))).encode())
    atomic_write(out / TEXT_FILE, markdown(map_, references, judged, charts, about).encode())
    atomic_write(out / ENVIRONMENT_FILE, (json.dumps(about, indent=1) + "\n").encode())
    return [out / CSV_FILE, out / TEXT_FILE, out / ENVIRONMENT_FILE, *charts]


def table_rows(judged: Sequence[Judged]) -> Iterator[Row]:
    """A row for each place: its choices, how it did and by which signs, what was measured, and why it failed."""
    keys = list(dict.fromkeys(key for one in judged for key in one.place.choices))
    for one in judged:
        place, verdict = one.place, one.verdict
        values = leaf_values(place.member.plan(Path()).case)
        row: Row = {"block": place.block, "panel": place.panel, "scene": place.scene}
        row |= {key: values[key] for key in keys} | {"default": place.is_default, "verdict": verdict.name}
        row |= {"beyond": " ".join(verdict.beyond), "cause": verdict.cause}
        row |= {f"{sign}.sign": verdict.signs.get(sign) for sign in FLOORS}
        row |= {name: one.run.row[name] if one.run else None for name in MEASURED}
        yield row | {"folder": one.outcome.run.folder.name if one.outcome else None}
