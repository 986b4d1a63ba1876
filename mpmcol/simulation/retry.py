"""Retry after a numerical failure: return to a valid state and halve the time step."""

from __future__ import annotations

from typing import Any

from mpmcol.mpm.kernels import loop
from mpmcol.simulation.state import Simulation

MAX_RETRIES = 4


def halve_time_step(simulation: Simulation, failure: dict[str, Any]) -> bool:
    """Return to the older valid state, before the failure began, with half the time step.

    Returns False, and changes nothing, if retries are off or exhausted, or if a smaller time step cannot help.
    """
    failed = simulation.progress
    if not simulation.retry or not failure["smaller_step_helps"] or len(failed.retries) >= MAX_RETRIES:
        return False
    cfl, seconds, state = simulation.solver.settings.cfl, simulation.recorder.seconds, simulation.valid_states[0]
    simulation.set_state(state)
    simulation.valid_states.clear()
    simulation.valid_states.append(state)
    factor = 0.5 * failed.cfl_factor
    simulation.solver.clock[loop.DT] *= factor / state.progress["cfl_factor"]  # a second retry from the same state
    record = {name: failure[name] for name in ("check", "cause", "stage", "step", "time")} | {
        "cfl": cfl,
        "new_cfl": 0.5 * cfl,
        "from_step": simulation.solver.steps,
        "from_time": simulation.solver.time,
    }
    simulation.recorder.seconds = seconds  # cost, warnings and resumptions count for the whole run
    progress = simulation.progress
    progress.cfl_factor, progress.retries = factor, [*failed.retries, record]
    progress.warnings, progress.resumed = failed.warnings, failed.resumed
    progress.wall_s, progress.cpu_s = failed.wall_s, failed.cpu_s
    simulation.notify(
        f"note: {record['cause']} at step {record['step']}, t = {record['time']:.4g} s; returning to "
        f"t = {record['from_time']:.4g} s with time.cfl = {record['new_cfl']:g} "
        f"(retry {len(progress.retries)} of at most {MAX_RETRIES})"
    )
    return True
