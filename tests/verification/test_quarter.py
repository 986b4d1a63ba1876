"""One cylindrical column modelled as a quarter, in full, and axisymmetric."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import mpmcol
from mpmcol.failure_modes.problems.bar import period_of
from mpmcol.failure_modes.toolkit import (
    DENSITY,
    NU,
    WEIGHTLESS,
    G,
    advance_steps,
    advance_to,
    by_id,
    elastic_body,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.measure import FRONTS
from mpmcol.mpm.particles import BASE, Points
from mpmcol.mpm.solver import Solver
from mpmcol.setup.model import build_model, set_boundaries
from tests.support.breathing_cylinder import bessel, breathing_root

COARSE = ("grid.spacing=0.0194", "stages.equilibrate.law=mohr-coulomb")
POINTS = {"axisymmetric": "grid.points_per_cell=4"}


def cylinder(model: str, *more: str) -> mpmcol.Case:
    """The shipped case with the given model, five cells per radius, and the same law in both stages."""
    points = POINTS.get(model, "grid.points_per_cell=8")
    return mpmcol.load_case("lube-quarter", [f"geometry.model={model}", *COARSE, points, *more])


class Collapsed(NamedTuple):
    """Positions at the release and after sqrt(h_i / g), in cells."""

    before: np.ndarray
    after: np.ndarray
    is_column: np.ndarray


@cache
def collapsed(kind: str) -> Collapsed:
    """The column without its gate, from the stress at rest.

    Without damping, which depends on the sign of the nodal velocity: round-off where the column is still at rest.
    """
    case = cylinder(kind, "stages.initial_stress=k0", "stages.collapse.damping=0.0")
    model = build_model(case)
    set_boundaries(model.grid, model.discretization, np.inf)
    solver = Solver(model.points, model.grid, model.collapse.settings, model.collapse.column, model.base)
    start = by_id(solver)
    advance_to(solver, model.discretization.fall_time(G))
    h = model.discretization.h
    return Collapsed(start.x / h, by_id(solver).x / h, start.kind != BASE)


def in_order(x: np.ndarray) -> np.ndarray:
    """Indices that sort the points of a lattice by position."""
    return np.lexsort(np.round(100.0 * x).T)


def matched(one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the points of two sets at the same positions."""
    a, b = in_order(one), in_order(other)
    np.testing.assert_allclose(one[a], other[b], atol=1e-9)
    return a, b


SYMMETRIES = {
    ("quarter", "x and z swapped"): [[0, 0, 1], [0, 1, 0], [1, 0, 0]],
    ("full", "x mirrored"): [[-1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ("full", "z mirrored"): [[1, 0, 0], [0, 1, 0], [0, 0, -1]],
    ("full", "rotated by 90 degrees"): [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
}


@pytest.mark.parametrize(("model", "name"), SYMMETRIES)
def test_a_column_stays_symmetric(model: str, name: str) -> None:
    """To round-off, 5e-15 of a cell; see test_symmetry.py."""
    run, R = collapsed(model), np.array(SYMMETRIES[model, name], float)
    a, b = matched(run.before, run.before @ R.T)
    np.testing.assert_allclose(run.after[a], (run.after @ R.T)[b], atol=1e-12)


def test_quarter_and_full_column_move_alike() -> None:
    """Within 0.7 % of a cell, 0.1 % rms, while points move by a cell.

    The difference is not round-off: next to a plane of symmetry the corrected weights of the quarter are linear, those
    of the full column are B-splines across the plane. At half the spacing it is 0.3 % of a cell.
    """
    quarter, full = collapsed("quarter"), collapsed("full")
    first = np.all(full.before[:, ::2] > 0.0, axis=1)
    a, b = matched(quarter.before, full.before[first])
    column = quarter.is_column[a]
    assert 4 * len(quarter.before) == len(full.before)
    moved = (quarter.after - quarter.before)[a][column]
    difference = (quarter.after[a] - full.after[first][b])[column]
    assert np.abs(moved).max() > 0.9
    assert np.abs(difference).max() < 0.007
    assert np.sqrt(np.mean(difference**2)) < 0.001


def test_fronts_of_quarter_and_full_column_agree(tmp_path: Path) -> None:
    """Mean, smallest and largest front around the axis, and height, of complete runs."""
    short = ("stages.initial_stress=k0", "stages.collapse.max_time_factor=1.0", "output.snapshots=1")
    quarter, full = (
        mpmcol.run(cylinder(model, *short), tmp_path / model, threads=1).summary for model in ("quarter", "full")
    )
    assert quarter["front"]["front_max"]["mean"] > 1.1 * 0.097
    for front in FRONTS:
        for part in ("mean", "min", "max"):
            assert quarter["front"][front][part] == pytest.approx(full["front"][front][part], rel=0.01), (front, part)
    assert quarter["height"] == pytest.approx(full["height"], rel=0.01)
    assert 4.0 * quarter["ledger"]["potential"] == pytest.approx(full["ledger"]["potential"], rel=0.002)


def breathing_period(cells: int) -> float:
    """Period of the plane-strain radial vibration of a quarter cylinder, over the exact one for its volume."""
    z, h, body = breathing_root(), 1.0 / cells, elastic_body()
    x = lattice((0.0,) * 3, (1.0, 2.0 * h, 1.0), h / 2)
    x = x[np.hypot(x[:, 0], x[:, 2]) < 1.0]
    r = np.hypot(x[:, 0], x[:, 2])
    points = points_at(x, h / 2)
    points.v[:, ::2] = (1e-3 * bessel(1, z * r) / r)[:, None] * x[:, ::2]
    mode, radius = points.m[:, None] * points.v, np.sqrt(points.V.sum() / (0.5 * np.pi * h))
    grid = walled_grid((0.0,) * 3, h, (cells + 4, 2, cells + 4), rollers="left back bottom top")
    solver = make_solver(points, grid, WEIGHTLESS, body=body)
    exact = 2.0 * np.pi * radius / (z * np.sqrt(body.wave_speed2))
    times, amplitudes = [], []
    while solver.time < 4.0 * exact:
        advance_steps(solver, 1)
        times.append(solver.time)
        amplitudes.append(np.sum(mode * by_id(solver).v))
    return float(period_of(np.array(times), np.array(amplitudes)) / exact)


def test_radial_vibration_of_a_quarter_cylinder() -> None:
    """Within 0.6 % of the exact period at ten cells; second order in spite of the stepped surface."""
    errors = np.array([breathing_period(cells) for cells in (5, 10, 20)]) - 1.0
    assert 0.0 < errors[1] < 0.006
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all((orders > 1.6) & (orders < 2.2)), (errors, orders)


def at_rest_behind_the_gate(kind: str) -> tuple[Points, np.ndarray, float]:
    """The column as an elastic body on a rigid floor, the initial heights of its points, and its height."""
    model = build_model(cylinder(kind, "geometry.base=rigid"))
    model.points.kind[:] = BASE
    stage = model.equilibrate
    solver = Solver(model.points, model.grid, stage.settings, stage.column, model.base)
    y = model.points.x[:, 1].copy()
    advance_to(solver, 30.0 * model.discretization.wave_time(model.base.wave_speed2))
    return by_id(solver), y, model.discretization.h_i


@pytest.mark.parametrize(("model", "tolerance"), [("axisymmetric", 0.01), ("quarter", 0.06)])
def test_elastic_stress_behind_the_gate(model: str, tolerance: float) -> None:
    """Vertical stress from the weight above within 2.5 %; lateral nu / (1 - nu) times it, less at a stepped gate.

    The lowest layers and the top half cell are left out.
    """
    points, y, height = at_rest_behind_the_gate(model)
    for level in np.unique(np.round(y, 9))[2:-1]:
        layer = np.abs(y - level) < 1e-6
        xx, yy, zz = points.V[layer] @ points.sigma[layer, :3] / points.V[layer].sum()
        assert yy == pytest.approx(-DENSITY * G * (height - level), rel=0.025)
        assert 0.5 * (xx + zz) / yy == pytest.approx(NU / (1.0 - NU), rel=tolerance)


@pytest.mark.slow
def test_runout_of_quarter_and_axisymmetric_column_agree(tmp_path: Path) -> None:
    """With ten cells per radius zeta is 0.790 (axisymmetric) and 0.794 (quarter, mean around the axis)."""
    fine = ("grid.spacing=0.0097", "output.snapshots=1")
    axisymmetric, quarter = (
        mpmcol.run(cylinder(model, *fine), tmp_path / model).summary for model in ("axisymmetric", "quarter")
    )
    assert axisymmetric["zeta"]["front_max"] == pytest.approx(0.79, rel=0.03)
    assert quarter["zeta"]["front_max"]["mean"] == pytest.approx(axisymmetric["zeta"]["front_max"], rel=0.03)
    assert quarter["beta"] == pytest.approx(axisymmetric["beta"], rel=0.03)


@pytest.mark.parametrize("model", ["quarter", "full"])
@pytest.mark.parametrize("section", ["cylinder", "box"])
def test_k0_stress_is_geostatic(model: str, section: str) -> None:
    """Vertical stress from the weight above; horizontal stresses K0 times it, in the base nu / (1 - nu) times it."""
    case = cylinder(model, "stages.initial_stress=k0", "stages.k0=0.37", f"geometry.section={section}")
    model = build_model(case)
    points, (x, y, z) = model.points, model.points.x.T
    is_base, r_i = points.kind == BASE, model.discretization.r_i
    inside = (
        np.hypot(x, z) < r_i if section == "cylinder" else (np.abs(x) < r_i) & (np.abs(z) < model.discretization.depth)
    )
    above = np.where(is_base, np.where(inside, model.discretization.h_i, 0.0) - y, model.discretization.h_i - y)
    weight = -case.material.density * case.geometry.gravity * above
    nu = case.base_material.poissons_ratio
    ratio = np.where(is_base, nu / (1.0 - nu), 0.37)
    expected = np.stack([ratio * weight, weight, ratio * weight, *np.zeros((3, len(y)))], axis=1)
    np.testing.assert_allclose(points.sigma, expected, rtol=1e-12, atol=0.0)
    assert is_base.any() and (~is_base).any() and np.ptp(weight[~is_base]) > 0.0
