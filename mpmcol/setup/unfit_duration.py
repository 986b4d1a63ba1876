"""Durations and numbers of time steps that are known to be unfit; the checks are entries of `unfit_settings.CHECKS`."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt
from typing import Any, NamedTuple

from mpmcol.case import Case
from mpmcol.case.schema import MAX_TIME_FACTOR
from mpmcol.case.values import leaf_values
from mpmcol.mpm.constitutive import elastic
from mpmcol.setup.durations import TYPICAL_TAU, fall_time, stage_durations, time_step, typical_duration
from mpmcol.units import Table, length_text

SHORTEST = 1.0  # sqrt(h_i / g), about the time of a fall from the top: no column is at rest before
MOST_DAMPING, USUAL_DAMPING = 0.1, 0.05
MOST_STEPS = 2e6  # a run of a hundred thousand points takes hours
# values with which runs of columns are accurate; the note proposes them
USUAL_CFL = 0.5
USUAL_CELLS = 100  # in the smaller of radius and height
USUAL_RATIO = 0.49  # Poisson's ratio; E_oed = 17 E
USUAL_SHORTENING = 0.001  # of the height by the column's own weight
USUAL_GRAVITY = 9.81  # m/s2
USUAL_GATE_SPEED = 0.1  # sqrt(g h_i)


def short_collapse(case: Case, h: float) -> str | None:
    """A run until rest ends before the column can have collapsed."""
    collapse = case.stages.collapse
    if collapse.end == "time" or collapse.max_time_factor >= SHORTEST:
        return None
    end = collapse.max_time_factor * fall_time(case)
    return (
        f"stages.collapse.max_time_factor = {collapse.max_time_factor:g}: the run ends {end:.3g} s after the release, "
        f"before the column has collapsed; columns come to rest after about {TYPICAL_TAU:g} sqrt(h_i / g); set "
        f'{MAX_TIME_FACTOR:g}, or stages.collapse.end = "time" if this duration is of interest'
    )


def large_damping(case: Case, h: float) -> str | None:
    """Local damping acts on the flow as additional friction; scripts/paper/README.md has its effect."""
    damping = case.stages.collapse.damping
    if damping <= MOST_DAMPING:
        return None
    return (
        f"stages.collapse.damping = {damping:g}: local damping reduces the net force by this part, so that the column "
        f"falls more slowly and stops too early; {USUAL_DAMPING:g} already costs 3 to 9 % of the runout; set "
        f"{USUAL_DAMPING:g} or less"
    )


def late_times(case: Case, h: float) -> str | None:
    """No snapshot is written after the end of a run."""
    times, last = case.output.times, stage_durations(case, 0.0)[1][1]
    if times is None or times[-1] <= last * (1.0 + 1e-9):
        return None
    late = next(time for time in times if time > last)
    return (
        f"output.times: {late:g} s is after the end of the run, at most {last:.4g} s after the release, so that it has "
        f"no snapshot; set {last:.4g} s or less, or a larger stages.collapse.max_time_factor"
    )


def many_steps(case: Case, h: float) -> str | None:
    """Numbers of steps with which a run takes days or years, with the value that reduces them most."""
    steps = _Sizes(case, h).steps
    if steps <= MOST_STEPS:
        return None
    changes = list(_changes(case, h))
    count = f"about {steps:.2g} time steps of {time_step(case, h):.2g} s"
    if not changes:
        return f"time: the run takes {count} for {typical_duration(case, h):.3g} s; check the units of all values"
    best = min(changes, key=lambda change: change.result.steps)
    return (
        f"{best.key} = {best.given}: the run takes {count} for {typical_duration(case, h):.3g} s; set "
        f"{best.proposed}, with which it takes about {best.result.steps:.2g}"
    )


class _Sizes(NamedTuple):
    """A case and its node spacing, m."""

    case: Case
    h: float

    @property
    def steps(self) -> float:
        """Typical number of time steps."""
        return typical_duration(*self) / time_step(*self)


class _Change(NamedTuple):
    """A key, its value and the proposed one as texts, and the case with that."""

    key: str
    given: str
    proposed: str
    result: _Sizes


def _changes(case: Case, h: float) -> Iterator[_Change]:
    """Keys whose values cause more steps than usual ones, each with the usual value."""
    geometry, stages = case.geometry, case.stages
    gate_speed = USUAL_GATE_SPEED * sqrt(geometry.gravity * geometry.h_i)
    if (coarser := min(geometry.r_i, geometry.h_i) / USUAL_CELLS) > h:
        yield _Change("grid.spacing", length_text(h), length_text(coarser), _Sizes(case, coarser))
    if case.time.cfl < USUAL_CFL:
        yield _change(case, h, "time.cfl", USUAL_CFL, "")
    if stages.gate_speed < gate_speed:
        yield _change(case, h, "stages.gate_speed", gate_speed, "m/s")
    if geometry.gravity < USUAL_GRAVITY:
        yield _change(case, h, "geometry.gravity", USUAL_GRAVITY, "m/s2")
    if stages.collapse.end == "time" and stages.collapse.max_time_factor > MAX_TIME_FACTOR:
        yield _change(case, h, "stages.collapse.max_time_factor", MAX_TIME_FACTOR, "")
    yield from _material_changes(case, h)


def _material_changes(case: Case, h: float) -> Iterator[_Change]:
    """Those of the stiffest material; what it shares with others changes with it."""
    key, stiffest = max(_materials(case).items(), key=lambda item: item[1].wave_speed)
    weight = stiffest.density * max(case.geometry.gravity, USUAL_GRAVITY) * case.geometry.h_i
    softer = float(f"{weight / (2.0 * USUAL_SHORTENING):.1e}")
    if stiffest.poissons_ratio > USUAL_RATIO:
        locking = (
            ', and method.volumetric_strain = "cell" against volumetric locking'
            if case.method.volumetric_strain == "point"
            else ""
        )
        changed = _with_materials(case, "poissons_ratio", USUAL_RATIO)
        given = f"{stiffest.poissons_ratio:.9g}"
        yield _Change(f"{key}.poissons_ratio", given, f"{USUAL_RATIO:g}{locking}", _Sizes(changed, h))
    if stiffest.youngs_modulus > softer:
        changed = _with_materials(case, "youngs_modulus", softer)
        given = f"{stiffest.youngs_modulus:g} Pa"
        yield _Change(f"{key}.youngs_modulus", given, f"{softer:g} Pa", _Sizes(changed, h))


def _change(case: Case, h: float, key: str, usual: float, unit: str) -> _Change:
    given, proposed = (f"{value:.3g} {unit}".rstrip() for value in (leaf_values(case)[key], usual))
    return _Change(key, given, proposed, _Sizes(_replaced(case, key, usual), h))


def _replaced(table: Any, key: str, value: float) -> Any:
    """A copy of a table in which a dotted key has another value."""
    name, _, rest = key.partition(".")
    return table.model_copy(update={name: _replaced(getattr(table, name), rest, value) if rest else value})


def _materials(case: Case) -> dict[str, elastic.Elasticity]:
    layers = {f"layers.{number}.material": layer.material for number, layer in enumerate(case.layers)}
    return {"material": case.material, "base_material": case.base_material, **layers}


def _with_materials(case: Case, key: str, most: float) -> Case:
    """The case with at most this value in all materials."""

    def limited(material: Table) -> Table:
        return material.model_copy(update={key: min(getattr(material, key), most)})

    layers = tuple(layer.model_copy(update={"material": limited(layer.material)}) for layer in case.layers)
    changed = {"material": limited(case.material), "base_material": limited(case.base_material), "layers": layers}
    return case.model_copy(update=changed)
