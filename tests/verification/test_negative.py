"""Negative tests: time steps beyond the stability limit, missing damping, NaN."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import (
    WEIGHTLESS,
    E,
    advance_to,
    elastic_body,
    elastic_energy,
    kinetic_energy,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.lanes import VX, VZ, J, X, Z
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.solver import Solver

H = 0.1
TRANSIT = 1.0 / 64.7
both_dimensions = pytest.mark.parametrize("d", [2, 3])


def vibrating_block(settings: Settings, d: int = 2) -> Solver:
    """A free elastic block of 10 x 10 or 5 x 5 x 5 cells with small random velocities."""
    end = {2: 1.5, 3: 1.0}[d]
    points = points_at(lattice((0.5,) * d, (end,) * d, H / 2), H / 2)
    points.v[:] = np.random.default_rng(7).normal(0.0, 0.05, (len(points), d))
    return make_solver(points, walled_grid((0.0,) * d, H, (20,) * d), settings, body=elastic_body())


def energy(solver: Solver) -> float:
    return kinetic_energy(solver.points) + elastic_energy(solver.points, E)


@both_dimensions
def test_a_time_step_beyond_the_stability_limit_is_detected(d: int) -> None:
    solver = vibrating_block(WEIGHTLESS._replace(cfl=1.5), d)
    faults = [solver.advance(np.inf, max_steps=100) for _ in range(5)]
    assert max(faults) >= 0


@both_dimensions
def test_a_time_step_within_the_stability_limit_is_stable(d: int) -> None:
    solver = vibrating_block(WEIGHTLESS, d)
    start = energy(solver)
    for k in range(10):
        advance_to(solver, 5.0 * TRANSIT * (k + 1))
        assert energy(solver) < start


def test_vibration_stops_only_with_damping() -> None:
    """A compression wave across the block: local damping stops it within a few transits."""
    remaining = {}
    for alpha_d in (0.0, 0.5):
        solver = vibrating_block(WEIGHTLESS._replace(alpha_d=alpha_d))
        solver.points.v[:] = 0.0
        solver.points.v[:, 0] = np.sin(np.pi * (solver.points.x[:, 0] - 1.0))
        start = energy(solver)
        advance_to(solver, 20.0 * TRANSIT)
        remaining[alpha_d] = energy(solver) / start
    assert remaining[0.0] > 0.8
    assert remaining[0.5] < 0.01


L_XX, S_XX, L_ZZ, S_ZZ = 9, 12, 27, 30
LANES = {"velocity": VX, "gradient": L_XX, "stress": S_XX, "J": J, "position": X}
LANES_ALONG_Z = {"velocity": VZ, "gradient": L_ZZ, "stress": S_ZZ, "position": Z}
PARAMETERS = [(2, LANES[name]) for name in LANES] + [(3, lane) for lane in (*LANES.values(), *LANES_ALONG_Z.values())]
NAMES = [*LANES, *(f"{name} in 3D" for name in LANES), *(f"{name} along z" for name in LANES_ALONG_Z)]


@pytest.mark.parametrize(("d", "lane"), PARAMETERS, ids=NAMES)
def test_nan_is_detected_within_one_step(d: int, lane: int) -> None:
    solver = vibrating_block(WEIGHTLESS, d)
    assert solver.advance(np.inf, max_steps=3) == -1
    solver.points.rows[123, lane] = np.nan
    start = solver.points.x.copy()
    fault = solver.advance(np.inf, max_steps=1)
    assert fault >= 0
    assert not np.all(np.isfinite(solver.points.rows[fault]))
    if lane not in (X, Z):
        assert np.linalg.norm(start[fault] - start[123]) < 4.0 * H
