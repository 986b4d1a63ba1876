"""Maps as TOML files: which collapses, and over which choices they are drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from mpmcol.studies.definition import Strict, Value, load_definition, shipped_definitions

Values = Annotated[tuple[Value, ...], Field(min_length=1)]
Axis = Annotated[dict[str, Values], Field(min_length=1, max_length=1)]  # a key of the case and its values
Cells = Annotated[float, Field(ge=2.0, le=1000.0)]  # r_i / h


class Scene(Strict):
    """A collapse, and the runs of its default method by which all others are judged."""

    case: str  # a shipped case or a path
    aspect: float = Field(gt=0.0)
    cells: Cells  # of all runs on the map
    finer: Cells  # of the reference
    repeats: int = Field(8, ge=3, le=50)  # runs at `cells`, with time steps a little apart, that tell the scatter
    finer_repeats: int = Field(3, ge=1, le=50)  # runs at `finer`, whose mean is the reference

    @model_validator(mode="after")
    def _finer(self) -> Scene:
        if self.finer <= self.cells:
            raise ValueError(f"finer is {self.finer:g}, expected more than cells, {self.cells:g}")
        return self


class Block(Strict):
    """Panels of the chart: in each, a run for every value across and every value down."""

    scene: str
    set: dict[str, Value] = Field(default_factory=dict)  # values of the case, alike in all runs of the block
    panels: dict[str, Values] = Field(default_factory=dict)  # a panel for each combination
    across: Axis
    down: Axis

    @model_validator(mode="after")
    def _keys(self) -> Block:
        keys = [*self.set, *self.panels, *self.across, *self.down]
        if twice := sorted({key for key in keys if keys.count(key) > 1}):
            raise ValueError(f"{twice[0]} is given twice")
        return self


class Map(Strict):
    """Blocks of panels, in the order in which they are drawn."""

    schema_: Literal[1] = Field(1, alias="schema")
    title: str = ""
    side_by_side: int = Field(3, ge=1, le=10)  # panels
    scenes: dict[str, Scene] = Field(min_length=1)
    blocks: dict[str, Block] = Field(min_length=1)

    @model_validator(mode="after")
    def _names(self) -> Map:
        for name, block in self.blocks.items():
            if block.scene not in self.scenes:
                raise ValueError(f"blocks.{name}: no scene is called {block.scene!r}")
        if unused := [name for name in self.scenes if all(block.scene != name for block in self.blocks.values())]:
            raise ValueError(f"scenes.{unused[0]}: no block uses it")
        return self


def shipped_maps() -> dict[str, Path]:
    """Maps that come with mpmcol, by name."""
    return shipped_definitions("maps")


def load_map(source: str) -> Map:
    """Read a map: a shipped one by its name, or a file. Raises UsageError that names file and key."""
    return load_definition(source, shipped_maps(), "map", Map)
