"""What checks become: validation.csv, validation.md and charts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.experiments import EXPERIMENTS, Experiment, find_experiment, mark
from mpmcol.io.atomic import atomic_write
from mpmcol.provenance import code_version
from mpmcol.studies.runs import Finished, Found
from mpmcol.studies.validation.check import Judgement
from mpmcol.sweep.table import Row, csv_text

CSV_FILE, TEXT_FILE = "validation.csv", "validation.md"
NUMBERS = ("zeta.front_height", "beta")  # that other laws are about


@dataclass(frozen=True)
class Other:
    """What a law of another material, or of a simulation, says of a run: for information."""

    case: str
    a: float
    experiment: str
    number: str
    value: float
    error: float  # value over the law's, minus 1
    material: str


def other_laws(run: Finished) -> list[Other]:
    """Errors of a run against the laws for its kind of column, but those of the experiment that its case names."""
    row, case = run.row, run.results.case
    own = find_experiment(case.score.experiment, case.geometry.model).name
    numbers = [(one, number) for one in EXPERIMENTS.values() if one.name != own for number in NUMBERS]
    return [
        Other(row["case"], row["a"], one.name, number, row[number], error, _material(one, number))
        for one, number in numbers
        if (error := row.get(f"error.{one.name}.{number}")) is not None
    ]


def _material(experiment: Experiment, number: str) -> str:
    law = experiment.law(number.partition(".")[0])
    return f"{experiment.kind}: {experiment.material}" + ("" if law is None else mark(law.verified))


def write_report(
    judgements: Sequence[Judgement], others: Sequence[Other], found: Found, quick: bool, out: Path
) -> list[Path]:
    """Write tables and charts into `out`; returns the files."""
    charts = [path for judgement in judgements for path in _draw(judgement, found, quick, out)]
    rows = [row for judgement in judgements for row in table_rows(judgement, quick)]
    atomic_write(out / CSV_FILE, csv_text(rows).encode())
    heading = f"mpmcol {code_version()}{', quick: coarse grids, each column once' if quick else ''}."
    atomic_write(out / TEXT_FILE, markdown(judgements, others, charts, heading).encode())
    return [out / CSV_FILE, out / TEXT_FILE, *charts]


def table_rows(judgement: Judgement, quick: bool) -> Iterator[Row]:
    """A row for the check and one for each control."""
    check = judgement.check
    about = {"check": check.name, "experiment": check.experiment, "number": check.number, "unit": check.unit}
    band = {"lo": check.band.lo, "hi": check.band.hi}
    h = check.column.quick_h if quick else check.column.h
    yield about | {
        "control": "", "value": judgement.value, "standard_error": judgement.error, "runs": judgement.runs, **band,
        "inside": judgement.value is not None and judgement.value in check.band, "verdict": judgement.verdict,
        "at_rest": judgement.at_rest, "h_m": h, "source": check.band.source,
    }  # fmt: skip
    for control in judgement.controls:
        yield about | {
            "control": control.label, "value": control.value, "standard_error": None, "runs": int(control.ran), **band,
            "inside": control.accepted, "verdict": "", "at_rest": "", "h_m": h, "source": "",
        }  # fmt: skip


def shown(value: float | None, unit: str = "") -> str:
    """A number for a person."""
    return "none" if value is None else f"{value:.3g} {unit}".strip()


def band_of(judgement: Judgement) -> str:
    """The band for a person."""
    return f"{judgement.check.band.lo:.3g} to {judgement.check.band.hi:.3g}"


def summary_of(judgements: Sequence[Judgement]) -> str:
    """How many of the checks with a verified reference passed, and how many have none."""
    judged = [judgement for judgement in judgements if judgement.verdict != "unverified"]
    passed = sum(judgement.verdict == "passed" for judgement in judged)
    rest = len(judgements) - len(judged)
    return f"{passed} of {len(judged)} checks passed" + (f"; {rest} with an unverified reference" if rest else "")


def controls_of(judgement: Judgement) -> list[str]:
    """What each control measured and whether it was rejected, as it must be."""
    ends = {True: "INSIDE", False: "outside"}
    return [
        f"{control.label}: " + (f"{shown(control.value)}, {ends[control.accepted]}" if control.ran else "did not run")
        for control in judgement.controls
    ]


def markdown(judgements: Sequence[Judgement], others: Sequence[Other], charts: Sequence[Path], heading: str) -> str:
    """Verdicts, controls and sources for a reader."""
    lines = ["# Validation against experiments", "", f"{heading} {summary_of(judgements)}.", ""]
    lines += [
        "| check | number | ours | band | verdict | negative controls | where the band is from |",
        "|---" * 7 + "|",
    ]
    for judgement in judgements:
        check = judgement.check
        error = "" if judgement.error is None else f" +- {judgement.error:.2g}"
        value = f"{shown(judgement.value)}{error} {check.unit}".strip()
        rest = "" if judgement.at_rest else " (not at rest)"
        cells = (check.name, check.number, value, band_of(judgement), judgement.verdict + rest,
                 "; ".join(controls_of(judgement)), check.band.source)  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    lines += ["", "A check whose negative control lies inside the band has proved nothing, and has not passed."]
    lines += _others(others)
    lines += ["", *(f"![{chart.stem}]({chart.name})" for chart in charts)]
    return "\n".join(lines).rstrip() + "\n"


def _others(others: Sequence[Other]) -> list[str]:
    if not others:
        return []
    head = "Other laws, of other materials or of simulations: how far apart they are, for information."
    rows = [
        f"| {one.case}, a = {one.a:g} | {one.number} | {one.value:.3g} | {one.experiment} | {100.0 * one.error:+.0f} % "
        f"| {one.material} |"
        for one in others
    ]
    return ["", head, "", "| column | number | ours | experiment | ours over it | material |", "|---" * 6 + "|", *rows]


def _draw(judgement: Judgement, found: Found, quick: bool, out: Path) -> list[Path]:
    check = judgement.check
    first = check.column.members(quick)[0]
    if check.draw is None or first not in found:
        return []
    path = out / f"{check.name}.png"
    check.draw(path, found[first], check.band.hi)
    return [path]
