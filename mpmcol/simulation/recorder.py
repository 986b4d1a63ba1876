"""Output during a run: rows of the history, and snapshots with their index."""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import cached_property
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import Case, resolved_toml
from mpmcol.io.atomic import atomic_write, make_folder, remove
from mpmcol.io.checksums import checksum_of
from mpmcol.io.names import CASE_FILE, INDEX_FILES, RESUMED_AT
from mpmcol.io.run_folder import write_history
from mpmcol.io.snapshot import (
    Snapshot,
    as_stored,
    describe_snapshot,
    list_snapshots,
    step_of,
    write_index,
    write_snapshot,
)
from mpmcol.io.vtkhdf import Step
from mpmcol.measure import fronts_and_height
from mpmcol.measure.stress import pressure_and_shear
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.particles import BASE, Points
from mpmcol.mpm.solver import Solver
from mpmcol.provenance import versions
from mpmcol.setup.column_shape import column_shape
from mpmcol.setup.model import Model
from mpmcol.simulation.derived import derived_quantities, history_of_laws
from mpmcol.simulation.energy import Energies, energy_ledger, stored_energies
from mpmcol.simulation.flow_regime import FlowHistogram
from mpmcol.simulation.wall_forces import WallForces

WRITE_INTERVAL = 5.0  # s of wall-clock time between two writings of history.csv, and of the index of snapshots


class Recorder:
    """Writes history and snapshots of a run to its folder; `seconds` is the wall-clock time spent on it.

    Nothing is written before `open`. `start_ledger` must precede the first row.
    """

    def __init__(self, case: Case, model: Model, solver: Solver, folder: Path, threads: int) -> None:
        self.case, self.model, self.solver = case, model, solver
        self.folder, self.threads = folder, threads
        self.shape = column_shape(case, model.discretization)
        walls = [wall.name for wall in model.discretization.walls] if case.output.wall_forces else []
        self.forces = WallForces(model, walls)
        self.flow = FlowHistogram(case)
        self.rows: list[dict[str, Any]] = []
        self.seconds = 0.0
        self.extreme_J = [1.0, 1.0]  # smallest and largest volume ratio so far
        self.checksums: dict[str, str] = {}  # of the snapshots, by file name in the folder
        self._written: list[Step] = []
        self._history_written, self._index_written = time.monotonic(), -inf

    def open(self, resumed_at: float = 0.0) -> None:
        """Create the folder and write the resolved case to it, with the time of a resumption. Raises OutputError."""
        make_folder(self.folder)
        derived: dict[str, Any] = {
            "points": len(self.model.points),
            "threads": self.threads,
            **derived_values(self.model),
            **versions(),
            **({RESUMED_AT: resumed_at} if resumed_at > 0.0 else {}),
        }
        atomic_write(self.folder / CASE_FILE, resolved_toml(self.case, derived).encode())

    def start_ledger(self) -> None:
        """Start the energy ledger and the displacements at the present state."""
        points = self.solver.points
        self.initial_positions = positions_by_id(points)
        self.solver.ledger[:] = 0.0
        self.solver.contacts.sums[:] = 0.0
        self.forces.start(self.solver.time)
        self.initial_energies: Energies = stored_energies(self.case, points)

    def energy_ledger(self) -> Energies:
        """Energies and work since `start_ledger`, J."""
        return energy_ledger(self.case, self.solver, self.initial_energies)

    def record(self, stage: str) -> None:
        """Add the present state as a row of the history."""
        started = time.perf_counter()
        points, solver = self.solver.points, self.solver
        column = (points.kind != BASE) & np.isfinite(sum(points.x.T))  # after a failure some may not be finite
        mass = self.shape.uniform_mass(points.m[column], points.kind[column].astype(np.intp))
        front, height = fronts_and_height(points.x[column], mass, self.shape)
        J_min, J_max = points.J.min(), points.J.max()
        self.extreme_J = [min(self.extreme_J[0], J_min), max(self.extreme_J[1], J_max)]
        row: dict[str, Any] = {
            "stage": stage,
            "step": solver.steps,
            "time": solver.clock[loop.TIME],
            "dt": solver.clock[loop.DT],
            **self.energy_ledger(),
            **front,
            "height": height,
            "J_min": J_min,
            "J_max": J_max,
            "open_points": int(np.sum(points.opening > 0.0)),
            "grid_kinetic": solver.ledger[loop.L_KINETIC],
            "unbalanced": solver.ledger[loop.L_UNBALANCED],
            **self.forces.columns(solver.time),
        }
        self.rows.append(row)
        if stage == "collapse":
            self.flow.add(points)
        if time.monotonic() - self._history_written > WRITE_INTERVAL:
            self._write_history()
        self.seconds += time.perf_counter() - started

    def write_snapshot(self, stage: str) -> Snapshot:
        """Write the present state as the next snapshot; return it as it is stored. Raises OutputError."""
        started, solver = time.perf_counter(), self.solver
        snapshot = self.snapshot_of(solver.points, solver.time, solver.steps, stage)
        self.seconds += time.perf_counter() - started
        return self.append_snapshot(snapshot)

    def snapshot_of(self, points: Points, time: float, steps: int, stage: str) -> Snapshot:
        """A snapshot of points, with displacements from the positions at `start_ledger`."""
        spacing = self.model.discretization.h
        return take_snapshot(self.case, points, self.initial_positions, time, steps, stage, spacing)

    def append_snapshot(self, snapshot: Snapshot) -> Snapshot:
        """Write `snapshot` as the next one, and index and history if they are due; return it as it is stored."""
        started = time.perf_counter()
        stored = as_stored(snapshot)
        path = write_snapshot(self.folder, len(self._written), stored, self._meta, self.case.output.compression)
        self._written.append(step_of(path, stored, self._meta))
        self.checksums[self._written[-1].name] = checksum_of(path)
        if time.monotonic() - self._index_written > WRITE_INTERVAL:
            self.flush()
        self.seconds += time.perf_counter() - started
        return stored

    def flush(self) -> None:
        """Write the index of all snapshots and the history up to now. Raises OutputError."""
        write_index(self.folder, self._written)
        self._index_written = time.monotonic()
        self._write_history()

    @property
    def snapshot_times(self) -> list[float]:
        """Times of the snapshots written so far, s."""
        return [step.time for step in self._written]

    def memory(self) -> dict[str, Any]:
        """Everything recorded so far except `initial_positions`, as plain values for a checkpoint."""
        return {
            "rows": self.rows,
            "initial_energies": self.initial_energies,
            "forces": self.forces.memory(),
            "flow": self.flow.memory(),
            "extreme_J": [float(J) for J in self.extreme_J],
            "snapshots": dict(self.checksums),
            "seconds": self.seconds,
        }

    def set_memory(self, memory: Mapping[str, Any], initial_positions: np.ndarray) -> None:
        """Continue from `memory`, which is not changed; snapshots written after it will be overwritten."""
        self.rows, self.extreme_J = list(memory["rows"]), memory["extreme_J"]
        self.initial_energies, self.initial_positions = memory["initial_energies"], initial_positions
        self.forces.set_memory(memory["forces"])
        self.flow.set_memory(memory.get("flow", ()))  # missing in checkpoints of earlier versions
        self.seconds = memory["seconds"]
        self.checksums = dict(memory["snapshots"])
        self._written = [describe_snapshot(self.folder / name) for name in self.checksums]

    def remove_later_snapshots(self) -> None:
        """Remove snapshots that an abandoned part of the run wrote, after the index no longer lists them."""
        later = list_snapshots(self.folder)[len(self._written) :]
        if later and self._written:
            write_index(self.folder, self._written)
        elif later:
            for name in INDEX_FILES:
                remove(self.folder / name)
        for path in later:
            remove(path)

    def _write_history(self) -> None:
        write_history(self.folder, self.rows, self.shape.model)
        self._history_written = time.monotonic()

    @cached_property
    def _meta(self) -> dict[str, str | int | float]:
        shape = self.shape
        return {
            "title": self.case.title, "case": resolved_toml(self.case), "threads": self.threads, "model": shape.model,
            "release": shape.release, "spacing": shape.spacing, "point_size": shape.point_size, "r_i": shape.r_i,
            "h_i": shape.h_i, "section": shape.section, "depth": shape.half_depth,
            "slope_deg": shape.slope_deg, **versions(),
        }  # fmt: skip


def derived_values(model: Model) -> dict[str, float]:
    """Values that follow from the case and that users may need: the spacing used, sizes of column and domain, m."""
    discretization = model.discretization
    return {
        "column_points": model.column_points,
        "spacing_used": discretization.h,
        "r_i": discretization.r_i,
        "h_i": discretization.h_i,
        "base_used": discretization.base,
        "domain_length": discretization.length,
        "domain_height": discretization.cells_up * discretization.h - discretization.base,
    }


def positions_by_id(points: Points) -> np.ndarray:
    """Positions (n, d) sorted by point id, m."""
    positions = np.empty_like(points.x)
    positions[points.id] = points.x
    return positions


def take_snapshot(
    case: Case, points: Points, initial_positions: np.ndarray, time: float, steps: int, stage: str, spacing: float
) -> Snapshot:
    """A snapshot of points, with displacements from `initial_positions` (n, d), which are sorted by point id.

    spacing: of the grid, over whose cells the stress is averaged, m.
    """
    sigma, is_base = points.sigma, points.kind == BASE
    pressure, shear_stress = np.empty(len(points)), np.empty(len(points))
    for own in (is_base, ~is_base):
        if own.any():
            pressure[own], shear_stress[own] = pressure_and_shear(points.x[own], sigma[own], points.V[own], spacing)
    arrays = {
        "position": _padded(points.x), "velocity": _padded(points.v),
        "displacement": _padded(points.x - initial_positions[points.id]),
        "stress": sigma, "pressure": pressure, "shear_stress": shear_stress,
        "volume_ratio": points.J, "opening_strain": points.opening, "mass": points.m,
        "volume": points.V, "material": points.kind.astype(np.uint8), "id": points.id.astype(np.int32),
    }  # fmt: skip
    arrays |= history_of_laws(case, points) | derived_quantities(case, points)
    return Snapshot(time, steps, stage, arrays)


def _padded(vectors: np.ndarray) -> np.ndarray:
    """(n, d) to (n, 3), with z = 0 in two dimensions."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))
