"""Content of the report of a sweep."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from mpmcol.errors import OutputError
from mpmcol.experiments import EXPERIMENTS
from mpmcol.report.model import Page, Section, Table
from mpmcol.report.pictures import file_picture
from mpmcol.report.provenance import with_unit
from mpmcol.report.uncertainty import uncertainty_sections
from mpmcol.sweep.axes import ASPECT
from mpmcol.sweep.fits import SLOPES_FILE
from mpmcol.sweep.notes import counted_warnings, stored_warnings
from mpmcol.sweep.plan import read_plan
from mpmcol.sweep.report import CHARTED
from mpmcol.sweep.table import AGAIN, CSV_FILE, FINER_GRIDS, read_table, unit_of

RUNOUT, HEIGHT = "zeta.front_height", "beta"
FINER_RUNOUT, FINER_HEIGHT = f"zeta.{FINER_GRIDS}", f"beta.{FINER_GRIDS}"  # of runs with an accuracy
QUANTITIES = {
    RUNOUT: "Runout (front_height)", FINER_RUNOUT: "Runout on finer grids", HEIGHT: "Height",
    FINER_HEIGHT: "Height on finer grids",
}  # fmt: skip
LAWS = {RUNOUT: "law.zeta", FINER_RUNOUT: "law.zeta", HEIGHT: "law.beta", FINER_HEIGHT: "law.beta"}
COLUMNS = {  # of the table of the sweep -> heading
    "a": "a", RUNOUT: "zeta (front_height)", FINER_RUNOUT: "on finer grids", "law.zeta": "published", HEIGHT: "beta",
    FINER_HEIGHT: "on finer grids", "law.beta": "published", "points": "material points", "seconds": "time (s)",
}  # fmt: skip
SLOPE_COLUMNS = {
    "series": "Runs", "quantity": "Quantity", "lo": "from a", "hi": "to a", "count": "runs", "exponent": "exponent",
    "half_width": "+- (95 %)", "law_exponent": "published exponent", "law": "published by",
}  # fmt: skip
REQUIRED = ("folder", "status", "message", "a", *LAWS.values())
CAPTIONS = {"zeta": "Runout of all runs", "beta": "Final height of all runs"}
DIGITS = 4

Row = Mapping[str, str]


def sweep_page(folder: Path) -> Page:
    """The report of a sweep of which the table and the charts exist."""
    plan, rows = read_plan(folder), read_table(folder / CSV_FILE, REQUIRED)
    keys = [key for key in plan.runs[0].inputs if key in rows[0]]
    constant = {key: rows[0][key] for key in keys if len({row[key] for row in rows}) == 1}
    tables = [_run_table([key for key in keys if key not in constant], rows)]
    if (folder / SLOPES_FILE).exists():
        tables.append(_slope_table(read_table(folder / SLOPES_FILE, SLOPE_COLUMNS)))
    charts = [path for quantity in CHARTED for path in sorted(folder.glob(f"{quantity}*.png"))]
    pictures = [file_picture(path, f"Chart: {_caption(path)}", _caption(path)) for path in charts]
    failures = [f"{_name(row)} {row['status']}: {row['message']}" for row in rows if row["status"] != "done"]
    warnings = counted_warnings([stored_warnings(folder / row["folder"]) for row in rows])
    return Page(
        title=plan.title or "Untitled sweep",
        kind="mpmcol: report of a sweep",
        facts=[_counts(rows), *(_fixed(key, value) for key, value in constant.items())],
        sections=[
            Section("Judgement", lines=list(_judgement(rows))),
            *([Section("Warnings", lines=warnings)] if warnings else []),
            *([Section("Runs without a result", lines=failures)] if failures else []),
            *uncertainty_sections(folder, plan),
            Section("Charts", pictures=pictures),
            Section("Runs", tables=tables),
            Section("Versions", tables=[_version_table(rows)]),
        ],
    )


def _judgement(rows: Sequence[Row]) -> Iterator[str]:
    """Mean absolute differences from the law of the experiment, over the runs at rest within its range."""
    at_rest = [row for row in rows if row["status"] == "done" and row["at_rest"] == "true"]
    moving = sum(row["status"] == "done" for row in rows) - len(at_rest)
    yield f"{len(at_rest)} of {len(rows)} columns came to rest" + (
        f", {moving} still moved at the end" if moving else ""
    )
    for column, name in QUANTITIES.items():
        if column not in rows[0] and column in (FINER_RUNOUT, FINER_HEIGHT):
            continue
        law = LAWS[column]
        errors = [_difference(row[column], row[law]) for row in at_rest if row[law]]
        if errors:
            yield (
                f"{name}: mean difference from the published law {np.mean(errors):+.1%}, mean absolute difference "
                f"{np.mean(np.abs(errors)):.1%}, largest {max(errors, key=abs):+.1%} ({len(errors)} runs)"
            )
        else:
            yield f"{name}: no published law applies"


def _difference(value: str, published: str) -> float:
    try:
        return float(value) / float(published) - 1.0
    except (ValueError, ZeroDivisionError):
        raise OutputError(
            f"{CSV_FILE} of the sweep is damaged: {value!r} and {published!r} are not both numbers; {AGAIN}"
        ) from None


def _run_table(keys: Sequence[str], rows: Sequence[Row]) -> Table:
    columns = {key: with_unit(key) for key in keys if key != ASPECT}
    columns |= {name: text for name, text in COLUMNS.items() if name in rows[0]}  # without measurements if all failed
    body = [(_name(row), _state(row), *(_short(row[name]) for name in columns)) for row in rows]
    return Table(("Run", "Status", *columns.values()), body, texts=2)


def _state(row: Row) -> str:
    return f"{row['status']}, still moving" if row.get("at_rest") == "false" else row["status"]


def _slope_table(rows: Sequence[Row]) -> Table:
    columns = {name: text for name, text in SLOPE_COLUMNS.items() if any(row[name] for row in rows)}
    body = [[_citation(row[name]) if name == "law" else _short(row[name]) for name in columns] for row in rows]
    return Table(list(columns.values()), body, "Exponents of fitted power laws", texts=1 + ("series" in columns))


def _version_table(rows: Sequence[Row]) -> Table:
    columns = [name for name in rows[0] if name.startswith("version.")]
    used = {name: ", ".join(dict.fromkeys(row[name] for row in rows if row[name])) for name in columns}
    return Table(("Item", "Value"), [(name.partition(".")[2], value) for name, value in used.items()], texts=2)


def _caption(chart: Path) -> str:
    quantity, _, group = chart.stem.partition("-")
    return CAPTIONS.get(quantity, quantity) + (f" ({group})" if group else "")


def _counts(rows: Sequence[Row]) -> str:
    counts = Counter(row["status"] for row in rows)
    return f"{len(rows)} {'run' if len(rows) == 1 else 'runs'}: " + ", ".join(
        f"{count} {status}" for status, count in counts.items()
    )


def _name(row: Row) -> str:
    """Name of a run: its folder without the hash."""
    return row["folder"].rpartition("-")[0]


def _fixed(key: str, value: str) -> str:
    unit = unit_of(key)
    return f"{key} = {_short(value)}" + ("" if unit == "1" else f" {unit}")


def _citation(experiment: str) -> str:
    return EXPERIMENTS[experiment].citation if experiment in EXPERIMENTS else experiment


def _short(text: str) -> str:
    """A number with few digits; other text unchanged."""
    try:
        return text if text.isdecimal() else f"{float(text):.{DIGITS}g}"
    except ValueError:
        return text
