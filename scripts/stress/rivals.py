"""Other methods against noise of the stresses, in NumPy between the compiled steps, beside the stress filter.

    python scripts/stress/rivals.py OUT [--case channel|channel-loose|channel-dense] [--method NAME]

Runs the column a = 3 at h = 4.5 mm once with each method and prints a Markdown table. Methods in NumPy take some
minutes each.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpmcol.case import Case, load_case
from mpmcol.measure import measure
from mpmcol.measure.stress import cell_means, stress_quality
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.particles import BASE, Points
from mpmcol.mpm.solver import Solver
from mpmcol.mpm.threads import set_threads
from mpmcol.setup.model import build_model, stress_filter_settings
from mpmcol.simulation.energy import stored_energies
from mpmcol.simulation.run import start
from mpmcol.simulation.stages import Stages

COLUMN = ("geometry.aspect=3", "grid.spacing=0.0045", "output.snapshots=1")
DURATION = 6.0  # of the collapse, in sqrt(h_i / g): all of these columns are at rest by then
CHECKS = 60  # of the kinetic energy
SAMPLED = 2  # applications of a method for each that is examined for the energy that it takes
PROJECTIONS = 2  # m in the velocity filter [I - (I - P)^m] v
HEADER = (
    "method", "zeta: max / height", "beta", "damping, % (times smooth)", "taken by the method, %", "stress-free, %",
    "p99 / max", "J",
)  # fmt: skip


@dataclass(frozen=True)
class Method:
    """A method: options of the case, and what changes the points every `interval` steps (0: never).

    apply: called with the solver, the parameters of the stress filter, and J by point id before the last step.
    """

    options: tuple[str, ...] = ("method.stress_filter=none",)
    interval: int = 0
    apply: Callable[[Solver, dict[str, float], np.ndarray], None] | None = None


class Interpolation:
    """Quadratic B-splines of the points (n, 2) on a grid of spacing h around them."""

    def __init__(self, x: np.ndarray, m: np.ndarray, h: float) -> None:
        first = np.floor(x / h - 0.5).astype(np.int64)
        local = x / h - first
        one_dimensional = np.stack([0.5 * (1.5 - local) ** 2, 0.75 - (local - 1.0) ** 2, 0.5 * (local - 0.5) ** 2])
        slope = np.stack([local - 1.5, 2.0 - 2.0 * local, local - 0.5]) / h
        self.origin, size = first.min(axis=0), np.ptp(first, axis=0) + 3
        i, j = np.divmod(np.arange(9), 3)
        node = first[:, None, :] - self.origin + np.stack([i, j], axis=-1)
        self.weight = (one_dimensional[i, :, 0] * one_dimensional[j, :, 1]).T
        self.gradient = np.stack(
            [(slope[i, :, 0] * one_dimensional[j, :, 1]).T, (one_dimensional[i, :, 0] * slope[j, :, 1]).T], axis=-1
        )
        self.number, self.count = node[..., 0] * size[1] + node[..., 1], int(size.prod())
        self.offset = (node + self.origin) * h - x[:, None, :]
        self.m, self.mass = m, self.to_nodes(np.broadcast_to(m[:, None], self.weight.shape))
        k = np.arange(self.count)
        self.nodes = np.stack([k // size[1] + self.origin[0], k % size[1] + self.origin[1]], axis=-1)

    def to_nodes(self, values: np.ndarray) -> np.ndarray:
        """Sum of weight times `values` (n, 9) at each node."""
        return np.bincount(self.number.reshape(-1), (self.weight * values).reshape(-1), self.count)

    def average(self, q: np.ndarray) -> np.ndarray:
        """The average of q (n,) on the grid, at the points."""
        momenta = self.to_nodes(np.broadcast_to((self.m * q)[:, None], self.weight.shape))
        nodal = momenta / np.maximum(self.mass, 1e-300)
        return np.sum(self.weight * nodal[self.number], axis=1)


def set_mean(points: Points, column: np.ndarray, q: np.ndarray, K: float) -> None:
    """Set the mean stress, or the opening strain, of these points to q (n,); J follows."""
    sigma = points.sigma
    mean = sigma[column, :3].mean(axis=1)
    closed = np.minimum(q, 0.0)
    sigma[column, :3] += (closed - mean)[:, None]
    opened = q > 0.0
    sigma[column] = np.where(opened[:, None], 0.0, sigma[column])
    points.sigma = sigma
    points.J[column] *= 1.0 + (closed - mean) / K
    points.opening[column] = np.where(opened, q / K, 0.0)


def filtered_points(points: Points, parameters: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the column's points that a method changes, and their mean stress, continued by the opening strain."""
    column = np.flatnonzero((points.kind != BASE) & (points.opening < parameters["filter_opening"]))
    return column, points.sigma[column, :3].mean(axis=1) + parameters["filter_modulus"] * points.opening[column]


def relax_to_cells(solver: Solver, parameters: dict[str, float], before: np.ndarray) -> None:
    """Relax the elastic volumetric strain to its average in the cell, at the rate of the stress filter."""
    points, share = solver.points, parameters["filter_rate"] * solver.dt
    column, q = filtered_points(points, parameters)
    L = points.grad_v[column, :2, :2]
    D = 0.5 * (L + L.transpose(0, 2, 1))
    trace = D[:, 0, 0] + D[:, 1, 1]
    shear2 = 2.0 * (np.sum(D * D, axis=(1, 2)) - trace**2 / 3.0) / parameters["filter_shear_rate"] ** 2
    average = cell_means(points.x[column], q, points.m[column], solver.grid.h)
    chi = share / (1.0 + share) * np.minimum(1.0, shear2)
    set_mean(points, column, q + chi * (average - q), parameters["filter_modulus"])


def average_strain_increments(solver: Solver, parameters: dict[str, float], before: np.ndarray) -> None:
    """Nodal F-bar: the volumetric strain increment of a step is replaced by its average on the grid."""
    points, K = solver.points, parameters["filter_modulus"]
    column, q = filtered_points(points, parameters)
    increment = np.log(points.J[column] / before[points.id[column]])
    grid = Interpolation(points.x[column], points.m[column], solver.grid.h)
    change = grid.average(increment) - increment
    J = points.J[column] * np.exp(change)
    set_mean(points, column, q + K * change, K)
    points.J[column] = J


def filter_velocities(solver: Solver, parameters: dict[str, float], before: np.ndarray) -> None:
    """[I - (I - P)^m] v with the Taylor terms carried along, so that linear fields are not changed.

    Extended from Hammerquist & Nairn 2017, doi:10.1016/j.cma.2017.01.035.
    """
    points = solver.points
    grid = Interpolation(points.x, points.m, solver.grid.h)
    v, L = points.v.copy(), points.grad_v[:, :2, :2].copy()
    mass = np.maximum(grid.mass, 1e-300)
    for _ in range(PROJECTIONS):
        carried = v[:, None, :] + np.einsum("nij,nkj->nki", L, grid.offset)
        nodal = np.stack([grid.to_nodes(points.m[:, None] * carried[..., k]) / mass for k in (0, 1)], axis=-1)
        nodal[grid.nodes[:, 0] <= 0, 0] = 0.0  # the wall
        at_points = nodal[grid.number]
        v -= np.sum(grid.weight[..., None] * at_points, axis=1)
        L -= np.einsum("nki,nkj->nij", at_points, grid.gradient)
    column = points.kind != BASE
    points.v[column] -= v[column]


METHODS = {
    "none": Method(),
    "stress filter": Method(("method.stress_filter=flow",)),
    "cell-averaged strain increments": Method(("method.stress_filter=none", "method.volumetric_strain=cell")),
    "cell average of the elastic strain": Method(interval=1, apply=relax_to_cells),
    "nodal F-bar": Method(interval=1, apply=average_strain_increments),
    "velocity filter": Method(interval=10, apply=filter_velocities),
    "stress filter and velocity filter": Method(("method.stress_filter=flow",), 10, filter_velocities),
}


def collapse(case: Case, stages: Stages, method: Method) -> tuple[float, float]:
    """Carry out the collapse; the largest kinetic energy and the energy that `method.apply` took, J."""
    solver, points = stages.solver, stages.solver.points
    parameters = stress_filter_settings(case, stages.model.discretization)
    end, kinetic, taken, check, J = DURATION * stages.fall_time, 0.0, 0.0, 0.0, np.empty(len(points))
    applications = 0
    while solver.time < end:
        J[points.id] = points.J
        if method.apply:
            fault = solver.advance(end, max_steps=method.interval)
        else:
            fault = solver.advance(min(end, check + end / CHECKS))
        assert fault < 0, f"the point in row {fault} is invalid at {solver.time:.3g} s"
        if method.apply:
            stored = stored_energies(case, points) if applications % SAMPLED == 0 else {}
            method.apply(solver, parameters, J)
            if stored:
                now = stored_energies(case, points)
                taken += SAMPLED * sum(stored[k] - now[k] for k in ("elastic", "kinetic"))
            applications += 1
        if solver.time >= check:
            check = solver.time + end / CHECKS
            kinetic = max(kinetic, stored_energies(case, points)["kinetic"])
    return kinetic, taken


def row_of(name: str, case: Case, folder: Path) -> str:
    """Run a column with one method; a row of the table."""
    method = METHODS[name]
    stages = Stages(start(case, build_model(case), folder))
    stages.equilibrate()
    stages.release()
    solver, points, shape, g = stages.solver, stages.solver.points, stages.recorder.shape, case.geometry.gravity
    potential = stored_energies(case, points)["potential"]
    kinetic, taken = collapse(case, stages, method)
    column = points.kind != BASE
    found = measure(points.x[column], points.m[column], None, shape)
    stress = stress_quality(points.x[column], points.sigma[column], points.m[column], points.V[column], shape, g)
    assert stress is not None
    released = potential - stored_energies(case, points)["potential"]
    damping, smooth = float(solver.ledger[loop.L_DAMPING]), 2.0 * case.stages.collapse.damping * kinetic
    cells = (
        name,
        f"{found.zeta['front_max']:.2f} / {found.zeta['front_height']:.2f}",
        f"{found.beta:.3f}",
        f"{100 * damping / released:.1f} ({damping / smooth:.1f})",
        f"{100 * (taken + float(solver.ledger[loop.L_FILTER])) / released:.1f}",
        f"{100 * stress.stress_free:.0f}",
        f"{stress.pressure_p99:.2f} / {stress.pressure_max:.2f}",
        f"{points.J[column].min():.3f} to {points.J[column].max():.3f}",
    )
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Run the methods and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, help="folder of the runs")
    parser.add_argument("--case", default="channel")
    parser.add_argument("--method", action="append", choices=METHODS)
    args = parser.parse_args()
    set_threads(1)
    print(f"| {' | '.join(HEADER)} |\n|{'---|' * len(HEADER)}", flush=True)
    for name in args.method or METHODS:
        case = load_case(args.case, [*COLUMN, *METHODS[name].options])
        print(row_of(name, case, args.out / f"{args.case}-{name.replace(' ', '-')}"), flush=True)


if __name__ == "__main__":
    main()
