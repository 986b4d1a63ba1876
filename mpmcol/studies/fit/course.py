"""Quantities of the collapse in time, from the history of a run."""

from __future__ import annotations

import numpy as np

from mpmcol.io.results import Results, measure_stop_time

TIMES = (1.0, 2.0)  # since release, in sqrt(h_i/g)
COURSE = {
    **{f"zeta_at_{time:g}": f"runout at {time:g} sqrt(h_i/g) after the release" for time in TIMES},
    **{f"beta_at_{time:g}": f"height at {time:g} sqrt(h_i/g) after the release" for time in TIMES},
    "stop_time": "time at which the front stops, in sqrt(h_i/g)",
}
COURSE_UNITS = {"stop_time": "sqrt(h_i/g)"}


def course_of(results: Results) -> dict[str, float]:
    """Quantities of the collapse in time; empty without a collapse."""
    history = results.history
    collapse, shape = history["stage"] == "collapse", results.shape
    unit = results.fall_time
    time = history["time"][collapse] / unit
    if len(time) == 0:
        return {}
    runout = (history["front_height"][collapse] - shape.r_i) / shape.r_i
    height = history["height"][collapse] / shape.h_i
    stop = measure_stop_time(history, shape.spacing, unit)
    return {
        **{f"zeta_at_{one:g}": float(np.interp(one, time, runout)) for one in TIMES},
        **{f"beta_at_{one:g}": float(np.interp(one, time, height)) for one in TIMES},
        "stop_time": float("nan") if stop is None else stop,
    }
