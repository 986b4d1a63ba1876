"""Studies of cost against error as TOML files: which scenes, which families of settings, how fine."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from mpmcol.studies.definition import Strict, Value, load_definition, shipped_definitions

Cells = tuple[Annotated[float, Field(ge=2.0, le=1000.0)], ...]


class Scene(Strict):
    """A collapse whose converged runout, height and profile are sought."""

    case: str  # a shipped case or a path
    aspect: float = Field(gt=0.0)
    set: dict[str, Value] = Field(default_factory=dict)  # further values of the case
    finest: float | None = Field(None, ge=2.0)  # r_i / h that no family goes beyond; all of theirs if absent


class Family(Strict):
    """Settings that differ from a scene's own in some choices, at some spacings."""

    set: dict[str, Value] = Field(default_factory=dict)
    softness: float | None = Field(None, gt=0.0, lt=0.1)  # rho g h_i / E; the scene's own if absent
    cells: Cells | None = None  # r_i / h; the study's if absent
    scenes: tuple[str, ...] | None = None  # all if absent
    repeats: int | None = Field(None, ge=1)
    offered: bool = False  # whether `mpmcol run --accuracy` may choose it


class Study(Strict):
    """Scenes times families times spacings, every setting run some times; `reference` names two families."""

    schema_: Literal[1] = Field(1, alias="schema")
    title: str = ""
    repeats: int = Field(4, ge=1, le=20)  # runs of a setting, with time steps a little apart
    cells: Cells
    base: str  # family that single choices are compared with
    reference: tuple[str, str]  # families that are refined independently
    scenes: dict[str, Scene] = Field(min_length=1)
    families: dict[str, Family] = Field(min_length=1)

    @model_validator(mode="after")
    def _names(self) -> Study:
        for name in (self.base, *self.reference):
            if name not in self.families:
                raise ValueError(f"no family is called {name!r}")
        if self.reference[0] == self.reference[1]:
            raise ValueError("reference takes two different families")
        for family, content in self.families.items():
            for scene in content.scenes or ():
                if scene not in self.scenes:
                    raise ValueError(f"families.{family}: no scene is called {scene!r}")
        return self

    def cells_of(self, family: str, scene: str) -> Cells:
        """r_i / h of a family's settings in a scene, coarsest first."""
        finest = self.scenes[scene].finest or float("inf")
        return tuple(sorted(cells for cells in self.families[family].cells or self.cells if cells <= finest))

    def repeats_of(self, family: str) -> int:
        """Runs of each of a family's settings."""
        return self.families[family].repeats or self.repeats

    def families_of(self, scene: str) -> list[str]:
        """Families that a scene is run with."""
        return [name for name, family in self.families.items() if family.scenes is None or scene in family.scenes]


def shipped_studies() -> dict[str, Path]:
    """Studies that come with mpmcol, by name."""
    return shipped_definitions("studies")


def load_study(source: str) -> Study:
    """Read a study: a shipped one by its name, or a file. See `load_definition` for what is raised."""
    return load_definition(source, shipped_studies(), "study", Study)
