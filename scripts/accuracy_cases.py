"""Whether `mpmcol run --accuracy` holds on columns that its table was not made from.

    python scripts/accuracy_cases.py OUT [--accuracy 5%] [--count 20] [--jobs N]

Columns are drawn at random, fixed by their number: model, friction, size, aspect ratio. Each is run as advised and,
finer, as reference: the mean of two families at spacings that the table calls their finest, with their difference as
uncertainty. Prints, for each column, the errors of runout and height against that, and in how many both held. Finished
runs in OUT are kept.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.pareto.advice import Advice, advise, as_overrides, values_for
from mpmcol.pareto.settings import CFL_STEP
from mpmcol.pareto.table import QUANTITIES
from mpmcol.sweep.conduct import conduct
from mpmcol.sweep.points import Point, make_point
from mpmcol.sweep.table import make_rows
from mpmcol.units import to_unit

FINE = (("light", 56.0), ("light, nine points", 40.0))
REPEATS = 3


@dataclass(frozen=True)
class Column:
    """A case, what was advised for it, and its runs."""

    source: str
    overrides: tuple[str, ...]
    advice: Advice
    advised: Point
    references: tuple[tuple[Point, ...], ...]  # of each family


def draw(number: int, accuracy: float, out: Path) -> Column:
    """Column `number`."""
    rng = np.random.default_rng(number)
    source = ("lube-cylinder", "lube-channel")[rng.integers(2)]
    a, radius = (
        float(np.exp(rng.uniform(np.log(0.5), np.log(3.0)))),
        float(np.exp(rng.uniform(np.log(0.05), np.log(1.0)))),
    )
    friction = float(rng.uniform(22.0, 42.0))
    overrides = (
        f"geometry.aspect={a:.4g}", f"geometry.radius={radius:.4g}", f"geometry.base_thickness={0.2 * radius:.4g}",
        f"grid.spacing={radius / 20.0:.6g}", f"material.friction_deg={friction:.4g}", "output.snapshots=1",
    )  # fmt: skip
    advice = advise(source, overrides, accuracy)
    name = f"{number:02d}-{source}"
    references = tuple(
        tuple(_point(source, overrides, family, cells, i, out, name) for i in range(REPEATS)) for family, cells in FINE
    )
    advised = _point(source, overrides, advice.family, advice.cells, 0, out, name)
    return Column(source, overrides, advice, advised, references)


def _point(source: str, overrides: Sequence[str], family: str, cells: float, i: int, out: Path, name: str) -> Point:
    base = load_case(source, overrides)
    values = values_for(base, family, cells)
    asked = [*overrides, *as_overrides(values), f"time.cfl={base.time.cfl * (1.0 - CFL_STEP * i):.6g}"]
    return make_point(load_case(source, asked), out, {"cells": cells}, f"{name}-{cells:g}-{i}")


def main() -> None:
    """Draw, run, compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--accuracy", type=lambda text: to_unit(text, ""), default=0.05)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--jobs", type=int)
    words = parser.parse_args()
    columns = [draw(number, words.accuracy, words.out) for number in range(words.count)]
    points = {p.folder: p for c in columns for p in (c.advised, *(p for family in c.references for p in family))}
    outcomes = conduct(list(points.values()), words.out, words.jobs, 1)
    rows = {outcome.point.folder: row for outcome, row in zip(outcomes, make_rows(outcomes), strict=True)}
    held = sum(report(number, column, rows, words.accuracy) for number, column in enumerate(columns))
    print(f"{held} of {len(columns)} within {words.accuracy:.1%}")


def report(number: int, column: Column, rows: dict[Path, dict[str, float]], accuracy: float) -> bool:
    """Print a line for a column; whether both quantities are within the accuracy, or cannot be told from that."""
    told, held = [], True
    for quantity in QUANTITIES:
        means = [np.mean([rows[point.folder][quantity] for point in family]) for family in column.references]
        reference, unsure = float(np.mean(means)), abs(means[0] - means[1]) / (means[0] + means[1])
        error = rows[column.advised.folder][quantity] / reference - 1.0
        held &= abs(error) <= accuracy
        told.append(f"{quantity} {error:+.1%} (reference +- {unsure:.1%})")
    seconds = rows[column.advised.folder]["core_seconds"]
    place = f"{number:2d} {column.source} {', '.join((*column.overrides[:2], column.overrides[4]))}"
    cost = f"{column.advice.family}, {column.advice.cells:g}: {seconds:.1f} core-seconds{'' if held else '  MISSED'}"
    print(f"{place}; {'; '.join(told)}; {cost}", flush=True)
    return held


if __name__ == "__main__":
    main()
