"""The map: many short collapses over choices of method, each of which stands, degrades or fails.

What is run is a TOML file (`definition.py`, shipped ones in `cases/maps`). The rule by which runs are
judged is that of `mpmcol.studies.method_map.verdict`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.studies.method_map.definition import Map
from mpmcol.studies.method_map.grid_points import Place, places_of, repeats_of
from mpmcol.studies.method_map.report import write_report
from mpmcol.studies.method_map.verdict import Judged, Reference, judge, make_reference
from mpmcol.studies.runs import Found, Member, carry_out_members, find_members
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.runner import SweepObserver

RUNS = "runs"


@dataclass(frozen=True)
class Drawn:
    """What came of a map, and the files that were written."""

    outcomes: Sequence[Outcome]
    judged: Sequence[Judged]
    files: Sequence[Path]


def draw_map(
    map_: Map, out: Path, jobs: int | None = None, observer: SweepObserver | None = None, report_only: bool = False
) -> Drawn:
    """Run what the map needs into `out`/runs, completing what is there, and write its report into `out`.

    Every run has one thread. With `report_only` nothing is run, and places whose runs have not ended stay open. Raises
    UsageError if a place makes no case that can be run, OutputError if a scene has too few runs to judge by.
    """
    places = list(places_of(map_))
    repeats = {name: repeats_of(scene) for name, scene in map_.scenes.items()}
    members = [member for pair in repeats.values() for level in pair for member in level]
    members += [place.member for place in places]
    if report_only:
        outcomes, found = find_members(members, out / RUNS)
    else:
        outcomes, found = carry_out_members(members, out / RUNS, jobs, 1, observer)
    references = {name: _reference(name, own, finer, found, out) for name, (own, finer) in repeats.items()}
    judged = _judge_all(places, references, outcomes, found, out)
    return Drawn(outcomes, judged, write_report(map_, references, judged, out))


def _reference(name: str, own: Sequence[Member], finer: Sequence[Member], found: Found, out: Path) -> Reference:
    ended = [[found[member] for member in level if member in found] for level in (own, finer)]
    return make_reference(name, ended[0], ended[1], out / RUNS)


def _judge_all(
    places: Sequence[Place], references: dict[str, Reference], outcomes: Sequence[Outcome], found: Found, out: Path
) -> list[Judged]:
    ended = {outcome.run.folder: outcome for outcome in outcomes}
    return [
        judge(place, ended.get(place.member.plan(out / RUNS).folder), found.get(place.member), references[place.scene])
        for place in places
    ]
