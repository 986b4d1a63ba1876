"""Definition of a study of cost against error: cases, scheme variants, and the configurations that they give.

A configuration is one case computed with one scheme variant at one node spacing. Its runs are at this spacing and at
slightly coarser ones, because results depend on where the nodes lie.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from mpmcol.case import Case, load_case
from mpmcol.studies.definition import (
    DefinitionTable,
    Value,
    as_overrides,
    as_text,
    load_definition,
    shipped_definitions,
)
from mpmcol.studies.runs import StudyRun, study_run

LEAST_CELLS = 2.0  # in the radius
Cells = Annotated[tuple[Annotated[float, Field(ge=LEAST_CELLS, le=1000.0)], ...], Field(min_length=1)]


class StudyCase(DefinitionTable):
    """A collapse whose grid-converged runout, height and profile are sought."""

    extends: str  # shipped case or path
    aspect: float = Field(gt=0.0)
    set: dict[str, Value] = Field(default_factory=dict)  # further values of the case
    finest: float | None = Field(None, ge=LEAST_CELLS)  # largest r_i / h for this case; no limit if absent
    variants: tuple[str, ...] | None = None  # with which it is computed; all that do not list other cases if absent


class Variant(DefinitionTable):
    """A scheme variant: values of the method that replace those of a case, at some spacings."""

    set: dict[str, Value] = Field(default_factory=dict)
    softness: float | None = Field(None, gt=0.0, lt=0.1)  # rho g h_i / E; that of the case if absent
    cells: Cells | None = None  # r_i / h; those of the study if absent
    cases: tuple[str, ...] | None = None  # all if absent
    repeats: int | None = Field(None, ge=1, le=5)
    selectable: bool = False  # whether `mpmcol run --accuracy` may choose it


class StudyDefinition(DefinitionTable):
    """All cases with all scheme variants at all spacings, each configuration with several runs."""

    schema_: Literal[1] = Field(1, alias="schema")
    title: str = ""
    repeats: int = Field(2, ge=1, le=5)  # runs of a configuration, each with one cell fewer in the radius
    cells: Cells
    baseline: str  # variant that single choices are compared with
    reference: tuple[str, ...] = Field(min_length=2)  # variants that are refined independently
    cases: dict[str, StudyCase] = Field(min_length=1)
    variants: dict[str, Variant] = Field(min_length=1)

    @model_validator(mode="after")
    def _check_names(self) -> StudyDefinition:
        for name in (self.baseline, *self.reference):
            if name not in self.variants:
                raise ValueError(f"there is no variant {name!r}")
        if len(set(self.reference)) < len(self.reference):
            raise ValueError("reference needs two different variants or more")
        for variant, content in self.variants.items():
            for case in content.cases or ():
                if case not in self.cases:
                    raise ValueError(f"variants.{variant}: there is no case {case!r}")
        for case, own in self.cases.items():
            for variant in own.variants or ():
                if variant not in self.variants:
                    raise ValueError(f"cases.{case}: there is no variant {variant!r}")
            if missing := set(self.reference) - set(self.variants_of(case)):
                raise ValueError(f"reference: the case {case!r} is not computed with {', '.join(sorted(missing))}")
        return self

    @model_validator(mode="after")
    def _check_cells(self) -> StudyDefinition:
        for name, variant in self.variants.items():
            coarsest, repeats = min(variant.cells or self.cells), self.repeats_of(name)
            if coarsest - repeats + 1 < LEAST_CELLS:
                raise ValueError(
                    f"variants.{name}: with {repeats} runs of a configuration, each with one cell fewer in the radius, "
                    f"cells must be at least {LEAST_CELLS + repeats - 1:g}, not {coarsest:g}"
                )
        return self

    def repeats_of(self, variant: str) -> int:
        """Return the number of runs of a configuration of a variant."""
        return self.variants[variant].repeats or self.repeats

    def cells_of(self, variant: str, case: str) -> Cells:
        """Return r_i / h of a variant for a case, coarsest first."""
        finest = self.cases[case].finest or float("inf")
        return tuple(sorted(cells for cells in self.variants[variant].cells or self.cells if cells <= finest))

    def variants_of(self, case: str) -> list[str]:
        """Return the variants with which a case is computed."""
        own = self.cases[case].variants
        return [
            name for name, variant in self.variants.items()
            if (own is None or name in own) and (variant.cases is None or case in variant.cases)
        ]  # fmt: skip


@dataclass(frozen=True)
class Configuration:
    """One case with one scheme variant at one spacing; each further run has one cell fewer in the radius."""

    case: str
    variant: str
    cells: float  # r_i / h
    runs: tuple[StudyRun, ...]

    def __str__(self) -> str:
        return f"{self.case}, {self.label}"

    @property
    def label(self) -> str:
        """Variant and spacing."""
        return f"{self.variant}, r_i/h = {self.cells:g}"


def shipped_studies() -> dict[str, Path]:
    """Return the shipped studies by name."""
    return shipped_definitions("studies")


def load_study(source: str) -> StudyDefinition:
    """Load a study: a shipped one by its name, or a file; for errors see `load_definition`."""
    return load_definition(source, shipped_studies(), "study", StudyDefinition)


def configurations_of(study: StudyDefinition) -> Iterator[Configuration]:
    """Yield all configurations of a study."""
    for name, case in study.cases.items():
        for variant in study.variants_of(name):
            repeats = study.repeats_of(variant)
            for cells in study.cells_of(variant, name):
                yield Configuration(name, variant, cells, _repeated_runs(case, study.variants[variant], cells, repeats))


def variant_values(case: Case, variant: Variant) -> dict[str, Value]:
    """Return the values that a variant replaces in a case; softness gives a Young's modulus, which is never raised."""
    values = dict(variant.set)
    if variant.softness is not None:
        modulus = case.material.density * case.geometry.gravity * case.geometry.h_i / variant.softness
        values["material.youngs_modulus"] = min(modulus, case.material.youngs_modulus)
    return values


def load_study_case(case: StudyCase, variant: Variant | None = None) -> Case:
    """Load the case of a study, with a scheme variant if one is given."""
    values: dict[str, Value] = {"geometry.aspect": case.aspect, **case.set}
    if variant is not None:
        values |= variant_values(load_study_case(case), variant)
    return load_case(case.extends, as_overrides(values))


def _repeated_runs(study_case: StudyCase, variant: Variant, cells: float, repeats: int) -> tuple[StudyRun, ...]:
    case = load_study_case(study_case)
    values = {**study_case.set, **variant_values(case, variant)}
    texts = {key: as_text(value) for key, value in values.items()}
    spacings = (round(case.geometry.r_i / (cells - i), 9) for i in range(repeats))
    return tuple(study_run(study_case.extends, study_case.aspect, h, **texts) for h in spacings)
