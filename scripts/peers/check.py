"""Compare steps of the Taichi and Warp codes with the NumPy reference of the tests, in double precision.

    python -m scripts.peers.check [--steps N]

Prints the largest difference of each quantity relative to its largest value; fails above 1e-9.
"""

from __future__ import annotations

import argparse
import sys
from math import radians

import numpy as np
import taichi as ti

from scripts.peers.example import Example
from scripts.peers.optimized import Optimized
from scripts.peers.problem import MASS_FLOOR, WALL_GAP, Problem, make_material
from scripts.peers.warp_example import WarpExample
from tests.support import reference

YOUNG, NU, PHI, PSI, COHESION, DENSITY = 1e6, 0.25, 33.0, 5.0, 20.0, 2000.0
H, NODES = 0.1, {2: (14, 11), 3: (8, 7, 6)}
TOLERANCE = 1e-9


def random_problem(dim: int, n: int = 600) -> Problem:
    """Random points in the whole grid, some of them beside walls and some opened.

    Every third point has two equal principal stresses.
    """
    rng = np.random.default_rng(1)
    origin, shape = np.array([0.0, -0.2, 0.0][:dim]), NODES[dim]
    x = rng.uniform(origin + WALL_GAP * H, origin + (np.array(shape) - 1.0 - WALL_GAP) * H, (n, dim))
    x[:40, 0] = rng.uniform(0.1 * H, 0.4 * H, 40)
    kind = (x[:, 1] < 0.0).astype(np.int32)
    opening = np.where((kind == 0) & (rng.uniform(size=n) < 0.2), rng.uniform(0.0, 1e-3, n), 0.0)
    sigma = rng.normal(0.0, 300.0, (n, 6)) - np.array([400.0, 400.0, 400.0, 0.0, 0.0, 0.0])
    sigma[:, 4:] *= dim - 2
    sigma[::3, 2], sigma[::3, 3:] = sigma[::3, 0], 0.0
    sigma[opening > 0.0] = 0.0
    m = rng.uniform(1.0, 3.0, n)
    return Problem(
        x=x, v=rng.normal(0.0, 0.3, (n, dim)), grad_v=rng.normal(0.0, 1.0, (n, dim, dim)), sigma=sigma, m=m,
        V0=m / DENSITY, J=rng.uniform(0.9, 1.1, n), opening=opening, kind=kind, origin=origin, h=H,
        fixed=_walls(shape), material=make_material(YOUNG, NU, PHI, DENSITY, PSI, COHESION), alpha_d=0.1, cfl=0.3,
    )  # fmt: skip


def _walls(shape: tuple[int, ...]) -> np.ndarray:
    """Rough floor; planes of symmetry where x or z is zero."""
    fixed = np.zeros((*shape, len(shape)), bool)
    fixed[0, ..., 0] = fixed[:, 0] = True
    if len(shape) == 3:
        fixed[:, :, 0, 2] = True
    return fixed


def reference_points(problem: Problem) -> reference.ReferencePoints:
    """The points of a problem in the form of the reference."""
    n, d = problem.x.shape
    grad_v = np.zeros((n, 3, 3))
    grad_v[:, :d, :d] = problem.grad_v
    return reference.ReferencePoints(
        x=problem.x, v=problem.v, grad_v=grad_v, sigma=problem.sigma[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]],
        J=problem.J, opening=problem.opening, m=problem.m, V0=problem.V0, history=np.zeros((n, 1)),
        material=problem.kind,
    )  # fmt: skip


def reference_step(points: reference.ReferencePoints, problem: Problem, dt: float) -> reference.ReferencePoints:
    """One step of the reference, with the positions then limited as in the codes."""
    materials = [
        reference.ReferenceMaterial(YOUNG, NU, radians(PHI), radians(PSI), COHESION),
        reference.ReferenceMaterial(YOUNG, NU),
    ]
    grid = reference.ReferenceGrid(problem.origin, problem.h, problem.n_nodes)
    gravity = np.zeros(problem.dim)
    gravity[1] = -problem.gravity
    scheme = reference.ReferenceScheme(dt, gravity, problem.alpha_d, m_min=MASS_FLOOR * problem.m.min())
    points = reference.step(points, grid, problem.fixed, materials, scheme)
    gap, size = WALL_GAP * problem.h, (np.array(problem.n_nodes) - 1) * problem.h
    np.clip(points.x, problem.origin + gap, problem.origin + size - gap, out=points.x)
    return points


def differences(code: type, problem: Problem, steps: int) -> dict[str, float]:
    """Largest relative difference of each quantity after `steps` steps of `code`."""
    peer, expected = code(problem), reference_points(problem)
    for _ in range(steps):
        expected = reference_step(expected, problem, peer.dt)
        peer.advance(1)
    got, d = peer.state(), problem.dim
    order, order_expected = np.argsort(got["V0"]), np.argsort(expected.V0)  # volumes identify points
    pairs = {name: (got[name], getattr(expected, name)) for name in ("x", "v", "J", "opening")}
    pairs["grad_v"] = got["grad_v"], expected.grad_v[:, :d, :d]
    pairs["sigma"] = got["sigma"], expected.sigma[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]][:, : got["sigma"].shape[1]]
    return {name: float(np.abs(a[order] - b[order_expected]).max() / np.abs(b).max()) for name, (a, b) in pairs.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=3)
    options = parser.parse_args()
    worst = 0.0
    for code in (Optimized, Example, WarpExample):
        for dim in (2, 3):
            if code is not WarpExample:
                ti.init(arch=ti.cpu, cpu_max_num_threads=2, default_fp=ti.f64, log_level=ti.ERROR, **code.TAICHI)
            found = differences(code, random_problem(dim), options.steps)
            print(f"{code.__name__:11s} {dim}D ", *(f"{name} {value:.1e}" for name, value in found.items()), flush=True)
            worst = max(worst, *found.values())
    print(f"largest difference {worst:.1e}")
    sys.exit(worst > TOLERANCE)


if __name__ == "__main__":
    main()
