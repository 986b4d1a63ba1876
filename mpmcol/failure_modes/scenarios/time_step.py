"""Time steps above the stability limit of a single particle in 1D, plane strain, axisymmetry and 3D."""

from __future__ import annotations

from mpmcol.failure_modes.scenarios.single_particle import stability_scenario
from mpmcol.mpm.boundary import FREE, ROLLER
from mpmcol.setup.stability_limit import MIDWAY, SingleParticle

PARTICLES = {
    "1d": (SingleParticle((MIDWAY, MIDWAY), nu=0.0), "one dimension (nu = 0)"),
    "plane": (SingleParticle((MIDWAY, MIDWAY)), "plane strain"),
    "axisymmetric": (
        SingleParticle((1.501, MIDWAY), axisymmetric=True, faces=(ROLLER, FREE)),
        "axisymmetry, 1.5 h from the axis",
    ),
    "3d": (SingleParticle((MIDWAY, MIDWAY, MIDWAY)), "three dimensions"),
}

SCENARIOS = tuple(
    stability_scenario(
        f"time-step-{name}",
        f"A single particle half-way between nodes in {kind}: its strain overshoots in every step and grows.",
        particle,
        "time.cfl below 0.67 in 3D and 0.73 in 2D (nu = 0.2); the default 0.5 leaves a margin of a quarter",
    )
    for name, (particle, kind) in PARTICLES.items()
)
