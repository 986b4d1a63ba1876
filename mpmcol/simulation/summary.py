"""result.json: what came of a run, measured and scored."""

from __future__ import annotations

from hashlib import sha256
from typing import Any

import numpy as np

from mpmcol.case import Case, case_hash
from mpmcol.experiments import profile_scores, score
from mpmcol.io.results import RESULT_SCHEMA, Results, measure_snapshot
from mpmcol.measure import stop_time
from mpmcol.mpm.solver import Solver
from mpmcol.provenance import versions
from mpmcol.setup.model import Model
from mpmcol.simulation.memory import peak_memory
from mpmcol.simulation.progress import Course
from mpmcol.simulation.recorder import Recorder, describe


def outcome(status: str, case: Case, model: Model, recorder: Recorder, course: Course, threads: int) -> dict[str, Any]:
    """The content of result.json for the present state, of which the last snapshot must have been taken."""
    solver, discretization, geometry = recorder.solver, model.discretization, case.geometry
    measured = measure_snapshot(Results(recorder.folder).snapshot(), recorder.shape)
    profiles = profile_scores(
        measured.profile_x, measured.profile_y, geometry.model, geometry.r_i, geometry.h_i, geometry.section
    )
    tau = discretization.fall_time(geometry.gravity)
    flow_steps = solver.steps - course.first_step if course.stage == "collapse" else 0
    return {
        "schema": RESULT_SCHEMA,
        "status": status,
        "title": case.title,
        "case_hash": case_hash(case),
        **measured.scalars(),
        "stop_time": _stop_time(recorder, discretization.h, tau) if course.at_rest else None,
        "errors": [entry.as_dict() for entry in score(measured, geometry.a, geometry.model, geometry.section)],
        "profile_scores": [vars(entry) for entry in profiles],
        "at_rest": course.at_rest,
        "time": solver.time,
        "time_over_tau": solver.time / tau,
        "points": len(model.points),
        **describe(model),
        "steps": solver.steps,
        "dt": solver.dt,
        "state_sha256": _fingerprint(solver),
        "wall_s": {**course.wall_s, "output": recorder.seconds},
        "core_seconds": course.cpu_s,
        "ns_per_point_step": course.wall_s["collapse"] / max(flow_steps * len(model.points), 1) * 1e9,
        "peak_memory_bytes": peak_memory(),
        "ledger": recorder.energy_ledger(),
        "worst_J": [float(J) for J in recorder.worst_J],
        "threads": threads,
        "versions": versions(),
        "warnings": course.warnings,
        "resumed": course.resumed,
        "retries": course.retries,
    }


def _fingerprint(solver: Solver) -> str:
    """Digest of every bit of points, clock and ledger: two runs of one digest went alike, step by step."""
    state = sha256()
    for array in (solver.points.rows, solver.clock, solver.ledger):
        state.update(array.data)
    return state.hexdigest()


def _stop_time(recorder: Recorder, h: float, tau: float) -> float | None:
    """When the front of a column at rest came within a cell of its end, in tau."""
    flow = [row for row in recorder.rows if row["stage"] == "collapse"]
    time, front = (np.array([row[name] for row in flow]) for name in ("time", "front_height"))
    stop = stop_time(time, front, h)
    return None if stop is None else stop / tau
