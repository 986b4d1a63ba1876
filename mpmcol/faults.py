"""Why a point went wrong, in words: cause, value and remedy for a run that had to stop."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.kernels.stress import J_MAX, J_MIN
from mpmcol.kernels.update import column_box
from mpmcol.solver import Solver

TIME_STEP = "lower time.cfl ({limit}), or refine grid.spacing"
UNKNOWN = "0.5 is the default"  # where no case says what a lone point bears


def diagnose(solver: Solver, row: int, stage: str, limit: str = UNKNOWN) -> dict[str, Any]:
    """The `failure` object of result.json for the point in `row`; limit: of the time step, in words."""
    points = solver.points
    x, v, J = points.x[row], points.v[row], float(points.J[row])
    c2 = solver.bodies[int(points.kind[row])].wave_speed2
    cause, value, remedy = _cause(solver, x, v, J, c2)
    return {
        "cause": cause,
        "stage": stage,
        "step": solver.steps,
        "time": solver.time,
        "point": int(points.id[row]),
        "position": [float(c) for c in x],
        "value": value,
        "remedy": remedy.format(limit=limit),
    }


def _cause(solver: Solver, x: np.ndarray, v: np.ndarray, J: float, c2: float) -> tuple[str, float, str]:
    """Cause, the number that shows it, and what to do, most telling first."""
    speed, grid = float(np.linalg.norm(v)), solver.grid
    if not np.isfinite([*x, speed, J]).all():
        return "a number became not finite (NaN)", speed, TIME_STEP
    free = solver.settings.free_speed
    if not J_MIN <= J <= J_MAX:
        remedy = TIME_STEP + ("" if solver.settings.opening_strain else "; or set method.opening_strain = true")
        if free**2 > c2:  # what lands that fast is squeezed as far as that by no fault of the method
            remedy = (
                f"raise material.youngs_modulus: waves at {np.sqrt(c2):.3g} m/s are slow for this fall; or {remedy}"
            )
        return f"the volume ratio J left [{J_MIN:g}, {J_MAX:g}]", J, remedy
    if speed**2 > max(c2 * J, free**2):
        cause = f"the point is faster than waves in its material ({np.sqrt(c2 * J):.3g} m/s)"
        cause += f" and than gravity can make it ({free:.3g} m/s)" if free else ""
        return cause, speed, TIME_STEP + "; if that is slow for the material, check its stiffness and density"
    if x[1] >= column_box(grid, solver.settings).y_high:
        return "material reached the top of the domain", float(x[1]), "set a larger geometry.domain_height"
    horizontal = np.delete(x, 1)
    farthest = float(horizontal[np.argmax(np.abs(horizontal))])
    return "material reached the end of the domain", farthest, "set a larger geometry.domain_length"


def message(failure: dict[str, Any]) -> str:
    """The failure as a person reads it."""
    place = ", ".join(f"{axis} = {x:.5g} m" for axis, x in zip("xyz", failure["position"], strict=False))
    return (
        f"the run stopped: {failure['cause']} (value {failure['value']:.4g})\n"
        f"  where: stage {failure['stage']}, step {failure['step']}, t = {failure['time']:.6g} s, "
        f"point {failure['point']} at {place}\n"
        f"  remedy: {failure['remedy']}\n"
        "  everything written up to here is readable, the last state as the last snapshot"
    )
