"""A measured snapshot of a run with its errors, as `mpmcol measure` prints it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpmcol.api.arguments import Notify, as_results, warn
from mpmcol.case import conditions_of
from mpmcol.errors import OutputError
from mpmcol.experiments import ProfileScore, Score, profile_scores, score
from mpmcol.io.glossary import ENERGY_UNITS
from mpmcol.io.names import HISTORY_FILE
from mpmcol.io.results import Results, erosion_of, measure_stop_time, surface_of
from mpmcol.measure import STEEPEST, Array, ColumnShape, Erosion, Measurement, friction_from_repose


@dataclass(frozen=True)
class Measured:
    """A measured snapshot of a run, and its errors relative to published laws and profiles."""

    status: str  # of the run: "done" | "failed" | "stopped" | "unfinished"
    at_rest: bool  # whether the run ended with the column at rest
    stage: str
    time: float  # s since release
    is_last: bool  # whether the snapshot is the last one
    measurement: Measurement
    shape: ColumnShape
    stop_time: float | None  # sqrt(h_i / g); None unless it is the final deposit
    energy_released: float | None  # in `energy_unit`; None unless it is the last snapshot of a run with a result
    energy_unit: str  # in words
    wall_forces: dict[str, dict[str, Any]] | None  # by wall, as in result.json; None as above, or if not recorded
    scores: list[Score]
    profiles: list[ProfileScore]
    erosion: Erosion | None  # of a granular bed; None without one
    surface_over_bed: tuple[Array, Array] | None  # bin centres and heights, (bins,), m; see `measure.surface_over_bed`

    @property
    def is_deposit(self) -> bool:
        """Whether this is the final deposit, as opposed to a state during the collapse."""
        return self.at_rest and self.is_last

    @property
    def friction_from_repose(self) -> float | None:
        """Friction angle that the angle of repose corresponds to, with the bias of `friction_bias`, degrees.

        Of the final deposit of a plane column, whose surface is inclined by less than 45 degrees; otherwise None.
        """
        angle = self.measurement.repose_angle_deg
        if angle is None or not self.is_deposit or self.shape.model != "plane":
            return None
        horizontal = angle + self.shape.slope_deg
        return friction_from_repose(horizontal) if 0.0 < horizontal < STEEPEST else None


def measure(run: Results | Path | str, snapshot: int = -1, *, notify: Notify = warn) -> Measured:
    """Measure a snapshot of a run: fronts, height, profile, and their errors relative to published laws.

    Args:
        run: the results of a run, or their folder.
        snapshot: index of the snapshot; -1 is the last.
        notify: receives a message if the history cannot be read and the stop time is omitted (default: a warning).

    Raises:
        UsageError: there is no such snapshot.
        OutputError: the folder holds no run, or a file in it is damaged.
    """
    results = as_results(run)
    taken, shape, measurement = results.snapshot(snapshot), results.shape, results.measure(snapshot)
    is_last = snapshot in (-1, len(results.snapshots) - 1)
    stop = _stop_time(results, notify) if results.came_to_rest and is_last else None
    conditions = conditions_of(results.case)
    values: dict[str, Any] = {"zeta": measurement.zeta, "beta": measurement.beta}
    values |= {} if stop is None else {"stop_time": stop}
    return Measured(
        status=results.status,
        at_rest=results.came_to_rest,
        stage=taken.stage,
        time=taken.time,
        is_last=is_last,
        measurement=measurement,
        shape=shape,
        stop_time=stop,
        energy_released=(_of_result(results, "dissipation") or {}).get("released") if is_last else None,
        energy_unit=ENERGY_UNITS[shape.model][1],
        wall_forces=_of_result(results, "wall_forces") if is_last else None,
        scores=score(values, shape.a, shape.model, shape.section, conditions),
        profiles=profile_scores(
            measurement.profile_x,
            measurement.profile_y,
            shape.model,
            shape.r_i,
            shape.h_i,
            shape.section,
            conditions,
        ),
        erosion=None if shape.bed_density is None else erosion_of(taken, shape),
        surface_over_bed=surface_of(taken, shape),
    )


def _of_result(results: Results, name: str) -> Any:
    """An entry of result.json; None without one, or before the end of the run."""
    return results.summary.get(name) if results.status != "unfinished" else None


def _stop_time(results: Results, notify: Notify) -> float | None:
    """Time at which the front stops, in sqrt(h_i / g); None, with a note, if the history cannot be read."""
    try:
        history = results.history
    except OutputError:
        history = {}
    if not len(history.get("time", ())):
        path = results.folder / HISTORY_FILE
        problem = "is damaged: rows or columns are missing or truncated" if path.exists() else "is missing"
        notify(f"note: {path} {problem}; the stop time of the front is omitted")
        return None
    return measure_stop_time(history, results.shape.spacing, results.fall_time)
