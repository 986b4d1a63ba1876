"""What went wrong in a run that had to stop: the `failure` object of its result, and the words for a person."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.kernels.particle_update import column_box
from mpmcol.mpm.kernels.stress_common import J_MAX, J_MIN
from mpmcol.mpm.particles import COLUMN
from mpmcol.mpm.solver import Solver

TIME_STEP = "lower time.cfl ({limit}), or refine grid.spacing"
UNKNOWN = "0.5 is the default"  # where no case says what a lone point bears
TOO_LONG = "a time step too long for points that are alone, by a wall or near the axis"
OPEN = "set method.opening_strain = true"
LOOSENS = "sand that dilates loosens for as long as it flows"
PULLED_APART = "points that are pulled apart, or sand that dilates, swell without end"
SLOW = 0.02  # volumetric strain of a step that waves and flow make; what a step too long makes is larger
SOFT = 0.5  # free speed over that of waves, from which a fall, half as fast, shortens material by a quarter and more
TOO_SMALL = "the flow goes farther than the experiments that the domain was sized by, or than the case allows for"


class Fault(NamedTuple):
    """Something that must not be: what was seen, what it probably comes from, and how to mend it."""

    check: str  # name
    cause: str  # what was seen
    value: float
    limit: float | None  # that the value must keep to
    likely: str
    remedy: str
    row: int | None = None  # of the point, if one is to blame
    position: Sequence[float] | None = None  # m; that of the point where there is one
    smaller_step_helps: bool = False


def diagnose(solver: Solver, row: int, stage: str) -> dict[str, Any]:
    """The `failure` object of result.json for the point in `row`, at which the compiled loop stopped."""
    return describe(solver, stage, fault_of(solver, row))


def describe(solver: Solver, stage: str, fault: Fault, limit: str = UNKNOWN) -> dict[str, Any]:
    """The `failure` object of result.json; limit: of the time step, in words."""
    place = fault.position if fault.row is None else solver.points.x[fault.row]
    return {
        "check": fault.check,
        "cause": fault.cause,
        "likely": fault.likely,
        "stage": stage,
        "step": solver.steps,
        "time": solver.time,
        "point": None if fault.row is None else int(solver.points.id[fault.row]),
        "position": None if place is None else [float(c) for c in place],
        "value": float(fault.value),
        "limit": fault.limit,
        "remedy": fault.remedy.format(limit=limit),
        "smaller_step_helps": fault.smaller_step_helps,
    }


def fault_of(solver: Solver, row: int) -> Fault:
    """What is wrong where the compiled loop stopped at a point: the most telling of all points, this one if it is."""
    points, free = solver.points, solver.settings.free_speed
    c2 = np.array([body.wave_speed2 for body in solver.bodies])[points.kind.astype(np.intp)]
    with np.errstate(all="ignore"):
        speed, J = np.linalg.norm(points.v, axis=1), points.J
        limit = np.sqrt(np.maximum(c2 * J, free**2))
        finite = np.isfinite(points.x).all(axis=1) & np.isfinite(speed) & np.isfinite(J)
        beyond = np.maximum(J_MIN - J, J - J_MAX)
    if not finite.all():
        return not_finite(solver, row if not finite[row] else int(np.argmin(finite)))
    if beyond.max() > 0.0:
        row = row if beyond[row] > 0.0 else int(beyond.argmax())
        return _volume(solver, row, float(J[row]), float(c2[row]))
    if (speed > limit).any():
        row = int((speed / limit).argmax())
        return _too_fast(row, float(speed[row]), float(np.sqrt(c2[row] * J[row])), free)
    return _outside(solver, row, points.x[row])


def not_finite(solver: Solver, row: int | None) -> Fault:
    """A point with a number that is none."""
    bad = [name for name, sound in finite_fields(solver).items() if row is not None and not sound[row]]
    cause = "a number became not finite (NaN)" + f": {', '.join(bad)}" * bool(bad)
    return Fault("finite", cause, float("nan"), None, TOO_LONG, TIME_STEP, row, smaller_step_helps=True)


def finite_fields(solver: Solver) -> dict[str, np.ndarray]:
    """Where the numbers of a point are such (n,), by name; lanes that are not used may hold anything."""
    points, used = solver.points, len(solver.bodies[COLUMN].law.STATE)
    fields = {
        "mass": points.m, "volume ratio": points.J, "velocity": points.v, "position": points.x, "stress": points.sigma,
        "velocity gradient": points.grad_v, "opening strain": points.opening,
        "history of the law": points.history[:, :used],
    }  # fmt: skip
    return {name: np.isfinite(values.reshape(len(points), -1)).all(axis=1) for name, values in fields.items()}


def _volume(solver: Solver, row: int, J: float, c2: float) -> Fault:
    swells, opens = J > J_MAX, solver.settings.opening_strain
    cause, limit = f"the volume ratio J left [{J_MIN:g}, {J_MAX:g}]", J_MAX if swells else J_MIN
    slow = abs(np.trace(solver.points.grad_v[row])) * solver.dt < SLOW
    if swells and slow:
        remedy = (
            "let dilatancy fade (law mohr-coulomb-softening), or lower its angle or stages.collapse.max_time_factor"
        )
        likely, remedy = (LOOSENS, remedy) if opens else (PULLED_APART, f"{OPEN}; or {remedy}")
        return Fault("volume", cause, J, limit, likely, remedy, row)
    soft = solver.settings.free_speed > SOFT * np.sqrt(c2)
    if not swells and (slow or soft):
        likely = f"what falls here crushes its material, in which waves run at {np.sqrt(c2):.3g} m/s"
        return Fault("volume", cause, J, limit, likely, "raise material.youngs_modulus", row)
    remedy = TIME_STEP + ("" if opens else f"; or {OPEN}")
    return Fault("volume", cause, J, limit, TOO_LONG, remedy, row, smaller_step_helps=True)


def _too_fast(row: int, speed: float, waves: float, free: float) -> Fault:
    cause = f"the point is faster than waves in its material ({waves:.3g} m/s)"
    cause += f" and than gravity can make it ({free:.3g} m/s)" if free else ""
    remedy = TIME_STEP + "; if that is slow for the material, check its stiffness and density"
    return Fault("speed", cause, speed, max(waves, free), TOO_LONG, remedy, row, smaller_step_helps=True)


def _outside(solver: Solver, row: int, x: np.ndarray) -> Fault:
    box = column_box(solver.grid, solver.settings)
    if x[1] >= box.y_high:
        cause, likely = "material reached the top of the domain", "something throws it up, or the domain is very low"
        return Fault("domain", cause, float(x[1]), box.y_high, likely, "set a larger geometry.domain_height", row)
    horizontal = np.delete(x, 1)
    farthest, cause = float(horizontal[np.argmax(np.abs(horizontal))]), "material reached the end of the domain"
    return Fault("domain", cause, farthest, None, TOO_SMALL, "set a larger geometry.domain_length", row)


def message(failure: dict[str, Any], retries: Sequence[dict[str, Any]] = ()) -> str:
    """The failure as a person reads it, with what was tried before the run was given up."""
    point, where = "", ""
    if failure["position"] is not None:
        where = ", ".join(f"{axis} = {x:.5g} m" for axis, x in zip("xyz", failure["position"], strict=False))
        point = ", at " if failure["point"] is None else f", point {failure['point']} at "
    limit = "" if failure["limit"] is None else f", limit {failure['limit']:.4g}"
    tried = [f"time.cfl = {one['cfl']:g}: {one['cause']} at t = {one['time']:.4g} s" for one in retries]
    kept = (
        f"kept: the last good state, snapshot {failure.get('last_valid')}, and the one it stopped in, the last snapshot"
    )
    return "\n  ".join(
        [
            f"the run stopped: {failure['cause']} (value {failure['value']:.4g}{limit})",
            f"where: stage {failure['stage']}, step {failure['step']}, t = {failure['time']:.6g} s{point}{where}",
            f"likely cause: {failure['likely']}",
            f"remedy: {failure['remedy']}",
            *(f"tried before, {one}" for one in tried),
            *([kept] if "last_valid" in failure else []),
        ]
    )
