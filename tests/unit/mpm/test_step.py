"""Whole steps of the compiled solver against the NumPy reference, for every law, option and scheme."""

from __future__ import annotations

from dataclasses import replace
from math import radians, tan
from typing import Any

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import by_id
from mpmcol.mpm.boundary import CONTACT, NO_SLIP, ROLLER, WALL_GAP, BoundaryType, apply_boundaries, face
from mpmcol.mpm.constitutive import LAWS
from mpmcol.mpm.contact import make_contacts
from mpmcol.mpm.grid import Grid, allocate_grid, grid_shape
from mpmcol.mpm.particles import Points
from mpmcol.mpm.settings import Scheme, Settings
from mpmcol.mpm.solver import Body, Solver
from mpmcol.mpm.wall_cells import with_walls
from mpmcol.setup.wall_boxes import WallBox, cells_in_walls, wall_boundaries
from tests.support import reference
from tests.support.sand_column import OTHER_SCHEME

ELASTIC = {"density": 2000.0, "youngs_modulus": 1e6, "poissons_ratio": 0.25}
PLASTIC = {
    "elastic": {},
    "mohr-coulomb": {"friction_deg": 33.0, "dilatancy_deg": 5.0, "cohesion": 20.0},
    "mohr-coulomb-softening": {
        "friction_peak_deg": 45.0, "friction_residual_deg": 30.0, "dilatancy_peak_deg": 15.0,
        "dilatancy_residual_deg": 1.0, "softening_rate": 5.0, "cohesion": 10.0,
    },
    "mohr-coulomb, brittle": {
        "friction_deg": 33.0, "dilatancy_deg": 5.0, "cohesion": 100.0, "tension": 50.0, "failure_strain": 0.0,
    },
    "mohr-coulomb, clay": {"friction_deg": 0.0, "cohesion": 150.0, "tension": 100.0},
    "mohr-coulomb-softening, cohesion": {
        "friction_peak_deg": 45.0, "friction_residual_deg": 30.0, "softening_rate": 5.0, "cohesion": 100.0,
        "cohesion_residual": 10.0,
    },
    "mohr-coulomb-softening, tension": {
        "friction_peak_deg": 45.0, "friction_residual_deg": 30.0, "softening_rate": 5.0, "cohesion": 100.0,
        "cohesion_residual": 10.0, "tension": 40.0,
    },
    "mohr-coulomb-random": {
        "friction_deg": 33.0, "friction_variation": 0.2, "correlation_length": 1.0, "dilatancy_deg": 25.0,
        "cohesion": 20.0,
    },
    "drucker-prager": {"friction_deg": 33.0, "match": "tangent", "cohesion": 20.0},
    "drucker-prager, brittle": {"friction_deg": 33.0, "match": "tangent", "cohesion": 100.0, "failure_strain": 2e-4},
    "mu-i, brittle": {
        "mu_s": 0.4, "mu_2": 0.7, "I_0": 0.3, "grain_diameter": 0.05, "grain_density": 2500.0, "cohesion": 100.0,
        "failure_strain": 2e-4,
    },
    "mu-i": {
        "mu_s": 0.4, "mu_2": 0.7, "I_0": 0.3, "grain_diameter": 0.05, "grain_density": 2500.0, "cohesion": 20.0,
    },
}  # fmt: skip
PLAIN = Settings(alpha_d=0.1, cfl=0.3)
H, CELLS, ORIGIN = 0.1, (13, 10, 8), (0.0, -0.2, 0.0)
RANDOM = "mohr-coulomb-random"
DAM = WallBox("dam", (5, 0, 2), (7, 4, 5))


def body(law: str) -> Body:
    module = LAWS[law.partition(",")[0]]
    material = module.Material(**ELASTIC, **PLASTIC[law])
    return Body(module, module.make_params(material), material.wave_speed**2)


def reference_material(law: str) -> reference.ReferenceMaterial:
    keys = PLASTIC[law]
    if law == "elastic":
        return reference.ReferenceMaterial(1e6, 0.25)
    if law == "mohr-coulomb":
        return reference.ReferenceMaterial(1e6, 0.25, radians(33.0), radians(5.0), 20.0)
    if law == RANDOM:
        return reference.ReferenceMaterial(1e6, 0.25, radians(33.0), radians(25.0), 20.0)
    if law == "mohr-coulomb, brittle":
        return reference.ReferenceMaterial(
            1e6, 0.25, radians(33.0), radians(5.0), 100.0, tension=50.0, failure_strain=0.0
        )
    if law == "mohr-coulomb, clay":
        return reference.ReferenceMaterial(1e6, 0.25, 0.0, 0.0, 150.0, tension=100.0, failure_strain=1.0)
    if law in ("mohr-coulomb-softening, cohesion", "mohr-coulomb-softening, tension"):
        return reference.ReferenceMaterial(
            1e6, 0.25, radians(45.0), 0.0, 100.0, radians(30.0), rate=5.0, c_residual=10.0, tension=keys.get("tension")
        )
    if law.partition(",")[2]:  # brittle cones
        rate = {"mu_2": 0.7, "I_0": 0.3, "d": 0.05, "rho_s": 2500.0} if law.startswith("mu-i") else {}
        mu = 0.4 if rate else tan(radians(33.0))
        return reference.ReferenceMaterial(1e6, 0.25, c=100.0, mu=mu, failure_strain=2e-4, **rate)
    if law == "drucker-prager":
        return reference.ReferenceMaterial(1e6, 0.25, c=20.0, mu=tan(radians(33.0)))
    if law == "mu-i":
        return reference.ReferenceMaterial(1e6, 0.25, c=20.0, mu=0.4, mu_2=0.7, I_0=0.3, d=0.05, rho_s=2500.0)
    return reference.ReferenceMaterial(
        1e6, 0.25, radians(45.0), radians(15.0), keys["cohesion"], radians(30.0), radians(1.0), 5.0
    )


def random_points(seed: int, opens: bool, d: int) -> Points:
    """Random points in the whole grid, some of them beside walls and some opened."""
    rng = np.random.default_rng(seed)
    points = Points(300, d)
    points.x[:] = rng.uniform((0.006, -0.194, 0.006)[:d], (0.99, 0.49, 0.49)[:d], (300, d))
    points.x[:20, 0] = rng.uniform(0.006, 0.02, 20)
    points.v[:] = rng.normal(0.0, 0.3, (300, d))
    points.m[:] = rng.uniform(1.0, 3.0, 300)
    points.V0[:] = points.m / 2000.0
    points.J[:] = rng.uniform(0.9, 1.1, 300)
    points.kind[:] = points.x[:, 1] < 0.0
    points.opening[:] = np.where(
        opens & (points.kind == 0) & (rng.uniform(size=300) < 0.2), rng.uniform(0.0, 1e-3, 300), 0.0
    )
    points.history[:, 0] = rng.uniform(0.0, 0.3, 300)
    points.history[::2, 0] = 0.0
    grad_v = np.zeros((300, 3, 3))
    grad_v[:, :d, :d] = rng.normal(0.0, 1.0, (300, d, d))
    points.grad_v = grad_v
    sigma = rng.normal(0.0, 300.0, (300, 6)) - np.array([400.0, 400.0, 400.0, 0.0, 0.0, 0.0])
    sigma[:30, 3:] = 0.0  # principal axes along those of the grid
    sigma[:15, 0] = sigma[:15, 1]  # and two or three equal principal stresses
    sigma[:5, 2] = sigma[:5, 1]
    points.sigma = np.where((points.opening > 0.0)[:, None], 0.0, sigma)
    return points


def as_reference(points: Points) -> reference.ReferencePoints:
    return reference.ReferencePoints(
        x=points.x.copy(), v=points.v.copy(), grad_v=points.grad_v,
        sigma=points.sigma[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]], J=points.J.copy(), opening=points.opening.copy(),
        m=points.m.copy(), V0=points.V0.copy(), history=points.history.copy(), material=points.kind.astype(int),
    )  # fmt: skip


SOFTENING, CONES = "mohr-coulomb-softening", ("drucker-prager", "mu-i")
AXISYMMETRIC, PIC = {"axisymmetric": True}, {"flip_fraction": 0.0}
FILTER = {  # K of ELASTIC; shear rates are about 1/s, and some points have opened further than the limit
    "filter_rate": 500.0, "filter_shear_rate": 2.5, "filter_opening": 5e-4, "filter_modulus": 1e6 / 1.5,
}  # fmt: skip
OPTIONS: list[dict] = [
    {"taylor": 0.0},
    PIC,
    {"flip_fraction": 0.95, "position_factor": 1.0},
    {"wall_impulse": False, "position_factor": 0.0},
    {"opening_strain": False},
    {"kernel_correction": False},
    {"alpha_d": 0.7, "gravity_x": 2.0},
    {"exponential_volume": True},
    FILTER,
    FILTER | {"opening_strain": False},
]
LAW_CASES: list[tuple[int, str, dict]] = [  # dimension, law of the column, changed settings
    *((2, law, change) for law in ("elastic", "mohr-coulomb") for change in ({}, AXISYMMETRIC, *OPTIONS)),
    *((2, SOFTENING, change) for change in ({}, AXISYMMETRIC, FILTER)),
    (2, "mohr-coulomb", FILTER | AXISYMMETRIC),
    *((2, RANDOM, change) for change in ({}, AXISYMMETRIC, FILTER, {"opening_strain": False})),
    pytest.param(3, RANDOM, {}, marks=pytest.mark.slow),
    *((2, law, change) for law in CONES for change in ({}, AXISYMMETRIC, FILTER, {"opening_strain": False})),
    *((2, f"mohr-coulomb, {kind}", change) for kind in ("brittle", "clay") for change in ({}, FILTER)),
    *((2, f"{law}, brittle", change) for law in CONES for change in ({}, FILTER, {"opening_strain": False})),
    (2, "mohr-coulomb-softening, cohesion", {}),
    *(pytest.param(3, f"mohr-coulomb, {kind}", {}, marks=pytest.mark.slow) for kind in ("brittle", "clay")),
    *(pytest.param(3, law, change, marks=pytest.mark.slow) for law in CONES for change in ({}, FILTER)),
    *((3, law, {}) for law in ("elastic", "mohr-coulomb")),
    pytest.param(3, SOFTENING, {}, marks=pytest.mark.slow),
    *((3, "mohr-coulomb", change | {"gravity_z": 1.0}) for change in OPTIONS),
]

SLOW = pytest.mark.slow  # each further variant is compiled for ten seconds of a core
CELL = Scheme(volumetric_strain="cell")
# those of further tests, so that they are compiled once
SCHEMES = (Scheme(affine=True), Scheme(stress_order="usf"), Scheme(basis="linear"), OTHER_SCHEME)
SLOW_SCHEMES = (
    Scheme(stress_order="musl"),
    Scheme(basis="cubic"),
    Scheme(stress_order="musl", affine=True),
    Scheme(stress_order="usf", affine=True, basis="cubic"),
    CELL,
)
IN_3D = (*SCHEMES[:2], *SLOW_SCHEMES[:2], CELL)
QUICK_IN_3D = Scheme(basis="linear")
CHANGES = (PIC, AXISYMMETRIC, FILTER)
SCHEME_CASES: list[Any] = [  # scheme, dimension, changed settings
    *((scheme, 2, change) for scheme in SCHEMES for change in CHANGES),
    *(pytest.param(scheme, 2, change, marks=SLOW) for scheme in SLOW_SCHEMES for change in CHANGES),
    *((QUICK_IN_3D, 3, change) for change in (PIC, FILTER)),
    *(pytest.param(scheme, 3, change, marks=SLOW) for scheme in IN_3D for change in (PIC, FILTER)),
    *(pytest.param(Scheme(basis="cubic"), d, {"kernel_correction": False}, marks=SLOW) for d in (2, 3)),
    pytest.param(CELL._replace(stress_order="musl", basis="linear"), 2, {"exponential_volume": True}, marks=SLOW),
]


@pytest.mark.parametrize(("d", "law", "change"), LAW_CASES, ids=str)
def test_steps_equal_the_reference(d: int, law: str, change: dict) -> None:
    compare_with_reference(d, law, change, Scheme())


@pytest.mark.parametrize(("scheme", "d", "change"), SCHEME_CASES, ids=str)
def test_steps_of_every_scheme_equal_the_reference(scheme: Scheme, d: int, change: dict) -> None:
    compare_with_reference(d, "mohr-coulomb", change, scheme)


@pytest.mark.parametrize("mu", [(0.3, 0.5), (0.0, 10.0)], ids=str)
@pytest.mark.parametrize(
    ("d", "side", "scheme"),
    [(2, CONTACT, Scheme()), (2, CONTACT, Scheme(stress_order="usf")), (2, ROLLER, Scheme()), (3, ROLLER, Scheme())],
    ids=str,
)
def test_steps_with_friction_equal_the_reference(
    d: int, side: BoundaryType, scheme: Scheme, mu: tuple[float, float]
) -> None:
    """On the floor and, with CONTACT, on the wall at x = 0, where the nodes of the corner touch both."""
    compare_with_reference(d, "elastic", {"gravity_x": -3.0}, scheme, CONTACT, side, mu)


@pytest.mark.parametrize(
    ("d", "change", "scheme"),
    [
        (2, {}, Scheme()),
        (2, {"kernel_correction": False}, Scheme()),
        (3, FILTER, Scheme()),
        (2, {}, Scheme(affine=True)),
        *(pytest.param(2, {}, Scheme(basis=basis), marks=SLOW) for basis in ("linear", "cubic")),
        pytest.param(3, {}, Scheme(stress_order="usf", affine=True, basis="cubic"), marks=SLOW),
    ],
    ids=str,
)
def test_steps_around_a_wall_equal_the_reference(d: int, change: dict, scheme: Scheme) -> None:
    """A dam in the middle of the points: its faces, edges and corners, and the nodes inside it."""
    compare_with_reference(d, "mohr-coulomb", {"gravity_x": -3.0, **change}, scheme, CONTACT, mu=(0.3, 0.4), dam=True)


def move_from_dam(points: Points, d: int) -> None:
    """Draw the points in the dam, or closer to it than particles come, again."""
    rng, gap = np.random.default_rng(3), 0.12 * H
    low, high = (np.array(ORIGIN[:d]) + H * np.array(nodes[:d]) for nodes in (DAM.low, DAM.high))
    while (near := ((points.x > low - gap) & (points.x < high + gap)).all(axis=1)).any():
        points.x[near] = rng.uniform(low - H, high + H, (near.sum(), d))
        points.x[:] = np.maximum(points.x, np.array(ORIGIN[:d]) + gap)


def boundary_masks(grid: Grid, kind: BoundaryType, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes on the low face of an axis (N...), and their held components (N..., d)."""
    shape = grid_shape(grid)
    nodes = np.broadcast_to(face(grid, kind, axis, 0).nodes, shape)
    held = {"all": True, "normal": np.arange(len(shape)) == axis, "none": False}[kind.holds]
    return nodes, nodes[..., None] & np.broadcast_to(held, (*shape, len(shape)))


def compare_with_reference(
    d: int,
    law: str,
    change: dict,
    scheme: Scheme,
    floor: BoundaryType = NO_SLIP,
    side: BoundaryType = ROLLER,
    mu: tuple[float, float] = (0.0, 0.0),
    dam: bool = False,
) -> None:
    """Compare the points after three steps; mu: friction coefficients of floor and of side or dam."""
    settings = PLAIN._replace(**change)
    points = random_points(seed=1, opens=law != "elastic", d=d)
    if law == RANDOM:  # friction angles of 22 to 44 degrees, some of them smaller than the dilatancy angle
        points.history[:, 1] = np.random.default_rng(2).uniform(-0.4, 0.5, len(points))
    if dam:
        move_from_dam(points, d)
    expected = as_reference(points)
    expected = replace(expected, C=expected.grad_v[:, :d, :d])
    grid = allocate_grid(ORIGIN[:d], H, CELLS[:d])
    shape, fixed = grid_shape(grid), np.zeros((*grid_shape(grid), d), bool)
    boundaries, walls = [], []
    for number, (kind, axis) in enumerate(((floor, 1), (side, 0))):
        nodes, held = boundary_masks(grid, kind, axis)
        fixed |= held
        boundaries.append(face(grid, kind, axis, 0))
        if kind == CONTACT:
            boundaries[-1] = boundaries[-1]._replace(wall=number, friction=mu[number])
            walls.append(reference.ReferenceWall(axis, -1, mu[number], nodes))
    inside = None
    if dam:
        box = WallBox("dam", DAM.low[:d], DAM.high[:d])
        inside = cells_in_walls(grid, (box,))
        grid = with_walls(grid, inside)
        for boundary in wall_boundaries(grid, box):
            boundaries.append(boundary._replace(wall=2, friction=mu[1]))
            if boundary.type == CONTACT:
                walls.append(reference.ReferenceWall(boundary.axis, 1 if boundary.side else -1, mu[1], boundary.nodes))
            else:
                fixed |= boundary.nodes[..., None]
        walls.sort(key=lambda wall: (wall.axis != 1, wall.axis))  # floors act first
    apply_boundaries(grid, boundaries)
    contacts = make_contacts(grid, boundaries)
    solver = Solver(points, grid, settings, body(law), body("elastic"), scheme, contacts)

    if scheme.volumetric_strain == "cell":  # where the points are sorted
        first = np.minimum(np.maximum(np.floor((points.x - ORIGIN[:d]) / H - 0.5), 0), np.array(shape) - 3)
        expected = replace(expected, cell=np.unique(first, axis=0, return_inverse=True)[1].reshape(-1))
        assert np.bincount(expected.cell).max() > 1
    reference_grid = reference.ReferenceGrid(np.array(ORIGIN[:d]), H, shape, inside)
    materials = [reference_material(law), reference_material("elastic")]
    gravity = np.array([settings.gravity_x, settings.gravity_y, settings.gravity_z])[:d]
    for _ in range(3):
        options = reference.ReferenceScheme(
            dt=solver.dt, gravity=gravity, alpha_d=settings.alpha_d, taylor=settings.taylor,
            flip_fraction=settings.flip_fraction, position=settings.position_factor,
            wall_impulse=settings.wall_impulse, opening_strain=settings.opening_strain,
            correct=settings.kernel_correction, axisymmetric=settings.axisymmetric, m_min=1e-20 * points.m.min(),
            stress_order=scheme.stress_order, basis=scheme.basis, apic=scheme.affine,
            exponential_volume=settings.exponential_volume, filter_rate=settings.filter_rate,
            filter_shear_rate=settings.filter_shear_rate, filter_opening=settings.filter_opening,
            filter_modulus=settings.filter_modulus,
        )  # fmt: skip
        assert solver.advance(1.0, max_steps=1) == -1
        expected = reference.step(expected, reference_grid, fixed, materials, options, walls)
        gap = np.full(d, WALL_GAP)
        gap[0] = settings.axis_gap if settings.axisymmetric else WALL_GAP
        expected.x[:] = np.maximum(expected.x, ORIGIN[:d] + gap * H)

    if scheme.affine:  # the matrix is stored in place of the gradient
        expected.grad_v[:, :d, :d] = expected.C
    points = by_id(solver)
    got = as_reference(points)
    for name, scale in {
        "x": 1e-13,
        "v": 1e-12,
        "grad_v": 1e-9,
        "sigma": 1e-6,
        "J": 1e-12,
        "opening": 1e-12,
    }.items():
        np.testing.assert_allclose(getattr(got, name), getattr(expected, name), rtol=1e-10, atol=scale, err_msg=name)
    np.testing.assert_allclose(got.history, expected.history, rtol=1e-10, atol=1e-13)
