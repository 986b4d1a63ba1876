"""What a run leaves behind while it goes: rows of history with the energy ledger, and snapshots."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import Case, resolved_toml
from mpmcol.io.atomic import atomic_write, make_folder, remove
from mpmcol.io.checksums import checksum_of
from mpmcol.io.names import CASE_FILE, INDEX_FILES
from mpmcol.io.run_folder import write_history
from mpmcol.io.snapshot import Snapshot, describe_snapshot, list_snapshots, write_index, write_snapshot
from mpmcol.io.vtkhdf import Step
from mpmcol.measure import Measurement, measure
from mpmcol.mpm.constitutive import LAWS
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.particles import BASE, Points
from mpmcol.mpm.solver import Solver
from mpmcol.provenance import versions
from mpmcol.setup.discretization import column_shape
from mpmcol.setup.model import Model

HISTORY_SECONDS = 5.0  # between two writings of the history, for those who look on


class Recorder:
    """Writes history and snapshots of one run into its folder; `seconds` is the time that took."""

    def __init__(self, case: Case, model: Model, solver: Solver, folder: Path, threads: int) -> None:
        self.case, self.model, self.solver = case, model, solver
        self.folder = make_folder(folder)
        self.shape = column_shape(case, model.discretization)
        self.rows: list[dict[str, Any]] = []
        self.seconds = 0.0
        self.worst_J = [1.0, 1.0]
        self.digests: dict[str, str] = {}  # of the snapshots, by their names in the folder
        self._written: list[Step] = []
        self._saved = time.monotonic()  # when the history was last written
        self._meta = self._make_meta(threads)
        derived: dict[str, Any] = {
            "points": len(model.points),
            "threads": threads,
            **describe(model),
            **versions(),
        }
        atomic_write(folder / CASE_FILE, resolved_toml(case, derived).encode())
        self.start_ledger()

    def start_ledger(self) -> None:
        """Measure energies and displacements from now on."""
        points = self.solver.points
        self.released = positions_by_id(points)
        self.solver.ledger[:] = 0.0
        self.start = _energies(self.case, points)

    def record(self, stage: str) -> Measurement:
        """Add a row to the history; returns the measurement in it."""
        started = time.perf_counter()
        points, clock = self.solver.points, self.solver.clock
        column = (points.kind != BASE) & np.isfinite(sum(points.x.T))  # of a state that failed, what is left
        measured = measure(points.x[column], points.m[column], None, self.shape)
        least_J, largest_J = points.J.min(), points.J.max()
        self.worst_J = [min(self.worst_J[0], least_J), max(self.worst_J[1], largest_J)]
        row = {"stage": stage, "step": self.solver.steps, "time": clock[loop.TIME], "dt": clock[loop.DT]}
        row |= self.energy_ledger() | measured.front | {"height": measured.height}
        row |= {
            "J_min": least_J,
            "J_max": largest_J,
            "open_points": int(np.sum(points.opening > 0.0)),
        }
        row |= {
            "grid_kinetic": self.solver.ledger[loop.L_KINETIC],
            "unbalanced": self.solver.ledger[loop.L_UNBALANCED],
        }
        self.rows.append(row)
        if time.monotonic() - self._saved > HISTORY_SECONDS:
            self._save_history()
        self.seconds += time.perf_counter() - started
        return measured

    def energy_ledger(self) -> dict[str, float]:
        """Where the energy is since `start_ledger`, J per metre or radian; `residual` is what is missing.

        potential + kinetic + elastic + plastic + damping + walls + transfer = constant. `plastic` is the stress work
        that is not stored, `transfer` what P2G and G2P take from the points' kinetic energy and from their stress work.
        """
        now, start, sums = _energies(self.case, self.solver.points), self.start, self.solver.ledger
        plastic = sums[loop.L_WORK] - (now["elastic"] - start["elastic"])
        transfer = sums[loop.L_GRID] - (now["kinetic"] - start["kinetic"])
        transfer += sums[loop.L_NODE_WORK] - sums[loop.L_WORK]
        lost = {"damping": sums[loop.L_DAMPING], "walls": sums[loop.L_WALLS], "transfer": transfer}
        residual = sum(now.values()) - sum(start.values()) + plastic + sum(lost.values())
        return {name: float(value) for name, value in {**now, "plastic": plastic, **lost, "residual": residual}.items()}

    def snapshot(self, stage: str) -> None:
        """Write the present state as the next snapshot, and the index and the history with it."""
        started = time.perf_counter()
        taken = take_snapshot(self.case, self.solver, stage, self.released)
        path = write_snapshot(self.folder, len(self._written), taken, self._meta, self.case.output.compression)
        self._written.append(describe_snapshot(path))
        self.digests[self._written[-1].name] = checksum_of(path)
        write_index(self.folder, self._written)
        self._save_history()
        self.seconds += time.perf_counter() - started

    @property
    def snapshot_times(self) -> list[float]:
        """Times of the snapshots so far, s."""
        return [step.time for step in self._written]

    def memory(self) -> dict[str, Any]:
        """What it knows of the run so far, but for `released`, as plain values."""
        return {
            "rows": self.rows, "start": self.start, "worst_J": [float(J) for J in self.worst_J],
            "snapshots": dict(self.digests), "seconds": self.seconds,
        }  # fmt: skip

    def recall(self, memory: Mapping[str, Any], released: np.ndarray) -> None:
        """Go on from `memory`; snapshots taken later will be written over."""
        self.rows, self.start, self.worst_J = memory["rows"], memory["start"], memory["worst_J"]
        self.released, self.seconds = released, memory["seconds"]
        self.digests = dict(memory["snapshots"])
        self._written = [describe_snapshot(self.folder / name) for name in self.digests]

    def forget_others(self) -> None:
        """Remove the snapshots that are not of the run so far; the index no longer names them by then."""
        later = list_snapshots(self.folder)[len(self._written) :]
        if later and self._written:
            write_index(self.folder, self._written)
        elif later:
            for name in INDEX_FILES:
                remove(self.folder / name)
        for path in later:
            remove(path)

    def _save_history(self) -> None:
        write_history(self.folder, self.rows)
        self._saved = time.monotonic()

    def _make_meta(self, threads: int) -> dict[str, str | int | float]:
        shape = self.shape
        return {
            "title": self.case.title, "case": resolved_toml(self.case), "threads": threads, "model": shape.model,
            "release": shape.release, "spacing": shape.spacing, "point_size": shape.point_size, "r_i": shape.r_i,
            "h_i": shape.h_i, "section": shape.section, "depth": shape.half_depth, **versions(),
        }  # fmt: skip


def describe(model: Model) -> dict[str, float]:
    """Derived numbers of a model that a user may want to know."""
    used = model.discretization
    return {
        "column_points": model.column_points, "spacing_used": used.h, "r_i": used.r_i, "h_i": used.h_i,
        "base_used": used.base, "domain_length": used.length, "domain_height": used.cells_up * used.h - used.base,
    }  # fmt: skip


def positions_by_id(points: Points) -> np.ndarray:
    """Positions (n, d) in order of point id."""
    out = np.empty_like(points.x)
    out[points.id] = points.x
    return out


def take_snapshot(case: Case, solver: Solver, stage: str, released: np.ndarray) -> Snapshot:
    """The present state as arrays; `released` are the positions by id from which displacements count."""
    points = solver.points
    moved = points.x - released[points.id]
    arrays = {
        "position": _in_space(points.x), "velocity": _in_space(points.v), "displacement": _in_space(moved),
        "stress": points.sigma, "volume_ratio": points.J, "opening_strain": points.opening, "mass": points.m,
        "volume": points.V, "material": points.kind.astype(np.uint8), "id": points.id.astype(np.int32),
    }  # fmt: skip
    for k, name in enumerate(LAWS[case.material.law].STATE):
        arrays[name] = points.history[:, k]
    return Snapshot(solver.time, solver.steps, stage, arrays)


def _in_space(values: np.ndarray) -> np.ndarray:
    """(n, d) to (n, 3)."""
    return np.pad(values, ((0, 0), (0, 3 - values.shape[1])))


def _energies(case: Case, points: Points) -> dict[str, float]:
    """Potential, kinetic and elastic energy of all points, J per metre or radian."""
    (xx, yy, zz, xy, yz, xz), is_base = points.sigma.T, points.kind == BASE
    bulk = np.where(is_base, case.base_material.bulk_modulus, case.material.bulk_modulus)
    shear = np.where(is_base, case.base_material.shear_modulus, case.material.shear_modulus)
    p = (xx + yy + zz) / 3.0
    deviator = (xx - p) ** 2 + (yy - p) ** 2 + (zz - p) ** 2 + 2.0 * (xy**2 + yz**2 + xz**2)
    v2 = sum(v**2 for v in points.v.T)  # one component after the other: sums along short rows are slow
    return {
        "potential": float(np.sum(points.m * case.geometry.gravity * points.x[:, 1])),
        "kinetic": float(0.5 * np.sum(points.m * v2)),
        "elastic": float(np.sum(points.V * (0.5 * p**2 / bulk + 0.25 * deviator / shear))),
    }
