"""Report of `mpmcol bench --scaling`: rows, table, JSON."""

from __future__ import annotations

import json
import statistics
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from typing import Any

import numpy as np

from mpmcol.bench.report import Spread, describe_machine
from mpmcol.bench.tile_model import model_speedup, points_of_groups
from mpmcol.mpm.grid import Tiles

SCHEMA = 1
COLUMNS = (
    f"{'threads':>7}{'points':>10}  {'ns per point and step':<26}{'speed-up':>8}{'fastest':>9}{'efficiency':>12}"
    f"{'model':>8}{'groups':>8}{'tiles per group':>17}{'smallest':>10}"
)


@dataclass(frozen=True)
class ScalingRow:
    """One number of threads. Without a measurement, `step`, both speed-ups and `efficiency` are None."""

    threads: int
    n_points: int
    step: Spread | None
    speedup: float | None  # points per time over those with one thread, median of paired rounds
    fastest_speedup: float | None  # of the fastest steps, which background load affects least
    efficiency: float | None  # speed-up over threads
    model_speedup: float
    groups: int
    mean_tiles: float  # of a group
    fewest_tiles: int


@dataclass(frozen=True)
class ScalingCase:
    """Strong scaling: `points` in all; weak scaling: `points` for each thread. Both were requested."""

    model: str
    kind: str
    points: int
    rows: tuple[ScalingRow, ...]


@dataclass(frozen=True)
class ScalingReport:
    """All cases, with machine and date."""

    date: str
    machine: dict[str, Any]
    cases: tuple[ScalingCase, ...]

    def to_json(self) -> str:
        """One JSON object."""
        return json.dumps({"schema": SCHEMA, **asdict(self)}, indent=1) + "\n"


def make_scaling_report(cases: list[ScalingCase]) -> ScalingReport:
    """Report of these cases on this machine, now."""
    return ScalingReport(datetime.now(UTC).isoformat(timespec="seconds"), describe_machine(), tuple(cases))


def predicted_row(threads: int, n_points: int, tiles: Tiles) -> ScalingRow:
    """Row of the model alone."""
    groups = points_of_groups(tiles)
    sizes = [len(group) for group in groups]
    return ScalingRow(
        threads=threads,
        n_points=n_points,
        step=None,
        speedup=None,
        fastest_speedup=None,
        efficiency=None,
        model_speedup=model_speedup(tiles, threads),
        groups=len(sizes),
        mean_tiles=statistics.mean(sizes),
        fewest_tiles=min(sizes),
    )


def measured_row(threads: int, n_points: int, tiles: Tiles, times: np.ndarray, single: np.ndarray) -> ScalingRow:
    """Row of the model and of measured times (rounds, steps), ns per point; `single` are those with one thread."""
    rounds, single_rounds = np.median(times, axis=1), np.median(single, axis=1)
    speedup = float(np.median(single_rounds / rounds))
    return replace(
        predicted_row(threads, n_points, tiles),
        step=Spread.of(rounds.tolist()),
        speedup=speedup,
        fastest_speedup=float(single.min() / times.min()),
        efficiency=speedup / threads,
    )


def scaling_lines(case: ScalingCase) -> list[str]:
    """The table of one case."""
    each = "in all" if case.kind == "strong" else "for each thread"
    head = f"{case.model}, {case.kind} scaling, {case.points} points {each}: median (min-max)"
    return [head, COLUMNS, *map(_row_line, case.rows), ""]


def _row_line(row: ScalingRow) -> str:
    step = "" if row.step is None else str(row.step)
    speedup, fastest, efficiency = map(_two_digits, (row.speedup, row.fastest_speedup, row.efficiency))
    return (
        f"{row.threads:>7}{row.n_points:>10}  {step:<26}{speedup:>8}{fastest:>9}{efficiency:>12}"
        f"{row.model_speedup:>8.2f}{row.groups:>8}{row.mean_tiles:>17.1f}{row.fewest_tiles:>10}"
    )


def _two_digits(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"
