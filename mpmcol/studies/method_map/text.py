"""map.md: a map for a reader."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from mpmcol.studies.method_map.definition import Map
from mpmcol.studies.method_map.rows import Panel, panels_of, stands_up_to
from mpmcol.studies.method_map.verdict import FLOORS, MULTIPLE, SHARE, Judged, Reference

SYMBOLS = {"zeta": "ζ", "beta": "β", "profile": "A", "ahead": "→", "volume": "J", "slowing": "t"}
MEANINGS = {
    "zeta": "runout (front_height)", "beta": "height", "profile": "profile (area between)",
    "ahead": "farthest point ahead of the front", "volume": "volume ratio away from 1", "slowing": "shrunk time step",
}  # fmt: skip
STANDS, FAILS, OPEN = "stands", "fails", "not run"
MOST_EXAMPLES = 3


def markdown(
    map_: Map,
    references: Mapping[str, Reference],
    judged: Sequence[Judged],
    charts: Sequence[Path],
    about: Mapping[str, Any],
) -> str:
    """Counts, the rule with its numbers, gaps, the chart, every place, and what fails and degrades by what."""
    seconds = {one.run.folder: one.run.row["core_seconds"] for one in judged if one.run}
    lines = [
        f"# {map_.title}", "",
        f"mpmcol {about['mpmcol']}; {about['cpu']}, one thread a run, {sum(seconds.values()):.3g} core-seconds in runs "
        "that ended well.", "", f"{counted(judged)}.", "",
    ]  # fmt: skip
    lines += [*_gaps(judged), "", *(f"![{chart.stem}]({chart.name})" for chart in charts), ""]
    lines += [*_rule(map_, references), ""]
    lines += ["## Every place", "", f"Degraded by {legend()}.", ""]
    for panel in panels_of(judged):
        lines += [*_panel(panel), ""]
    lines += [*_failures(judged), "", *_degraded(judged)]
    return "\n".join(lines).rstrip() + "\n"


def counted(judged: Sequence[Judged]) -> str:
    """How many stand, degrade and fail."""
    names = Counter(one.verdict.name for one in judged)
    told = f"{len(judged)} places: {names['stands']} stand, {names['degrades']} degrade, {names['fails']} fail"
    return told + (f", {names['open']} have not been run" if names["open"] else "")


def legend() -> str:
    """What the symbols mean."""
    return ", ".join(f"{SYMBOLS[sign]} {MEANINGS[sign]}" for sign in FLOORS)


def closing_lines(judged: Sequence[Judged]) -> Iterator[str]:
    """Counts of every panel and the gaps, for a terminal."""
    panels = list(panels_of(judged))
    width = max(len(panel.title) for panel in panels)
    for panel in panels:
        yield f"{panel.title:{width}}  {counted([one for row in panel.rows for one in row])}"
    yield counted(judged)
    yield from _gaps(judged)


def reason(one: Judged) -> str:
    """Why a place does not stand; "" if it does."""
    if one.verdict.name == "fails":
        return f"fails: {one.verdict.cause}"
    return ", ".join(f"{MEANINGS[sign]} {one.verdict.signs[sign]:.3g}" for sign in one.verdict.beyond)


def _gaps(judged: Sequence[Judged]) -> Iterator[str]:
    """Places where a case's own method does not stand."""
    places = [one for one in judged if one.place.is_default and one.verdict.name != "open"]
    gaps = [one for one in places if one.is_gap]
    told = f"The default method stands at {len(places) - len(gaps)} of {len(places)} places"
    yield f"{told}; where it does not:" if gaps else f"{told}."
    yield from ["", *(f"* {place_name(one)}: {reason(one)}" for one in gaps)] if gaps else []


def place_name(one: Judged) -> str:
    """A place for a person."""
    place = one.place
    last = (f"{key.rpartition('.')[2]} {place.choices[key]}" for key in (place.down, place.across))
    return ", ".join((place.panel, *last))


def _rule(map_: Map, references: Mapping[str, Reference]) -> Iterator[str]:
    yield "## The rule"
    yield ""
    yield "A run fails that did not end well. It degrades by a sign that is above its limit. That is, or is a floor if"
    yield f"that is more, {SHARE:g} times the mean that the scene's own method has at the map's spacing and"
    yield f"{MULTIPLE:g} standard deviations of one further run. Errors of zeta, beta and profile are relative to the"
    yield "mean of the scene's own method on the finer grid."
    yield ""
    yield "| scene | case | a | r_i/h | finer | runs of its own method | zeta, finer grid | beta, finer grid |"
    yield "|---" * 8 + "|"
    for name, reference in references.items():
        scene = map_.scenes[name]
        yield (
            f"| {name} | {scene.case} | {scene.aspect:g} | {scene.cells:g} | {scene.finer:g} | {reference.runs} "
            f"| {reference.zeta:.3f} | {reference.beta:.3f} |"
        )
    yield ""
    yield f"| limit (mean +- deviation of the own method) | floor | {' | '.join(references)} |"
    yield "|---" * (2 + len(references)) + "|"
    for sign, floor in FLOORS.items():
        cells = (
            f"{one.limits[sign]:.3g} ({one.means[sign]:.2g} +- {one.deviations[sign]:.1g})"
            for one in references.values()
        )
        yield f"| {SYMBOLS[sign]} {MEANINGS[sign]} | {floor:g} | {' | '.join(cells)} |"


def _panel(panel: Panel) -> Iterator[str]:
    down, across = (key.rpartition(".")[2] for key in (panel.down, panel.across))
    values = panel.values_across
    yield f"### {panel.title}"
    yield ""
    yield f"| {down} | {' | '.join(f'{across} {value}' for value in values)} | stands up to {across} |"
    yield "|---" * (2 + len(values)) + "|"
    for name, row in zip(panel.values_down, panel.rows, strict=True):
        highest = stands_up_to(row)
        upto = highest.place.choices[panel.across] if highest else "none"
        yield f"| {name} | {' | '.join(_cell(one) for one in row)} | {upto} |"


def _cell(one: Judged) -> str:
    verdict = one.verdict
    words = {"stands": STANDS, "fails": FAILS, "open": OPEN}
    return words.get(verdict.name) or " ".join(f"{SYMBOLS[sign]} {verdict.signs[sign]:.2g}" for sign in verdict.beyond)


def _failures(judged: Sequence[Judged]) -> Iterator[str]:
    """Places that failed by their cause, numbers in it left out."""
    found: dict[str, list[Judged]] = {}
    for one in judged:
        if one.verdict.name == "fails":
            found.setdefault(re.sub(r" \([^)]*\)$", "", one.verdict.cause), []).append(one)
    yield "## What fails"
    yield ""
    yield from _examples("cause", found)


def _degraded(judged: Sequence[Judged]) -> Iterator[str]:
    """Places that degrade by the sign that is farthest beyond its limit."""
    found: dict[str, list[Judged]] = {}
    for one in judged:
        if one.verdict.name == "degrades":
            found.setdefault(MEANINGS[one.verdict.beyond[0]], []).append(one)
    yield "## What degrades"
    yield ""
    yield from _examples("worst sign", found)


def _examples(what: str, found: Mapping[str, Sequence[Judged]]) -> Iterator[str]:
    if not found:
        yield "None."
        return
    yield f"| {what} | places | by panel | of them |"
    yield "|---" * 4 + "|"
    for name, ones in sorted(found.items(), key=lambda item: -len(item[1])):
        panels = Counter(one.place.panel for one in ones)
        told = "; ".join(f"{panel}: {count}" for panel, count in panels.most_common())
        examples = "; ".join(place_name(one) for one in ones[:MOST_EXAMPLES])
        yield f"| {name} | {len(ones)} | {told} | {examples} |"
