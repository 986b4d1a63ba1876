"""Time per step of other schemes over that of the default: equal columns advance in turn.

    python -m scripts.peers.schemes

On one thread, from the release on, with the stress assigned.
"""

from __future__ import annotations

import numpy as np

from mpmcol.bench.measure import step_seconds
from mpmcol.case import load_case
from mpmcol.mpm.solver import Solver
from mpmcol.mpm.threads import set_threads
from mpmcol.setup.model import build_model, make_solver, set_boundaries

CASES = {"channel": ("0.0045", 40), "quarter": ("0.0115", 20)}  # case -> spacing (m), steps of a round
SCHEMES = {
    "linear": "method.basis=linear",
    "cubic": "method.basis=cubic",
    "apic": "method.transfer=apic",
    "tpic": "method.transfer=tpic",
    "usf": "method.stress_order=usf",
    "musl": "method.stress_order=musl",
}
ROUNDS = 15


def solver_of(case: str, *overrides: str) -> Solver:
    """A solver with the gate open, after its first steps, with compiled kernels."""
    model = build_model(load_case(case, ["stages.initial_stress=k0", *overrides]))
    solver = make_solver(model, model.collapse)
    set_boundaries(solver.grid, model.discretization, np.inf)
    step_seconds(solver, 50)
    return solver


def main() -> None:
    """Print the median and the quartiles of the ratios of each scheme."""
    set_threads(1)
    for case, (spacing, steps) in CASES.items():
        default = solver_of(case, f"grid.spacing={spacing}")
        for name, override in SCHEMES.items():
            other = solver_of(case, f"grid.spacing={spacing}", override)
            ratios = [step_seconds(other, steps) / step_seconds(default, steps) for _ in range(ROUNDS)]
            low, median, high = np.quantile(ratios, [0.25, 0.5, 0.75])
            print(f"{case} {name}: {median:.2f} ({low:.2f} to {high:.2f})", flush=True)


if __name__ == "__main__":
    main()
