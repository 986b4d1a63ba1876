"""Expected durations of the stages of a case, and its number of time steps, without a model."""

from __future__ import annotations

from math import sqrt

from mpmcol.case import Case
from mpmcol.case.geometry import whole_cells
from mpmcol.case.slope import case_slope_factor

# typical durations: transits of a wave until a column rests behind its gate, and sqrt(h_i / g) until a collapse rests
TYPICAL_TRANSITS = {"gravity": 7.0, "k0": 2.0}
TYPICAL_TAU = 5.0


def fall_time(case: Case) -> float:
    """Characteristic time sqrt(h_i / g), s."""
    return sqrt(case.geometry.h_i / case.geometry.gravity)


def stage_durations(case: Case, base: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Typical and longest durations of equilibration and collapse, s of simulated time; base: its thickness, m."""
    stages, h_i = case.stages, case.geometry.h_i
    transit, lifting = 4.0 * (h_i + base) / case.material.wave_speed, h_i / stages.gate_speed
    tau = fall_time(case)
    longest = stages.equilibrate.max_time_factor * transit, stages.collapse.max_time_factor * tau + lifting
    equilibration = TYPICAL_TRANSITS[stages.initial_stress] * transit
    collapse = TYPICAL_TAU * case_slope_factor(case) * tau + lifting
    if stages.collapse.end == "time":
        collapse = longest[1]
    return (min(equilibration, longest[0]), min(collapse, longest[1])), longest


def time_step(case: Case, h: float) -> float:
    """The time step while velocities are small, s: time.cfl h / c of the stiffest material; h: node spacing, m."""
    return case.time.cfl * h / max(material.wave_speed for material in case.materials)


def typical_duration(case: Case, h: float) -> float:
    """Typical duration of all stages, s of simulated time."""
    geometry = case.geometry
    base = 0.0 if geometry.base == "rigid" else whole_cells(geometry.base_thickness, h) * h
    return sum(stage_durations(case, base)[0])
