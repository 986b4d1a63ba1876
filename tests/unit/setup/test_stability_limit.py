"""Stability limit of a single particle: closed forms, critical positions, and the limit of a case."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mpmcol.case import load_case, shipped_cases
from mpmcol.mpm.boundary import AXIS, AXIS_GAP, FREE, NO_SLIP, ROLLER, WALL_GAP
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.setup.stability_limit import MIDWAY, SingleParticle, single_particle_limit
from mpmcol.setup.time_step import axis_gap, case_limit

CUBIC = SHAPE_FUNCTIONS["cubic"]
NEXT_TO_AXIS = (AXIS, FREE)
DEFAULT_CFL = 0.5


@pytest.mark.parametrize(
    ("particle", "limit", "tolerance"),
    [
        (SingleParticle((MIDWAY, MIDWAY), nu=0.0), 0.816, 1.5e-3),
        (SingleParticle((MIDWAY, MIDWAY)), 0.730, 1.5e-3),
        (SingleParticle((MIDWAY, MIDWAY), nu=0.3), 0.683, 1.5e-3),
        (SingleParticle((4.25, 4.25)), 0.856, 1.5e-3),
        (SingleParticle((MIDWAY,) * 3), 0.667, 1.5e-3),
        (SingleParticle((MIDWAY,) * 3, nu=0.3), 0.599, 1.5e-3),
        (SingleParticle((4.25,) * 3), 0.782, 1.5e-3),
        (SingleParticle((0.25, MIDWAY), faces=NEXT_TO_AXIS, axisymmetric=True), 0.60, 6e-3),
        (SingleParticle((0.1, MIDWAY), faces=NEXT_TO_AXIS, axisymmetric=True), 0.39, 6e-3),
        (SingleParticle((0.05, MIDWAY), faces=NEXT_TO_AXIS, axisymmetric=True), 0.28, 6e-3),
        (SingleParticle((MIDWAY,) * 3, transfer="flip"), 0.667 / np.sqrt(2.0), 1.5e-3),
        (SingleParticle((MIDWAY,) * 3, transfer="pic"), 0.667 / np.sqrt(2.0), 1.5e-3),
        (SingleParticle((MIDWAY,) * 3, transfer="tpic"), 0.667, 1.5e-3),
        (SingleParticle((MIDWAY,) * 3, transfer="apic"), 0.667 * np.sqrt(0.75), 1.5e-3),
        (SingleParticle((MIDWAY,) * 2, nu=0.0, basis="cubic"), 2.0 / np.sqrt(CUBIC.STIFFNESS), 6e-3),
    ],
)  # fmt: skip
def test_limits_of_single_particles(particle: SingleParticle, limit: float, tolerance: float) -> None:
    """In one dimension omega^2 = S (c / h)^2 with S = sum w'^2 / w over the nodes: S = 6 midway between nodes.

    The limit is then 2 / sqrt(6) = 0.816. In d dimensions S (1 + (d - 1) nu / (1 - nu)) takes its place, and for APIC
    omega^2 dt^2 (1 - 2 / S) < 2. The values next to the axis are those of an independent computation.
    """
    assert single_particle_limit(particle) == pytest.approx(limit, abs=tolerance)


@pytest.mark.parametrize("transfer", ["taylor-flip", "flip", "apic"])
@pytest.mark.parametrize("basis", ["quadratic", "cubic"])
@pytest.mark.parametrize(("d", "axisymmetric"), [(2, False), (2, True), (3, False)])
def test_no_position_is_less_stable_than_midway_between_nodes_or_next_to_a_face(
    transfer: str, basis: str, d: int, axisymmetric: bool
) -> None:
    rng, gaps = np.random.default_rng(3), np.full(d, WALL_GAP)
    gaps[0] = AXIS_GAP if axisymmetric else WALL_GAP
    faces = (AXIS if axisymmetric else ROLLER, NO_SLIP, ROLLER)[:d]
    particle = SingleParticle((MIDWAY,) * d, 0.3, faces, axisymmetric, transfer, 1.0, basis)

    def limit_at(position: np.ndarray) -> float:
        return single_particle_limit(replace(particle, position=tuple(map(float, position))))

    critical = np.stack(np.meshgrid(*[(gap, MIDWAY) for gap in gaps], indexing="ij"), -1).reshape(-1, d)
    least = min(map(limit_at, critical))
    for position in rng.uniform(gaps, MIDWAY, (60, d)):
        assert limit_at(position) > least - 3e-3, position


@pytest.mark.parametrize("name", shipped_cases())
def test_the_time_step_of_every_shipped_case_is_stable(name: str) -> None:
    case = load_case(name)
    limit, _ = case_limit(case)
    assert limit > case.time.cfl / 0.95


@pytest.mark.parametrize(
    ("overrides", "limit", "where"),
    [
        ([], 0.544, "next to two smooth walls"),
        (["material.poissons_ratio=0.3"], 0.494, "next to two smooth walls"),
        (["geometry.model=full"], 0.667, "midway between nodes"),
        (["geometry.model=full", "geometry.base=rigid"], 0.628, "next to the no-slip floor"),
        (["geometry.model=axisymmetric", "grid.points_per_cell=16"], 0.438, "next to the axis"),
        (["geometry.model=axisymmetric", "grid.points_per_cell=4", "method.transfer=flip"], 0.416, "next to the axis"),
        (["method.basis=linear"], 0.0, "on a line of nodes"),
    ],
    ids=str,
)
def test_limit_of_a_case_and_its_critical_position(overrides: list[str], limit: float, where: str) -> None:
    assert case_limit(load_case("lube-quarter", overrides)) == (pytest.approx(limit, abs=1e-3), where)


def test_the_axis_gap_does_not_exceed_the_initial_distance_of_particles() -> None:
    gaps = {ppc: axis_gap(load_case("lube-cylinder", [f"grid.points_per_cell={ppc}"])) for ppc in (1, 4, 9, 16)}
    assert gaps == {1: 0.2, 4: 0.2, 9: pytest.approx(1.0 / 6.0), 16: 0.125}
