"""Report of a validation: validation.csv, validation.md and charts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.experiments import EXPERIMENTS, Experiment, find_experiment, mark
from mpmcol.io.atomic import atomic_write
from mpmcol.studies.markdown import document, images, table
from mpmcol.studies.runs import CompletedRun
from mpmcol.studies.validation.check import CheckResult
from mpmcol.sweep.table import Row, csv_text

CSV_FILE, TEXT_FILE = "validation.csv", "validation.md"
QUANTITIES = ("zeta.front_height", "beta")  # compared with the laws of other experiments


@dataclass(frozen=True)
class OtherLaw:
    """A run compared with the law of another experiment or simulation, for information."""

    case: str
    a: float
    experiment: str
    quantity: str
    value: float
    error: float  # relative to the law
    material: str


def other_laws(run: CompletedRun) -> list[OtherLaw]:
    """Compare a run with the laws for its kind of column, except those of the experiment that its case names."""
    row, case = run.row, run.results.case
    own = find_experiment(case.score.experiment, case.geometry.model).name
    pairs = [(one, quantity) for one in EXPERIMENTS.values() if one.name != own for quantity in QUANTITIES]
    return [
        OtherLaw(row["case"], row["a"], one.name, quantity, row[quantity], error, _material(one, quantity))
        for one, quantity in pairs
        if (error := row.get(f"error.{one.name}.{quantity}")) is not None
    ]


def _material(experiment: Experiment, quantity: str) -> str:
    law = experiment.law(quantity.partition(".")[0])
    return f"{experiment.kind}: {experiment.material}" + ("" if law is None else mark(law.verified))


def write_report(
    results: Sequence[CheckResult], others: Sequence[OtherLaw], quick: bool, heading: str, out: Path
) -> list[Path]:
    """Write table, text and charts into the folder `out`; return the files."""
    charts = [path for result in results for path in _draw(result, out)]
    rows = [row for result in results for row in table_rows(result, quick)]
    atomic_write(out / CSV_FILE, csv_text(rows).encode())
    atomic_write(out / TEXT_FILE, markdown(results, others, charts, heading).encode())
    return [out / CSV_FILE, out / TEXT_FILE, *charts]


def table_rows(result: CheckResult, quick: bool) -> Iterator[Row]:
    """Yield a row for the check and one for each negative control."""
    check = result.check
    about = {"check": check.name, "experiment": check.experiment, "quantity": check.quantity, "unit": check.unit}
    band = {"lo": check.band.lo, "hi": check.band.hi}
    h = check.column.quick_h if quick else check.column.h
    yield about | {
        "control": "", "value": result.value, "standard_error": result.error, "runs": result.runs, **band,
        "inside": result.value is not None and result.value in check.band, "verdict": result.verdict,
        "at_rest": result.at_rest, "h_m": h, "source": check.band.source,
    }  # fmt: skip
    for control in result.controls:
        yield about | {
            "control": control.label, "value": control.value, "standard_error": None, "runs": int(control.was_run),
            **band, "inside": control.is_inside, "verdict": "", "at_rest": "", "h_m": h, "source": "",
        }  # fmt: skip


def format_value(value: float | None) -> str:
    """Format a value without its unit."""
    return "none" if value is None else f"{value:.3g}"


def format_band(result: CheckResult) -> str:
    """Format the band of a check."""
    return f"{result.check.band.lo:.3g} to {result.check.band.hi:.3g}"


def format_controls(result: CheckResult) -> list[str]:
    """Format the negative controls: values, and whether they are outside the band as required."""
    where = {True: "INSIDE", False: "outside"}
    return [
        f"{control.label}: "
        + (f"{format_value(control.value)}, {where[control.is_inside]}" if control.was_run else "not run")
        for control in result.controls
    ]


def summary(results: Sequence[CheckResult]) -> str:
    """Count the checks that passed, and those that can neither pass nor fail."""
    counted = [result for result in results if result.check.band.verified]
    passed = sum(result.verdict == "passed" for result in counted)
    left_out = len(results) - len(counted)
    return f"{passed} of {len(counted)} checks passed" + (f"; {left_out} with unverified bands" if left_out else "")


def markdown(results: Sequence[CheckResult], others: Sequence[OtherLaw], charts: Sequence[Path], heading: str) -> str:
    """Format verdicts, negative controls and sources."""
    return document(
        ["# Validation against experiments"],
        [f"{heading} {summary(results)}."],
        table(
            ("check", "quantity", "computed", "band", "verdict", "negative controls", "source of the band"),
            map(_cells, results),
        ),
        [
            "A check is inconclusive if a negative control is inside the band: the band does not discriminate then. A",
            "check is unverified if its band was not read in the publication; it is shown for information and can",
            "neither pass nor fail.",
        ],
        _others(others),
        images(charts),
    )


def _cells(result: CheckResult) -> tuple[str, ...]:
    check = result.check
    error = "" if result.error is None else f" +- {result.error:.2g}"
    value = f"{format_value(result.value)}{error} {check.unit}".strip()
    verdict = result.verdict + ("" if result.at_rest else " (not at rest)")
    controls = "; ".join(format_controls(result))
    return (check.name, check.quantity, value, format_band(result), verdict, controls, check.band.source)


def _others(others: Sequence[OtherLaw]) -> Iterator[str]:
    if not others:
        return
    yield "For information: laws of other materials, and of simulations."
    yield ""
    rows = (
        (
            f"{one.case}, a = {one.a:g}", one.quantity, f"{one.value:.3g}", one.experiment,
            f"{100.0 * one.error:+.0f} %", one.material,
        )
        for one in others
    )  # fmt: skip
    yield from table(("column", "quantity", "computed", "experiment", "relative to the law", "material"), rows)


def _draw(result: CheckResult, out: Path) -> list[Path]:
    check = result.check
    if check.draw is None or result.first_run is None:
        return []
    path = out / f"{check.name}.png"
    check.draw(path, result.first_run, check.band.hi)
    return [path]
