"""Time per step of each law over that of Mohr-Coulomb: two equal columns advance in turn.

    python scripts/laws/cost.py

The columns are those of `mpmcol bench`, on one thread. Prints the median and the quartiles of the ratios.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.bench.cases import MATERIAL, make_solver
from mpmcol.bench.measure import step_seconds
from mpmcol.mpm.constitutive import LAWS
from mpmcol.mpm.solver import Body, Solver
from mpmcol.mpm.threads import set_threads

POINTS = {"plane": 20_000, "quarter": 40_000}
STEPS, ROUNDS = 40, 30
ELASTIC: dict[str, Any] = MATERIAL.model_dump(include={"density", "youngs_modulus", "poissons_ratio"})
SAND: dict[str, Any] = {"law": "mohr-coulomb", "friction_deg": 33.0}
MATERIALS: dict[str, dict[str, Any]] = {
    "drucker-prager": {"law": "drucker-prager", "friction_deg": 33.0},
    "mu-i": {
        "law": "mu-i", "mu_s": 0.5446, "mu_2": 0.8062, "I_0": 0.279, "grain_diameter": 0.32e-3, "grain_density": 2700.0,
    },
    "mohr-coulomb, cut-off": SAND | {"cohesion": 20.0, "tension": 10.0},
    "mohr-coulomb-random": SAND | {
        "law": "mohr-coulomb-random", "friction_variation": 0.2, "correlation_length": 0.05,
    },
}  # fmt: skip


def prepared(model: str, keys: dict[str, Any]) -> Solver:
    """A column with a material after its first steps, with compiled kernels."""
    solver, law = make_solver(model, POINTS[model]), LAWS[keys["law"]]
    material = law.Material(**ELASTIC | keys)
    solver.points.history[:] = material.initial_history(solver.points.x)
    body = Body(law, law.make_params(material), solver.bodies[0].wave_speed2)
    solver = Solver(solver.points, solver.grid, solver.settings, body, solver.bodies[1])
    step_seconds(solver, STEPS)
    return solver


def main() -> None:
    """Print the ratios of each model and law."""
    set_threads(1)
    for model in POINTS:
        for name, keys in MATERIALS.items():
            sand, other = prepared(model, SAND), prepared(model, keys)
            ratios = [step_seconds(other, STEPS) / step_seconds(sand, STEPS) for _ in range(ROUNDS)]
            low, median, high = np.percentile(ratios, (25.0, 50.0, 75.0))
            print(f"{model}, {name}: {median:.3f} ({low:.3f} to {high:.3f})", flush=True)


if __name__ == "__main__":
    main()
