"""The numbers that checks measure: functions of a finished run."""

from __future__ import annotations

import numpy as np

from mpmcol.experiments import Profile, find_experiment, profile_score
from mpmcol.measure import Array, Measurement, failure_line
from mpmcol.studies.runs import Finished
from mpmcol.studies.validation.check import Measure

RODS = find_experiment("bui-2008", "plane")
ROD = 1.6e-3  # m: diameter of the thicker rods, 1.5 to 1.6 mm; general knowledge
SURFACE, FAILURE = RODS.profiles
(SHAPE,) = find_experiment("lube-2005", "plane").profiles
STATIONS = 1001


def column_of(name: str) -> Measure:
    """A measure that is a column of a sweep's table."""
    return lambda run: run.row[name]


def undisturbed_share(run: Finished) -> float:
    """Radius of the top that has not moved, over r_i."""
    return float(run.row["undisturbed_radius"] / run.row["r_i"])


def rods_surface(run: Finished) -> float:
    """RMS distance in height between the deposit and the rods' surface, mm."""
    return rms_mm(run.results.measure(), *metres(SURFACE))


def rods_front(run: Finished) -> float | None:
    """Front where the surface is as high as the outermost digitised point, mm."""
    deposit = run.results.measure()
    score = profile_score(deposit.profile_x, deposit.profile_y, RODS)
    return None if score is None or score.front is None else 1e3 * score.front


def rods_failure(run: Finished) -> float:
    """RMS of the shortest distances from the digitised points of the failure line to ours, mm."""
    x, y = metres(FAILURE)
    return 1e3 * float(np.sqrt(np.mean(distance_to_line(x, y, *rods_failure_line(run)) ** 2)))


def rods_failure_line(run: Finished) -> tuple[Array, Array]:
    """Ours, m: beyond it points have moved by a rod's diameter and more."""
    state = run.results.snapshot()
    position, moved = (state.arrays[name][state.column][:, :2].astype(float) for name in ("position", "displacement"))
    return failure_line(position, moved, run.results.shape, ROD)


def shape_rms(run: Finished) -> float:
    """RMS distance in height to the universal shape, which is scaled to the deposit's front and height; over height."""
    deposit = run.results.measure()
    return rms_mm(deposit, *scaled_shape(deposit)) / (1e3 * deposit.height)


def scaled_shape(deposit: Measurement) -> tuple[Array, Array]:
    """The universal shape with the front and height of a deposit, m."""
    return deposit.front["front_height"] * np.array(SHAPE.x), deposit.height * np.array(SHAPE.y)


def metres(profile: Profile) -> tuple[Array, Array]:
    """Digitised points as arrays."""
    return np.array(profile.x), np.array(profile.y)


def rms_mm(deposit: Measurement, x: Array, y: Array) -> float:
    """Root mean square of `difference`, mm."""
    return 1e3 * float(np.sqrt(np.mean(difference(deposit, x, y)[1] ** 2)))


def difference(deposit: Measurement, x: Array, y: Array) -> tuple[Array, Array]:
    """Deposit minus surface (x, y), m, at even stations along the surface: how its points are spaced has no weight."""
    station = np.linspace(x[0], x[-1], STATIONS)
    ours = np.interp(station, deposit.profile_x, deposit.profile_y)  # which ends at zero
    return station, ours - np.interp(station, x, y)


def distance_to_line(x: Array, y: Array, line_x: Array, line_y: Array) -> Array:
    """Shortest distance of points (n,) to the line through points that rise in y, m."""
    height = np.linspace(line_y[0], line_y[-1], STATIONS)
    along = np.interp(height, line_y, line_x)
    return np.hypot(x[:, None] - along, y[:, None] - height).min(axis=1)
