"""Section of the report of a sweep with uncertain inputs."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from mpmcol.errors import OutputError
from mpmcol.io.columns import with_unit
from mpmcol.report.model import Section, Table
from mpmcol.report.pictures import file_picture
from mpmcol.studies.uncertainty.report import CHART_FILE, JSON_FILE
from mpmcol.sweep.plan import Plan

STATISTICS = {
    "count": "runs", "mean": "mean", "standard_deviation": "standard deviation", "p5": "5 %", "p25": "25 %",
    "median": "median", "p75": "75 %", "p95": "95 %",
}  # fmt: skip
FIT = {
    "residual": "scatter and what the surface omits", "scatter": "of it scatter",
    "adjusted_r2": "adjusted R2",
    "cross_validated_r2": "cross-validated R2", "grid_share": "error of the grid, over its sum with the variance",
}  # fmt: skip
PROBABILITY = {
    "distance": "distance (m)", "met": "runs", "count": "of", "value": "probability", "lo": "from", "hi": "to (95 %)",
}  # fmt: skip
CAPTION = "Histograms of all runs, and shares of the variance"
DIGITS = 4

Record = Mapping[str, Any]


def uncertainty_sections(folder: Path, plan: Plan) -> list[Section]:
    """The section with the statistics of the planned runs; none if they are no sample of uncertain inputs."""
    path = folder / JSON_FILE
    if not path.exists():
        return []
    try:
        record = json.loads(path.read_bytes())
        if record["runs"] != [run.folder for run in plan.runs]:  # the folder had another sweep before
            return []
        return [_section(folder, record)]
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise OutputError(f"{path} is damaged ({error}); delete it and repeat the `mpmcol sweep` command") from None


def _section(folder: Path, record: Record) -> Section:
    quantities, keys = record["quantities"], [one["key"] for one in record["inputs"]]
    tables = [_table("Quantity", STATISTICS, quantities, "Statistics")] if quantities else []
    if split := [_shares(one, keys) for one in quantities if one.get("surface")]:
        shown = {key: key for key in keys} | FIT
        tables.append(_table("Quantity", shown, split, "Shares of the variance: first-order (total) Sobol indices"))
    if record["passes"]:
        named = [{"quantity": "front_height", **one} for one in record["passes"]]
        tables.append(_table("Front", PROBABILITY, named, "Probability that the front passes a distance"))
    picture = file_picture(folder / CHART_FILE, f"Chart: {CAPTION}", CAPTION) if quantities else None
    inputs = [f"{one['key']} = {one['distribution']}" for one in record["inputs"]]
    inputs += [f"{key}: each run has a realization of its own" for key in record.get("realizations", ())]
    counts = f"{record['done']} of {record['samples']} runs of a Latin hypercube (seed {record['seed']}) are done"
    notes = [f"{one['quantity']}: {one['note']}" for one in quantities if one.get("note")]
    return Section("Uncertainty", [*inputs, counts, *notes], tables, [picture] if picture else [], is_wide=True)


def _shares(one: Record, keys: Sequence[str]) -> Record:
    """A quantity with a text for the shares of each input."""
    return {**one, **{key: _share(one["first_order"][key], one["total"][key]) for key in keys}}


def _share(first: float | None, total: float | None) -> str:
    """Shares of an input alone and with interactions; empty where they are not given."""
    return "" if first is None or total is None else f"{first:.0%} ({total:.0%})"


def _table(heading: str, columns: Mapping[str, str], rows: Sequence[Record], caption: str) -> Table:
    body = [
        [with_unit(row["quantity"], row.get("unit", "")), *(_short(row.get(name)) for name in columns)] for row in rows
    ]
    return Table((heading, *columns.values()), body, caption)


def _short(value: Any) -> str:
    """A number with few digits; empty without a value."""
    return "" if value is None else f"{value:.{DIGITS}g}" if isinstance(value, float) else str(value)
