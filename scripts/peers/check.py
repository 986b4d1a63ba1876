"""Steps of the Taichi versions against the literal NumPy step of the tests, in double precision.

    python -m scripts.peers.check [--steps N]

Prints the largest difference of each quantity over the largest value of that quantity; fails above 1e-9.
"""

from __future__ import annotations

import argparse
import sys
from math import radians

import numpy as np
import taichi as ti

from scripts.peers.best import Best
from scripts.peers.example import Example
from scripts.peers.scene import MASS_FLOOR, WALL_GAP, Scene, make_material
from tests.support import reference

YOUNG, NU, PHI, PSI, COHESION, DENSITY = 1e6, 0.25, 33.0, 5.0, 20.0, 2000.0
H, NODES = 0.1, {2: (14, 11), 3: (8, 7, 6)}
TOLERANCE = 1e-9


def random_scene(dim: int, n: int = 600) -> Scene:
    """Points all over the grid, some next to walls, moving, stressed, deformed, some of them open.

    Of each three points one has two equal principal stresses.
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
    return Scene(
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


def reference_points(scene: Scene) -> reference.ReferencePoints:
    """The points of a scene as the reference wants them."""
    n, d = scene.x.shape
    grad_v = np.zeros((n, 3, 3))
    grad_v[:, :d, :d] = scene.grad_v
    return reference.ReferencePoints(
        scene.x, scene.v, grad_v, scene.sigma[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]], scene.J, scene.opening, scene.m,
        scene.V0, np.zeros((n, 1)), scene.kind,
    )  # fmt: skip


def reference_step(points: reference.ReferencePoints, scene: Scene, dt: float) -> reference.ReferencePoints:
    """One literal step; points are then held off the walls."""
    materials = [
        reference.ReferenceMaterial(YOUNG, NU, radians(PHI), radians(PSI), COHESION),
        reference.ReferenceMaterial(YOUNG, NU),
    ]
    grid = reference.ReferenceGrid(scene.origin, scene.h, scene.n_nodes)
    gravity = np.zeros(scene.dim)
    gravity[1] = -scene.gravity
    scheme = reference.ReferenceScheme(dt, gravity, scene.alpha_d, m_min=MASS_FLOOR * scene.m.min())
    points = reference.step(points, grid, scene.fixed, materials, scheme)
    gap, size = WALL_GAP * scene.h, (np.array(scene.n_nodes) - 1) * scene.h
    np.clip(points.x, scene.origin + gap, scene.origin + size - gap, out=points.x)
    return points


def differences(code: type, scene: Scene, steps: int) -> dict[str, float]:
    """Largest relative difference of each quantity after `steps` steps of `code`."""
    peer, expected = code(scene), reference_points(scene)
    for _ in range(steps):
        expected = reference_step(expected, scene, peer.dt)
        peer.advance(1)
    got, d = peer.state(), scene.dim
    mine, theirs = np.argsort(got["V0"]), np.argsort(expected.V0)  # volumes tell sorted points apart
    pairs = {name: (got[name], getattr(expected, name)) for name in ("x", "v", "J", "opening")}
    pairs["grad_v"] = got["grad_v"], expected.grad_v[:, :d, :d]
    pairs["sigma"] = got["sigma"], expected.sigma[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]][:, : got["sigma"].shape[1]]
    return {name: float(np.abs(a[mine] - b[theirs]).max() / np.abs(b).max()) for name, (a, b) in pairs.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=3)
    asked = parser.parse_args()
    worst = 0.0
    for code in (Best, Example):
        for dim in (2, 3):
            ti.init(arch=ti.cpu, cpu_max_num_threads=2, default_fp=ti.f64, log_level=ti.ERROR, **code.TAICHI)
            found = differences(code, random_scene(dim), asked.steps)
            print(f"{code.__name__:8s} {dim}D ", *(f"{name} {value:.1e}" for name, value in found.items()), flush=True)
            worst = max(worst, *found.values())
    print(f"largest difference {worst:.1e}")
    sys.exit(worst > TOLERANCE)


if __name__ == "__main__":
    main()
