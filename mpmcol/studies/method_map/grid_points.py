"""The places of a map: one for each run that is drawn, with the choices that it differs in from a scene's own case."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from mpmcol.case import load_case
from mpmcol.case.schema import leaf_values
from mpmcol.errors import MpmcolError, UsageError
from mpmcol.studies.definition import as_text
from mpmcol.studies.method_map.definition import Block, Map, Scene
from mpmcol.studies.runs import CFL_STEP, Member, with_settings
from mpmcol.sweep.runs import short_names

CFL = "time.cfl"
CONDITIONS = ("material.", "geometry.")  # keys that say what collapses, not how it is computed


@dataclass(frozen=True)
class Place:
    """One run on the map."""

    block: str
    panel: str  # title
    scene: str
    choices: Mapping[str, str]  # key of the case -> value, of all that the block sets
    across: str  # keys of two of the choices
    down: str
    is_default: bool  # no choice of method differs from the case's own, and the time step is not longer
    member: Member


def places_of(map_: Map) -> Iterator[Place]:
    """All places, panel by panel, row by row. Raises UsageError that names a place whose case is wrong."""
    for name, block in map_.blocks.items():
        for values in itertools.product(*block.panels.values(), *block.down.values(), *block.across.values()):
            keys = (*block.panels, *block.down, *block.across)
            varied = {key: as_text(value) for key, value in zip(keys, values, strict=True)}
            yield _place(name, block, map_.scenes[block.scene], varied)


def repeats_of(scene: Scene) -> tuple[list[Member], list[Member]]:
    """Runs of a scene's own method with time steps a little apart: at the map's spacing, and at the finer one."""
    cfl = load_case(scene.case, [f"geometry.aspect={scene.aspect}"]).time.cfl
    levels = ((scene.cells, scene.repeats), (scene.finer, scene.finer_repeats))
    own, finer = (
        [_member(scene, cells, {CFL: f"{cfl * (1.0 - CFL_STEP * i):.6g}"}) for i in range(count)]
        for cells, count in levels
    )
    return own, finer


def _place(name: str, block: Block, scene: Scene, varied: Mapping[str, str]) -> Place:
    choices = {key: as_text(value) for key, value in block.set.items()} | dict(varied)
    try:
        member = _member(scene, scene.cells, choices)
        _ = member.plan(Path()).discretization  # refuses what fits no grid
    except MpmcolError as error:
        told = ", ".join(f"{key} = {value}" for key, value in choices.items())
        raise UsageError(f"blocks.{name}, {told}:\n{error}") from None
    return Place(
        name, _title(name, block, varied), block.scene, choices, next(iter(block.across)), next(iter(block.down)),
        _is_default(scene, dict(member.settings)), member,
    )  # fmt: skip


def _title(name: str, block: Block, varied: Mapping[str, str]) -> str:
    """Of a panel: what it alone has, or the name of its block."""
    words = short_names(block.panels)
    return ", ".join(f"{words[key]} {varied[key]}" for key in block.panels) or name


def _member(scene: Scene, cells: float, choices: Mapping[str, str]) -> Member:
    """The run; choices that are a case's own are left out, so that equal runs of several blocks are one."""
    case = load_case(scene.case, [f"geometry.aspect={scene.aspect}"])
    kept = {key: text for key, text in sorted(choices.items()) if not _is_own(scene.case, scene.aspect, key, text)}
    return with_settings(scene.case, scene.aspect, round(case.geometry.r_i / cells, 9), **kept)


@cache
def _is_own(case: str, aspect: float, key: str, text: str) -> bool:
    """Whether a case has this value anyway."""
    column = f"geometry.aspect={aspect}"
    own, asked = (leaf_values(load_case(case, overrides)) for overrides in ([column], [column, f"{key}={text}"]))
    return bool(own == asked)


def _is_default(scene: Scene, settings: Mapping[str, str]) -> bool:
    own = load_case(scene.case, [f"geometry.aspect={scene.aspect}"])
    choices = [key for key in settings if not key.startswith((*CONDITIONS, "output."))]
    return not choices or (choices == [CFL] and float(settings[CFL]) < own.time.cfl)
