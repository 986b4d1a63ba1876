"""Time steps above the stability limit of a single particle in 1D, plane strain, axisymmetry and 3D."""

from __future__ import annotations

from mpmcol.failure_modes.scenarios.single_particle import stability_scenario
from mpmcol.setup.stability_limit import BETWEEN, FREE, SMOOTH, LonePoint

PARTICLES = {
    "1d": (LonePoint((BETWEEN, BETWEEN), nu=0.0), "one dimension (nu = 0)"),
    "plane": (LonePoint((BETWEEN, BETWEEN)), "plane strain"),
    "axisymmetric": (
        LonePoint((1.501, BETWEEN), axisymmetric=True, walls=(SMOOTH, FREE)),
        "axisymmetry, 1.5 h from the axis",
    ),
    "3d": (LonePoint((BETWEEN, BETWEEN, BETWEEN)), "three dimensions"),
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
