"""Content of result.json: measurements of the final state, errors, cost and provenance of a run."""

from __future__ import annotations

import sys
from dataclasses import asdict
from hashlib import sha256
from typing import Any

import psutil

from mpmcol.case import case_hash, conditions_of
from mpmcol.case.title import title_of
from mpmcol.experiments import profile_scores, score
from mpmcol.io.glossary import ENERGY_UNITS
from mpmcol.io.results import erosion_of, measure_snapshot, measure_stop_time
from mpmcol.io.run_status import RESULT_SCHEMA
from mpmcol.io.snapshot import Snapshot
from mpmcol.measure.wall_forces import LEAST_TRANSITS, wall_force_summary
from mpmcol.mpm.contact import friction_sums
from mpmcol.mpm.solver import Solver
from mpmcol.provenance import versions
from mpmcol.simulation.quality import columns_of, dissipation_of, stress_quality_of
from mpmcol.simulation.recorder import derived_values
from mpmcol.simulation.state import Simulation


def summarize(status: str, simulation: Simulation, final: Snapshot) -> dict[str, Any]:
    """The content of result.json for the present state.

    final: the snapshot of that state as it is stored. Its float32 values are measured, not the float64 values of the
    solver, so that `mpmcol measure`, which reads the file, gives the same numbers bit by bit.
    """
    case, model, solver = simulation.case, simulation.model, simulation.solver
    recorder, progress, geometry = simulation.recorder, simulation.progress, simulation.case.geometry
    measured, fall_time = measure_snapshot(final, recorder.shape), simulation.fall_time
    conditions = conditions_of(case)
    profiles = profile_scores(
        measured.profile_x, measured.profile_y,
        geometry.model, geometry.r_i, geometry.h_i, geometry.column_section, conditions,
    )  # fmt: skip
    scores = score(measured, geometry.a, geometry.model, geometry.column_section, conditions)
    collapse_steps = solver.steps - progress.release_step if progress.stage == "collapse" else 0
    return {
        "schema": RESULT_SCHEMA,
        "status": status,
        "title": title_of(case),
        "case_hash": case_hash(case),
        **measured.scalars(),
        "stop_time": _stop_time(simulation) if progress.at_rest else None,
        "errors": [entry.as_dict() for entry in scores],
        "profile_scores": [vars(entry) for entry in profiles],
        "at_rest": progress.at_rest,
        "time": solver.time,
        "time_over_tau": solver.time / fall_time,
        "points": len(model.points),
        **derived_values(model),
        "steps": solver.steps,
        "dt": solver.dt,
        "state_sha256": state_checksum(solver),
        "wall_s": {**progress.wall_s, "output": recorder.seconds},
        "core_seconds": progress.cpu_s,
        "ns_per_point_step": progress.wall_s["collapse"] / max(collapse_steps * len(model.points), 1) * 1e9,
        "peak_memory_bytes": peak_memory(),
        "energy_unit": ENERGY_UNITS[geometry.model][1],
        "erosion": asdict(erosion_of(final, recorder.shape)) if geometry.base == "granular" else None,
        "ledger": recorder.energy_ledger(),
        "dissipation": asdict(shares) if (shares := dissipation_of(simulation)) else None,
        "flow": recorder.flow.as_dict(),
        "flow_by_material": recorder.flow.of_others(),
        "wall_forces": _peak_forces(simulation),
        "stress": asdict(stress) if (stress := stress_quality_of(simulation, final)) else None,
        "worst_J": [float(J) for J in recorder.extreme_J],
        "threads": recorder.threads,
        "versions": versions(),
        "warnings": progress.warnings,
        "resumed": progress.resumed,
        "retries": progress.retries,
    }


def state_checksum(solver: Solver) -> str:
    """SHA-256 of points, clock, ledger and work of friction at each node of walls that have it.

    Runs that end with the same one were equal bit by bit in every step.
    """
    state = sha256()
    for array in (solver.points.rows, solver.clock, solver.ledger, friction_sums(solver.contacts)):
        state.update(array.data)
    return state.hexdigest()


def peak_memory() -> int:
    """Peak resident memory of this process, bytes, including interpreter, compiler and kernels."""
    if sys.platform == "win32":
        return int(psutil.Process().memory_info().peak_wset)
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def _stop_time(simulation: Simulation) -> float | None:
    history = columns_of(simulation.recorder.rows)
    return measure_stop_time(history, simulation.model.discretization.h, simulation.fall_time)


def _peak_forces(simulation: Simulation) -> dict[str, Any] | None:
    transit = simulation.model.discretization.h / simulation.case.material.wave_speed
    return wall_force_summary(columns_of(simulation.recorder.rows), LEAST_TRANSITS * transit, simulation.fall_time)
