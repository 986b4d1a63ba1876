"""Failures that the compiled loop detects in single points, and the `failure` object of result.json.

Checks of the whole state are in `monitor.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.boundary import OPEN_END, column_box
from mpmcol.mpm.kernels.stress_common import J_MAX, J_MIN
from mpmcol.mpm.solver import Solver
from mpmcol.setup.domain import usable

LOWER_TIME_STEP = "lower time.cfl ({limit}), or refine grid.spacing"
DEFAULT_CFL = "0.5 is the default"  # where the single-particle stability limit is not known
TIME_STEP_TOO_LARGE = "a time step beyond the stability limit of single particles, of points at a wall or near the axis"
OPENING_STRAIN = "set method.opening_strain = true"
DILATION = "sand that dilates loosens as long as it flows"
SEPARATION = "points that separate, or sand that dilates, expand without bound"
SLOW_STRAIN = 0.02  # volumetric strain of one step: waves and flow cause less, too large a time step causes more
SOFT = 0.5  # free-fall speed over wave speed above which an impact, at half of it, compresses material by a quarter
DOMAIN_TOO_SMALL = (
    "the runout exceeds that of the experiments from which the domain was sized, or geometry.domain_length is too "
    "small: of {length:.4g} m, {usable:.4g} m are usable, five cells less"
)
LENGTHENING = 1.5  # of a domain that was too short


class Failure(NamedTuple):
    """A violated condition: what was observed, the probable cause, and the remedy."""

    check: str  # name of the check
    cause: str  # what was observed
    value: float
    limit: float | None  # of the value
    likely: str  # probable cause
    remedy: str
    row: int | None = None  # of the point, if one is responsible
    position: Sequence[float] | None = None  # m, if no point is responsible
    smaller_step_helps: bool = False


def diagnose(solver: Solver, row: int, stage: str) -> dict[str, Any]:
    """The `failure` object of result.json after the compiled loop has stopped at the point in `row`."""
    return failure_record(solver, stage, identify_failure(solver, row))


def failure_record(solver: Solver, stage: str, failure: Failure, cfl_advice: str = DEFAULT_CFL) -> dict[str, Any]:
    """The `failure` object of result.json; cfl_advice: text on the largest stable time.cfl."""
    position = failure.position if failure.row is None else solver.points.x[failure.row]
    return {
        "check": failure.check,
        "cause": failure.cause,
        "likely": failure.likely,
        "stage": stage,
        "step": solver.steps,
        "time": solver.time,
        "point": None if failure.row is None else int(solver.points.id[failure.row]),
        "position": None if position is None else [float(coordinate) for coordinate in position],
        "value": float(failure.value),
        "limit": failure.limit,
        "remedy": failure.remedy.format(limit=cfl_advice),
        "smaller_step_helps": failure.smaller_step_helps,
    }


def identify_failure(solver: Solver, row: int) -> Failure:
    """The failure at which the compiled loop stopped: of the point in `row`, or of one that violates more."""
    points, free = solver.points, solver.settings.free_speed
    c2 = solver.wave_speeds2()
    with np.errstate(all="ignore"):
        speed, J = np.linalg.norm(points.v, axis=1), points.J
        limit = np.sqrt(np.maximum(c2 * J, free**2))
        finite = np.isfinite(points.x).all(axis=1) & np.isfinite(speed) & np.isfinite(J)
        excess = np.maximum(J_MIN - J, J - J_MAX)
    if not finite.all():
        return not_finite(solver, row if not finite[row] else int(np.argmin(finite)))
    if excess.max() > 0.0:
        row = row if excess[row] > 0.0 else int(excess.argmax())
        return _volume_failure(solver, row, float(J[row]), float(c2[row]))
    if (speed > limit).any():
        row = int((speed / limit).argmax())
        return _speed_failure(row, float(speed[row]), float(np.sqrt(c2[row] * J[row])), free)
    return _domain_failure(solver, row, points.x[row])


def not_finite(solver: Solver, row: int | None) -> Failure:
    """A number of the point in `row`, or of no point, is NaN or infinite."""
    bad = [name for name, is_finite in finite_fields(solver).items() if row is not None and not is_finite[row]]
    cause = "a number is not finite (NaN)" + f": {', '.join(bad)}" * bool(bad)
    return Failure(
        "finite", cause, float("nan"), None, TIME_STEP_TOO_LARGE, LOWER_TIME_STEP, row, smaller_step_helps=True
    )


def finite_fields(solver: Solver) -> dict[str, np.ndarray]:
    """Masks (n,) of the points whose values are finite, by field; unused lanes of a record are ignored."""
    points, used = solver.points, max(len(body.law.STATE) for body in solver.bodies)
    fields = {
        "mass": points.m, "volume ratio": points.J, "velocity": points.v, "position": points.x, "stress": points.sigma,
        "velocity gradient": points.grad_v, "opening strain": points.opening,
        "history of the law": points.history[:, :used],
    }  # fmt: skip
    return {name: np.isfinite(values.reshape(len(points), -1)).all(axis=1) for name, values in fields.items()}


def _volume_failure(solver: Solver, row: int, J: float, c2: float) -> Failure:
    """J is outside its limits; c2 is the squared wave speed, m2/s2."""
    expands, has_opening = J > J_MAX, solver.settings.opening_strain
    cause, limit = f"the volume ratio J is outside [{J_MIN:g}, {J_MAX:g}]", J_MAX if expands else J_MIN
    is_slow = abs(np.trace(solver.points.grad_v[row])) * solver.dt < SLOW_STRAIN
    if expands and is_slow:
        remedy = (
            "reduce dilatancy with strain (law mohr-coulomb-softening), or lower its angle or "
            "stages.collapse.max_time_factor"
        )
        likely, remedy = (DILATION, remedy) if has_opening else (SEPARATION, f"{OPENING_STRAIN}; or {remedy}")
        return Failure("volume", cause, J, limit, likely, remedy, row)
    is_soft = solver.settings.free_speed > SOFT * np.sqrt(c2)
    if not expands and (is_slow or is_soft):
        likely = f"the impact of falling material crushes this material, whose wave speed is {np.sqrt(c2):.3g} m/s"
        return Failure("volume", cause, J, limit, likely, "raise material.youngs_modulus", row)
    remedy = LOWER_TIME_STEP + ("" if has_opening else f"; or {OPENING_STRAIN}")
    return Failure("volume", cause, J, limit, TIME_STEP_TOO_LARGE, remedy, row, smaller_step_helps=True)


def _speed_failure(row: int, speed: float, wave_speed: float, free_speed: float) -> Failure:
    """The point is faster than waves and than free fall, m/s."""
    cause = f"the point is faster than waves in its material ({wave_speed:.3g} m/s)"
    cause += f" and than the limit for free fall ({free_speed:.3g} m/s)" if free_speed else ""
    remedy = LOWER_TIME_STEP + "; if the wave speed is unexpectedly low, check stiffness and density"
    return Failure(
        "speed", cause, speed, max(wave_speed, free_speed), TIME_STEP_TOO_LARGE, remedy, row, smaller_step_helps=True
    )


def _domain_failure(solver: Solver, row: int, x: np.ndarray) -> Failure:
    """The point is outside the domain."""
    box = column_box(solver.grid, solver.settings)
    if x[1] >= box.y_high:
        cause, likely = "material reached the top of the domain", "material is thrown up, or the domain is very low"
        return Failure("domain", cause, float(x[1]), box.y_high, likely, "set a larger geometry.domain_height", row)
    horizontal = np.delete(x, 1)
    farthest, cause = float(horizontal[np.argmax(np.abs(horizontal))]), "material reached the end of the domain"
    length = box.x_high + OPEN_END.stop_cells * solver.grid.h
    likely = DOMAIN_TOO_SMALL.format(length=length, usable=usable(length, solver.grid.h))
    return Failure("domain", cause, farthest, None, likely, larger_domain(length), row)


def larger_domain(length: float) -> str:
    """Advice where a domain of this length, m, was too short; the runout is unknown."""
    return f"set a larger geometry.domain_length, for example {LENGTHENING * length:.4g} m"


def failure_message(failure: dict[str, Any], retries: Sequence[dict[str, Any]] = ()) -> str:
    """The message of a failure for the user, with the retries that preceded it."""
    point, where = "", ""
    if failure["position"] is not None:
        where = ", ".join(f"{axis} = {x:.5g} m" for axis, x in zip("xyz", failure["position"], strict=False))
        point = ", at " if failure["point"] is None else f", point {failure['point']} at "
    limit = "" if failure["limit"] is None else f", limit {failure['limit']:.4g}"
    lines = [
        f"the run stopped: {failure['cause']} (value {failure['value']:.4g}{limit})",
        f"where: stage {failure['stage']}, step {failure['step']}, t = {failure['time']:.6g} s{point}{where}",
        f"likely cause: {failure['likely']}",
        f"remedy: {failure['remedy']}",
    ]
    lines += [f"tried with time.cfl = {one['cfl']:g}: {one['cause']} at t = {one['time']:.4g} s" for one in retries]
    if "last_valid" in failure:
        lines.append(
            f"saved: the last valid state (snapshot {failure['last_valid']}) and the failed one (last snapshot)"
        )
    return "\n  ".join(lines)
