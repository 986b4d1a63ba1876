"""Definition of a map: which collapses, and over which choices of method."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from mpmcol.studies.definition import DefinitionTable, Value, load_definition, shipped_definitions
from mpmcol.studies.runs import MOST_REPEATS

Values = Annotated[tuple[Value, ...], Field(min_length=1)]
Axis = Annotated[dict[str, Values], Field(min_length=1, max_length=1)]  # a key of the case and its values
Cells = Annotated[float, Field(ge=2.0, le=1000.0)]  # r_i / h


class MapCase(DefinitionTable):
    """A collapse, and the runs of its default method from which the criteria follow."""

    extends: str  # shipped case or path
    aspect: float = Field(gt=0.0)
    cells: Cells  # of all runs of the map
    finer: Cells  # of the reference
    repeats: int = Field(8, ge=3, le=MOST_REPEATS)  # runs at `cells` with different time steps, for the scatter
    finer_repeats: int = Field(3, ge=1, le=MOST_REPEATS)  # runs at `finer`, whose mean is the reference

    @model_validator(mode="after")
    def _check_spacings(self) -> MapCase:
        if self.finer <= self.cells:
            raise ValueError(f"finer is {self.finer:g}, expected more than cells, {self.cells:g}")
        return self


class Block(DefinitionTable):
    """Panels of the chart; a panel has a run for each value across and each value down."""

    case: str
    set: dict[str, Value] = Field(default_factory=dict)  # values of all runs of the block
    panels: dict[str, Values] = Field(default_factory=dict)  # a panel for each combination
    across: Axis
    down: Axis

    @model_validator(mode="after")
    def _check_keys(self) -> Block:
        keys = [*self.set, *self.panels, *self.across, *self.down]
        if twice := sorted({key for key in keys if keys.count(key) > 1}):
            raise ValueError(f"{twice[0]} is given twice")
        return self


class MapDefinition(DefinitionTable):
    """Blocks of panels, in the order in which they are drawn."""

    schema_: Literal[1] = Field(1, alias="schema")
    title: str = ""
    side_by_side: int = Field(3, ge=1, le=10)  # panels
    cases: dict[str, MapCase] = Field(min_length=1)
    blocks: dict[str, Block] = Field(min_length=1)

    @model_validator(mode="after")
    def _check_names(self) -> MapDefinition:
        for name, block in self.blocks.items():
            if block.case not in self.cases:
                raise ValueError(f"blocks.{name}: there is no case {block.case!r}")
        if unused := [name for name in self.cases if all(block.case != name for block in self.blocks.values())]:
            raise ValueError(f"cases.{unused[0]}: no block uses it")
        return self


def shipped_maps() -> dict[str, Path]:
    """Return the shipped maps by name."""
    return shipped_definitions("maps")


def load_map(source: str) -> MapDefinition:
    """Load a map: a shipped one by its name, or a file; for errors see `load_definition`."""
    return load_definition(source, shipped_maps(), "map", MapDefinition)
