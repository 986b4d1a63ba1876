"""A setting of a study: a scene with one family's choices at one spacing, run some times."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mpmcol.case import Case, load_case
from mpmcol.studies.definition import Value, as_text
from mpmcol.studies.pareto.study import Family, Scene, Study
from mpmcol.studies.runs import CFL_STEP, Member, with_settings


@dataclass(frozen=True)
class Setting:
    """One place on the chart: its runs differ in nothing but the time step, by CFL_STEP."""

    scene: str
    family: str
    cells: float  # r_i / h
    members: tuple[Member, ...]

    def __str__(self) -> str:
        return f"{self.scene}, {self.family}, r_i/h = {self.cells:g}"


def settings_of(study: Study) -> Iterator[Setting]:
    """All settings of a study."""
    for scene, content in study.scenes.items():
        for name in study.families_of(scene):
            for cells in study.cells_of(name, scene):
                runs = _members(content, study.families[name], cells, study.repeats_of(name))
                yield Setting(scene, name, cells, runs)


def overrides_of(case: Case, family: Family) -> dict[str, Value]:
    """The values that a family replaces in a case; its softness becomes Young's moduli, which are never raised."""
    values = dict(family.set)
    if family.softness is not None:
        modulus = case.material.density * case.geometry.gravity * case.geometry.h_i / family.softness
        values["material.youngs_modulus"] = min(modulus, case.material.youngs_modulus)
    return values


def _members(scene: Scene, family: Family, cells: float, repeats: int) -> tuple[Member, ...]:
    case = load_scene(scene)
    values = {**scene.set, **overrides_of(case, family)}
    cfl = float(values.pop("time.cfl", case.time.cfl))
    h = round(case.geometry.r_i / cells, 9)
    texts = {key: as_text(value) for key, value in values.items()}
    return tuple(
        with_settings(scene.case, scene.aspect, h, **texts, **{"time.cfl": f"{cfl * (1.0 - CFL_STEP * i):.6g}"})
        for i in range(repeats)
    )


def load_scene(scene: Scene, family: Family | None = None) -> Case:
    """The case of a scene, with the choices of a family if one is given."""
    values: dict[str, Value] = {"geometry.aspect": scene.aspect, **scene.set}
    if family is not None:
        values |= overrides_of(load_scene(scene), family)
    return load_case(scene.case, [f"{key}={as_text(value)}" for key, value in values.items()])
