"""Steady flow of an infinite layer with the mu(I) law: the Bagnold profile.

On a slope th with mu_s < tan(th) < mu_2 the inertial number is the same at all depths,
I = I_0 (tan th - mu_s) / (mu_2 - tan th), and the velocity is

    u(y) = 2/3 (I / d) sqrt(rho / rho_s g cos th) (H^1.5 - (H - y)^1.5)

with the densities rho of the material and rho_s of the grains (GDR MiDi 2004, doi:10.1140/epje/i2003-10153-0). The
layer of eight cells is infinite (a grid that is periodic along x) under the gravity of a case with this
geometry.slope_deg. It starts at 90 % of these velocities and approaches them in some seconds. Later, on a finer grid,
or at 30 degrees, waves arise from the noise of the stresses and end the uniform flow.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

import mpmcol
from mpmcol.failure_modes.toolkit import PLAIN, advance_to, by_id, lattice, points_at
from mpmcol.mpm.constitutive import mu_i
from mpmcol.mpm.particles import COLUMN
from mpmcol.mpm.solver import Body, Solver
from tests.support.periodic_layer import PERIOD, PeriodicSolver, periodic_grid

CELLS = 8
BEADS = {
    "density": 1550.0, "youngs_modulus": 1e5, "poissons_ratio": 0.2, "mu_s": 0.48, "mu_2": 0.73, "I_0": 0.279,
    "grain_diameter": 0.7e-3, "grain_density": 2500.0,
}  # fmt: skip
UNIT = {
    "density": 1.0, "youngs_modulus": 330.0, "poissons_ratio": 0.2, "mu_s": 0.38, "mu_2": 0.64, "I_0": 0.3,
    "grain_diameter": 0.04, "grain_density": 1.0,
}  # fmt: skip


class Layer(NamedTuple):
    """A layer on a slope: material, angle (radians), depth (m), gravity (m/s2)."""

    material: mu_i.Material
    slope: float
    depth: float
    gravity: float

    def speed(self, y: Any) -> Any:
        """The Bagnold profile at heights y, m/s."""
        m, tangent = self.material, np.tan(self.slope)
        number = m.I_0 * (tangent - m.mu_s) / (m.mu_2 - tangent)
        rate = number / m.grain_diameter * np.sqrt(m.density / m.grain_density * self.gravity * np.cos(self.slope))
        return 2.0 / 3.0 * rate * (self.depth**1.5 - (self.depth - y) ** 1.5)


def flowing(layer: Layer, share: float) -> Solver:
    """The layer at `share` of the speed of steady flow, with the stresses of that flow."""
    h, material, g = layer.depth / CELLS, layer.material, layer.gravity
    points = points_at(lattice((PERIOD * h, 0.0), (2 * PERIOD * h, layer.depth), h / 2), h / 2, kind=COLUMN)
    points.m[:] = material.density * points.V0
    y = points.x[:, 1]
    points.v[:, 0] = share * layer.speed(y)
    normal = material.density * g * np.cos(layer.slope) * (layer.depth - y)
    points.sigma = np.stack([-normal, -normal, -normal, np.tan(layer.slope) * normal], axis=1)
    body = Body(mu_i, mu_i.make_params(material), material.wave_speed**2)
    slope = [f"geometry.slope_deg={np.degrees(layer.slope)}", f"geometry.gravity={g}"]
    gravity_x, gravity_y, _ = mpmcol.load_case("inclined-channel", slope).geometry.gravity_vector
    speed = 100.0 * layer.speed(layer.depth)
    settings = PLAIN._replace(gravity_x=gravity_x, gravity_y=gravity_y, free_speed=speed)
    return PeriodicSolver(points, periodic_grid(h, CELLS + 4, periods=1000), settings, body, body)


def test_the_formula_has_the_published_values() -> None:
    for degrees, speed in ((27.0, 0.2343), (28.0, 0.4542), (29.0, 0.7331), (30.0, 1.1000)):
        layer = Layer(mu_i.Material(**BEADS), np.radians(degrees), 0.02, 9.81)
        assert layer.speed(0.02) == pytest.approx(speed, abs=2e-4)
    assert Layer(mu_i.Material(**UNIT), 0.43, 1.0, 1.0).speed(1.0) == pytest.approx(2.06631, abs=1e-5)


@pytest.mark.parametrize(("degrees", "duration"), [(27.0, 2.0), (28.0, 3.0), (29.0, 2.5)])
def test_a_layer_reaches_the_bagnold_profile(degrees: float, duration: float) -> None:
    layer = Layer(mu_i.Material(**BEADS), np.radians(degrees), 0.02, 9.81)
    solver = flowing(layer, 0.9)
    y = by_id(solver).x[:, 1].copy()
    advance_to(solver, duration)
    v, expected = by_id(solver).v[:, 0], layer.speed(y)
    assert np.sqrt(np.mean((v - expected) ** 2)) < 0.02 * expected.max()
    assert v.mean() == pytest.approx(expected.mean(), rel=0.02)
