"""Time per step with the stress filter over that without it: two equal columns advance in turn.

    python scripts/stress/cost.py

The columns are those of `mpmcol bench` with 20,000 points, on one thread.
"""

from __future__ import annotations

import numpy as np

from mpmcol.bench.cases import GRAVITY, MATERIAL, MODELS, make_solver
from mpmcol.bench.measure import step_seconds
from mpmcol.mpm.solver import Solver
from mpmcol.mpm.threads import set_threads
from mpmcol.setup.model import FILTER_OPENING, FLOW_SHEAR_RATE

POINTS, STEPS, ROUNDS = 20_000, 40, 30
STRENGTH = 0.5  # method.filter_strength


def prepared(model: str, is_filtered: bool) -> Solver:
    """A column after its first steps, with compiled kernels."""
    solver = make_solver(model, POINTS)
    if is_filtered:
        solver.settings = solver.settings._replace(
            filter_rate=STRENGTH * MATERIAL.wave_speed / solver.grid.h,
            filter_shear_rate=FLOW_SHEAR_RATE * GRAVITY / MATERIAL.wave_speed,
            filter_opening=FILTER_OPENING,
            filter_modulus=MATERIAL.bulk_modulus,
        )
    step_seconds(solver, STEPS)
    return solver


def main() -> None:
    """Print the median ratio of each model."""
    set_threads(1)
    for model in MODELS:
        plain, filtered = prepared(model, False), prepared(model, True)
        ratios = [step_seconds(filtered, STEPS) / step_seconds(plain, STEPS) for _ in range(ROUNDS)]
        print(f"{model}: {np.median(ratios):.3f}", flush=True)


if __name__ == "__main__":
    main()
