"""Panels of a map, and its Markdown report."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.studies.markdown import document, images, table
from mpmcol.studies.method_map.assessment import DEVIATIONS, FLOORS, MEAN_FACTOR, AssessedPoint, MapReference
from mpmcol.studies.method_map.definition import MapDefinition

SYMBOLS = {"zeta": "ζ", "beta": "β", "profile": "A", "detachment": "→", "volume": "J", "step_reduction": "t"}
MEANINGS = {
    "zeta": "runout (front_height)", "beta": "height", "profile": "profile (area between)",
    "detachment": "points detached ahead of the front", "volume": "volume ratio away from 1",
    "step_reduction": "reduced time step",
}  # fmt: skip
MAX_EXAMPLES = 3


@dataclass(frozen=True)
class Panel:
    """A panel of the chart: a point for each value down (rows) and across (columns)."""

    block: str
    title: str
    down: str  # key
    across: str
    rows: Sequence[Sequence[AssessedPoint]]

    @property
    def values_down(self) -> list[str]:
        """Values of the rows, from the top."""
        return [row[0].point.choices[self.down] for row in self.rows]

    @property
    def values_across(self) -> list[str]:
        """Values of the columns, from the left."""
        return [one.point.choices[self.across] for one in self.rows[0]]


def panels_of(assessed: Sequence[AssessedPoint]) -> Iterator[Panel]:
    """Yield the panels in their order."""
    by_panel: dict[tuple[str, str], dict[str, list[AssessedPoint]]] = {}
    for one in assessed:
        point = one.point
        rows = by_panel.setdefault((point.block, point.panel), {})
        rows.setdefault(point.choices[point.down], []).append(one)
    for (block, title), rows in by_panel.items():
        point = next(iter(rows.values()))[0].point
        yield Panel(block, title, point.down, point.across, list(rows.values()))


def passes_up_to(row: Sequence[AssessedPoint]) -> AssessedPoint | None:
    """Return the last point of a row up to which all pass; None if the first one does not."""
    last = None
    for one in row:
        if one.rating != "passes":
            break
        last = one
    return last


def markdown(
    definition: MapDefinition,
    references: Mapping[str, MapReference],
    assessed: Sequence[AssessedPoint],
    charts: Sequence[Path],
    heading: str,
) -> str:
    """Format counts, gaps, chart, criteria with their numbers, every point, and causes."""
    seconds = {one.run.folder: one.run.row["core_seconds"] for one in assessed if one.run}
    return document(
        [f"# {definition.title}"],
        [f"{heading}, one thread per run, {sum(seconds.values()):.3g} core-seconds of successful runs."],
        [f"{counts(assessed)}."],
        _gaps(assessed),
        images(charts),
        ["## Criteria"],
        _criteria(),
        _cases(definition, references),
        _limits(references),
        ["## All grid points"],
        [f"Degraded by {legend()}."],
        *(_panel(panel) for panel in panels_of(assessed)),
        ["## Failures"],
        _examples("cause", _failed(assessed)),
        ["## Degradation"],
        _examples("worst metric", _degraded(assessed)),
    )


def counts(assessed: Sequence[AssessedPoint]) -> str:
    """Count how many points pass, degrade and fail."""
    number = Counter(one.rating for one in assessed)
    text = f"{len(assessed)} grid points: {number['passes']} pass, {number['degrades']} degrade, {number['fails']} fail"
    return text + (f", {number['not run']} not run" if number["not run"] else "")


def legend() -> str:
    """Explain the symbols of the metrics."""
    return ", ".join(f"{SYMBOLS[metric]} {MEANINGS[metric]}" for metric in FLOORS)


def closing_lines(assessed: Sequence[AssessedPoint]) -> Iterator[str]:
    """Yield the counts of each panel, and the gaps, as lines for a terminal."""
    panels = list(panels_of(assessed))
    width = max(len(panel.title) for panel in panels)
    for panel in panels:
        yield f"{panel.title:{width}}  {counts([one for row in panel.rows for one in row])}"
    yield counts(assessed)
    yield from _gaps(assessed)


def reason(one: AssessedPoint) -> str:
    """Return why a point does not pass; "" if it does."""
    if one.rating == "fails":
        return f"fails: {one.assessment.cause}"
    return ", ".join(f"{MEANINGS[metric]} {one.assessment.metrics[metric]:.3g}" for metric in one.assessment.exceeded)


def _gaps(assessed: Sequence[AssessedPoint]) -> Iterator[str]:
    """Yield the points at which the default method of a case does not pass."""
    defaults = [one for one in assessed if one.point.is_default and one.rating != "not run"]
    gaps = [one for one in defaults if one.is_gap]
    text = f"The default method passes at {len(defaults) - len(gaps)} of {len(defaults)} grid points"
    yield f"{text}. It does not pass at:" if gaps else f"{text}."
    yield from ["", *(f"* {one.point.label}: {reason(one)}" for one in gaps)] if gaps else []


def _criteria() -> Iterator[str]:
    yield "A run fails if it did not end successfully. It degrades if a metric exceeds its limit: the larger of a floor"
    yield f"and {MEAN_FACTOR:g} times the mean of the case's own method at the spacing of the map plus {DEVIATIONS:g}"
    yield "standard deviations, widened for one further run. Errors of zeta, beta and profile are relative to the mean"
    yield "of the own method on the finer grid."


def _cases(definition: MapDefinition, references: Mapping[str, MapReference]) -> Iterator[str]:
    columns = (
        "case", "extends", "a", "r_i/h", "finer", "runs of the own method", "zeta, finer grid", "beta, finer grid"
    )  # fmt: skip
    return table(
        columns,
        (
            (
                name, case.extends, f"{case.aspect:g}", f"{case.cells:g}", f"{case.finer:g}", f"{reference.runs}",
                f"{reference.zeta:.3f}", f"{reference.beta:.3f}",
            )
            for name, case, reference in ((name, definition.cases[name], one) for name, one in references.items())
        ),
    )  # fmt: skip


def _limits(references: Mapping[str, MapReference]) -> Iterator[str]:
    def cell(reference: MapReference, metric: str) -> str:
        own = f"{reference.means[metric]:.2g} +- {reference.deviations[metric]:.1g}"
        return f"{reference.limits[metric]:.3g} ({own})"

    return table(
        ("limit (mean +- deviation of the own method)", "floor", *references),
        (
            (
                f"{SYMBOLS[metric]} {MEANINGS[metric]}",
                f"{floor:g}",
                *(cell(reference, metric) for reference in references.values()),
            )
            for metric, floor in FLOORS.items()
        ),
    )


def _panel(panel: Panel) -> Iterator[str]:
    down, across = (key.rpartition(".")[2] for key in (panel.down, panel.across))
    yield f"### {panel.title}"
    yield ""
    rows = []
    for name, row in zip(panel.values_down, panel.rows, strict=True):
        highest = passes_up_to(row)
        rows.append((name, *map(_cell, row), highest.point.choices[panel.across] if highest else "none"))
    columns = (down, *(f"{across} {value}" for value in panel.values_across), f"passes up to {across}")
    yield from table(columns, rows)


def _cell(one: AssessedPoint) -> str:
    if one.rating != "degrades":
        return one.rating
    return " ".join(f"{SYMBOLS[metric]} {one.assessment.metrics[metric]:.2g}" for metric in one.assessment.exceeded)


def _failed(assessed: Sequence[AssessedPoint]) -> Mapping[str, list[AssessedPoint]]:
    """Return the points that fail by cause, without the numbers at its end."""
    groups: dict[str, list[AssessedPoint]] = {}
    for one in assessed:
        if one.rating == "fails":
            groups.setdefault(re.sub(r" \([^)]*\)$", "", one.assessment.cause), []).append(one)
    return groups


def _degraded(assessed: Sequence[AssessedPoint]) -> Mapping[str, list[AssessedPoint]]:
    """Return the points that degrade by the metric that exceeds its limit most."""
    groups: dict[str, list[AssessedPoint]] = {}
    for one in assessed:
        if one.rating == "degrades":
            groups.setdefault(MEANINGS[one.assessment.exceeded[0]], []).append(one)
    return groups


def _examples(group: str, points: Mapping[str, Sequence[AssessedPoint]]) -> Iterator[str]:
    if not points:
        yield "None."
        return
    rows = []
    for name, members in sorted(points.items(), key=lambda item: -len(item[1])):
        panels = Counter(one.point.panel for one in members)
        by_panel = "; ".join(f"{panel}: {count}" for panel, count in panels.most_common())
        examples = "; ".join(one.point.label for one in members[:MAX_EXAMPLES])
        rows.append((name, f"{len(members)}", by_panel, examples))
    yield from table((group, "grid points", "by panel", "examples"), rows)
