"""Runout and height of a column of known friction, computed on a fine grid, for fits on coarser ones."""

from __future__ import annotations

from pathlib import Path

import mpmcol
from mpmcol.studies.pareto.recommend import options
from mpmcol.studies.pareto.score import BETA, ZETA

FRICTION = "material.friction_deg"
VARIANT, CELLS, CFL = "light, 16 points per cell", 40.0, 0.38  # r_i/h; Courant number, not that of the fits
NO_ERROR = 1e-3  # relative standard error of a "measurement"


def fine_deposit(case: str, aspect: float, angle: float, out: Path) -> dict[str, tuple[float, float]]:
    """Runout and height with standard errors, corrected for the error of the fine grid in the study."""
    values = [f"geometry.aspect={aspect}", f"{FRICTION}={angle}"]
    (fine,) = (one for one in options(case, values) if (one.variant, one.cells) == (VARIANT, CELLS))
    results = mpmcol.run(mpmcol.load_case(case, [*values, *fine.overrides, f"time.cfl={CFL}"]), out, threads=1)
    measured, intervals = results.measure(), fine.intervals
    zeta, beta = intervals[ZETA].factor * measured.zeta["front_height"], intervals[BETA].factor * measured.beta
    return {"zeta": (zeta, NO_ERROR * zeta), "beta": (beta, NO_ERROR * beta)}
