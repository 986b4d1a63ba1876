"""The quantities that checks measure: functions of a completed run."""

from __future__ import annotations

import numpy as np

from mpmcol.experiments import Profile, find_experiment, profile_score
from mpmcol.experiments.height_difference import rms_difference
from mpmcol.measure import Array, Measurement, failure_line
from mpmcol.studies.runs import CompletedRun
from mpmcol.studies.validation.check import Measure

RODS = find_experiment("bui-2008", "plane")
ROD = 1.6e-3  # m: assumed diameter of the thicker rods, not read in the publication
SURFACE, FAILURE = RODS.profiles
SHAPE_OF = find_experiment("lube-2005", "plane")
(SHAPE,) = SHAPE_OF.profiles
LINE_POINTS = 1001  # of a failure line, to which distances are measured


def column_of(name: str) -> Measure:
    """Return the measure that is a column of the table of a sweep."""
    return lambda run: run.row[name]


def undisturbed_ratio(run: CompletedRun) -> float:
    """Return the radius of the undisturbed top over r_i."""
    return float(run.row["undisturbed_radius"] / run.row["r_i"])


def rods_surface(run: CompletedRun) -> float:
    """Return the RMS difference in height between the deposit and the surface of the rods, mm."""
    return rms_mm(run.results.measure(), *points_of(SURFACE))


def rods_front(run: CompletedRun) -> float | None:
    """Return where the surface is as high as the outermost digitised point, mm."""
    deposit = run.results.measure()
    score = profile_score(deposit.profile_x, deposit.profile_y, RODS)
    return None if score is None or score.front is None else 1e3 * score.front


def rods_failure(run: CompletedRun) -> float:
    """Return the RMS of the shortest distances from the digitised failure line to the computed one, mm."""
    x, y = points_of(FAILURE)
    return 1e3 * float(np.sqrt(np.mean(distance_to_line(x, y, *rods_failure_line(run)) ** 2)))


def rods_failure_line(run: CompletedRun) -> tuple[Array, Array]:
    """Return the computed failure line, m: points beyond it have moved by the diameter of a rod or more."""
    state = run.results.snapshot()
    position, moved = (state.arrays[name][state.column][:, :2].astype(float) for name in ("position", "displacement"))
    return failure_line(position, moved, run.results.shape, ROD)


def shape_rms(run: CompletedRun) -> float:
    """Return the RMS difference in height from the universal shape, scaled to the deposit, over the height."""
    deposit = run.results.measure()
    return rms_mm(deposit, *scaled_shape(deposit)) / (1e3 * deposit.height)


def scaled_shape(deposit: Measurement) -> tuple[Array, Array]:
    """Return the universal shape with the front and height of a deposit, m."""
    return deposit.front["front_height"] * np.array(SHAPE.x), deposit.height * np.array(SHAPE.y)


def points_of(profile: Profile) -> tuple[Array, Array]:
    """Return the digitised points of a profile as arrays."""
    return np.array(profile.x), np.array(profile.y)


def rms_mm(deposit: Measurement, x: Array, y: Array) -> float:
    """Return the root mean square difference in height between a deposit and a surface, mm."""
    return 1e3 * rms_difference(deposit.profile, (x, y))


def distance_to_line(x: Array, y: Array, line_x: Array, line_y: Array) -> Array:
    """Return the shortest distances of points (n,) to the line through points in order of increasing y, m."""
    height = np.linspace(line_y[0], line_y[-1], LINE_POINTS)
    along = np.interp(height, line_y, line_x)
    return np.hypot(x[:, None] - along, y[:, None] - height).min(axis=1)
