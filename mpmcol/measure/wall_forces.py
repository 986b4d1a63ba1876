"""Forces on walls at release and at the end, and the largest ones, from the history of a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

AXES = ("x", "y", "z")
LEAST_TRANSITS = 5.0  # h / c, shortest time over which a force is averaged: shorter peaks are elastic waves of a cell

SUSTAINED_WINDOW = 0.2  # sqrt(h_i / g), over which the mean of an impact hardly depends on the spacing


def column(wall: str, axis: str) -> str:
    """Column of the history with the component of the force on a wall along an axis."""
    return f"force.{wall}.{axis}"


def moment_column(wall: str) -> str:
    """Column of the history with the moment on a wall about its foot."""
    return f"moment.{wall}"


def peak_forces(history: Mapping[str, np.ndarray], window: float) -> dict[str, Any] | None:
    """The force on each wall at release and at the end, and the largest one; None without forces.

    Also None if the history after the release is shorter than the window.

    history: columns of history.csv; forces are means since the previous row. window: least time over which a force is
    averaged, s. Returns, by wall, magnitudes of the resultant (N, per metre or radian in two dimensions): "at_release",
    "peak", with "time", the end of its averaging (s), and "window", its duration (s), and "at_end"; and of a wall with
    a foot "moment_at_release", "moment", the largest mean over the window, and "moment_at_end" (N m).
    """
    walls = dict.fromkeys(name.split(".")[1] for name in history if name.startswith("force."))
    if not walls:
        return None
    rows = history["stage"] != "equilibrate"
    time = history["time"][rows]
    first = np.searchsorted(time, time - window, side="right") - 1  # row at which the averaging begins
    last = np.flatnonzero(first >= 0)
    if not len(last):
        return None
    first, duration, peaks = first[last], time[last] - time[first[last]], {}
    for wall in walls:
        names = [column(wall, axis) for axis in AXES if column(wall, axis) in history]
        force = np.array([history[name][rows] for name in names])
        impulse = np.cumsum(force * np.diff(time, prepend=time[0]), axis=1)
        mean = np.linalg.norm(impulse[:, last] - impulse[:, first], axis=0) / duration
        at_release, at_end = np.linalg.norm(force[:, [0, -1]], axis=0)
        k = int(mean.argmax())
        peaks[wall] = {
            "at_release": float(at_release),
            "peak": float(mean[k]),
            "time": float(time[last[k]]),
            "window": float(duration[k]),
            "at_end": float(at_end),
            **_moments(history, wall, rows, last, first, duration),
        }
    return peaks


def wall_force_summary(history: Mapping[str, np.ndarray], window: float, fall_time: float) -> dict[str, Any] | None:
    """`peak_forces`, and as "sustained" the largest mean force over SUSTAINED_WINDOW; None if the flow is shorter.

    fall_time: sqrt(h_i / g), s.
    """
    peaks = peak_forces(history, window)
    sustained = peak_forces(history, SUSTAINED_WINDOW * fall_time) or {}
    return peaks and {
        wall: peak | {"sustained": sustained[wall]["peak"] if wall in sustained else None}
        for wall, peak in peaks.items()
    }


def _moments(
    history: Mapping[str, np.ndarray], wall: str, rows: np.ndarray, last: np.ndarray, first: np.ndarray, duration: Any
) -> dict[str, float]:
    """The moment at release, its largest mean over the window, and the last; nothing for a wall without a foot."""
    if (name := moment_column(wall)) not in history:
        return {}
    moment, time = history[name][rows], history["time"][rows]
    impulse = np.cumsum(moment * np.diff(time, prepend=time[0]))
    return {
        "moment_at_release": float(moment[0]),
        "moment": float(((impulse[last] - impulse[first]) / duration).max()),
        "moment_at_end": float(moment[-1]),
    }
