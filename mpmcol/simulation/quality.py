"""Notes on the quality of a finished collapse: dissipation by numerics, noise of the stresses, locking."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from mpmcol.case.slope import endless_flow
from mpmcol.io.results import erosion_of
from mpmcol.io.snapshot import Snapshot
from mpmcol.measure.dissipation import Dissipation, dissipation
from mpmcol.measure.stress import StressQuality, stress_quality
from mpmcol.simulation.state import Simulation
from mpmcol.units import length_text

MEASURED = ("position", "stress", "mass", "volume")
LEAST_RELEASED = 1e-3  # of m g h_i: a column that released less has not moved
MOST_DAMPING = 2.0  # times that of a smooth flow
MOST_NUMERICAL = 0.1  # share of the released energy
MOST_STRESS_FREE, HIGHEST_PRESSURE = 0.1, 2.0  # share of the points; multiple of the weight at the foot
LOCKED = -0.5, 1.5  # percentiles 1 and 99 of the pressure over that weight, of material that bears tension


def columns_of(rows: Sequence[Mapping[str, Any]]) -> dict[str, np.ndarray]:
    """Columns of a history from its rows; before the first row only that of the stages."""
    return {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {"stage": np.array([])}


def dissipation_of(simulation: Simulation) -> Dissipation | None:
    """Shares of the energy released so far; None before the release."""
    return dissipation(columns_of(simulation.recorder.rows), simulation.case.stages.collapse.damping)


def stress_quality_of(simulation: Simulation, snapshot: Snapshot) -> StressQuality | None:
    """Quality of the stresses of the column in a snapshot."""
    arrays = {name: snapshot.arrays[name][snapshot.column].astype(np.float64) for name in MEASURED}
    valid = np.isfinite(np.column_stack(list(arrays.values()))).all(axis=1)  # after a failure some may not be
    x, stress, mass, volume = (values[valid] for values in arrays.values())
    shape = simulation.recorder.shape
    return stress_quality(x[:, : shape.dimension], stress, mass, volume, shape, simulation.case.geometry.normal_gravity)


def quality_notes(simulation: Simulation) -> Iterator[str]:
    """What a user must know of the energies of a collapse, and of the stresses if it is at rest."""
    is_filtered = simulation.case.method.stress_filter != "none"
    model, gravity = simulation.model, simulation.case.geometry.gravity
    least = LEAST_RELEASED * model.column_mass * gravity * model.discretization.h_i
    if (shares := dissipation_of(simulation)) and shares.released > least:
        yield from _dissipation_notes(shares, is_filtered)
    yield from simulation.recorder.flow.notes()
    if simulation.progress.at_rest:
        yield from _wall_notes(simulation)
    if simulation.case.geometry.base == "granular":
        yield from _erosion_notes(simulation)
    if simulation.progress.at_rest and (quality := stress_quality_of(simulation, _present(simulation))):
        yield from _stress_notes(quality, is_filtered)


def _present(simulation: Simulation) -> Snapshot:
    solver = simulation.solver
    return simulation.recorder.snapshot_of(solver.points, solver.time, solver.steps, "rest")


def _wall_notes(simulation: Simulation) -> Iterator[str]:
    shape, front = simulation.recorder.shape, simulation.recorder.rows[-1]["front_height"]
    for name, wall in zip((wall.name for wall in simulation.case.walls), shape.obstacles, strict=True):
        if shape.r_i <= wall.low_x <= front + shape.spacing and front <= wall.high_x:
            yield f"the deposit ends at the wall {name}: runout and angle of repose depend on it"


def _erosion_notes(simulation: Simulation) -> Iterator[str]:
    shape = simulation.recorder.shape
    if erosion_of(_present(simulation), shape).reaches_floor(shape):
        cause = endless_flow(simulation.case) or "set a larger geometry.base_thickness"
        yield f"the bed has moved down to the floor, over its thickness of {length_text(shape.bed)}: {cause}"


def _dissipation_notes(shares: Dissipation, is_filtered: bool) -> Iterator[str]:
    if shares.damping_ratio > MOST_DAMPING:
        remedy = "lower stages.collapse.damping" if is_filtered else 'set method.stress_filter = "flow"'
        yield (
            f"local damping took {100.0 * shares.damping:.1f} % of the released energy, {shares.damping_ratio:.1f} "
            f"times what it takes from a smooth flow: it acts on noise of the nodal forces; {remedy}"
        )
    if shares.numerical > MOST_NUMERICAL:
        yield (
            f"transfer and walls took {100.0 * (shares.transfer + shares.walls):.1f} % of the released energy and the "
            f"stress filter {100.0 * shares.filter:.1f} %: use a smaller grid.spacing"
        )


def _stress_notes(quality: StressQuality, is_filtered: bool) -> Iterator[str]:
    lowest, highest = LOCKED
    remedy = "use averages over several cells" if is_filtered else 'set method.stress_filter = "flow"'
    if quality.stress_free > MOST_STRESS_FREE or quality.pressure_max > HIGHEST_PRESSURE:
        yield (
            f"the stresses of single points are noise: {100.0 * quality.stress_free:.0f} % of the points inside the "
            f"deposit are stress-free, and the largest pressure is {quality.pressure_max:.1f} times the weight at its "
            f"foot; {remedy}"
        )
    if quality.pressure_p1 < lowest and quality.pressure_p99 > highest:
        yield (
            f"volumetric locking: 98 % of the pressures are between {quality.pressure_p1:.1f} and "
            f"{quality.pressure_p99:.1f} times the weight at the foot; {remedy}"
        )
