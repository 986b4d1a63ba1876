"""Cost of a boundary: time of a step with it over that without, from the same state, in interleaved pairs.

python scripts/boundaries/wall_cost.py --part dam --pairs 60     # or floor, forces, side-walls; also --dimension 3

dam: a wall that has stopped the flow. floor: friction of the floor instead of no slip. forces: recorded forces.
side-walls: friction of side walls, in plane strain only.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from mpmcol.case import load_case
from mpmcol.mpm.solver import Solver
from mpmcol.mpm.threads import set_threads
from mpmcol.setup.model import build_model, make_solver, set_boundaries

START = 0.2  # s after the release: the dam has stopped the flow
CASES = {  # dimension -> case, overrides, walls, steps of a pair
    2: ("frictional-floor", ("grid.spacing=0.0015",), "walls=[{from=0.15, to=0.18, height=0.03}]", 30),
    3: (
        "lube-quarter",
        ("grid.spacing=0.0049", "geometry.base=rigid", "method.wall_impulse=true"),
        "walls=[{from=0.1666, to=0.196, height=0.05}]",
        10,
    ),
}
NO_SLIP = ("friction={}", "output.wall_forces=false")
PARTS = {  # part -> overrides without it, and with it
    "floor": (NO_SLIP, (*NO_SLIP, "friction.floor=0.268")),
    "forces": (NO_SLIP, ("friction={}", "output.wall_forces=true")),
    "side-walls": (NO_SLIP, (*NO_SLIP, "friction.side_walls=0.4", "friction.channel_width=0.2")),
}


def solver_of(case: str, *overrides: str) -> Solver:
    """The solver of a case with the gate open."""
    model = build_model(load_case(case, [*overrides, "stages.initial_stress=k0"]))
    solver = make_solver(model, model.collapse)
    set_boundaries(solver.grid, model.discretization, np.inf)
    return solver


def seconds(solver: Solver, rows: np.ndarray, steps: int) -> float:
    """Processor time of a step from the state `rows` of the points, s."""
    solver.points.rows[:] = rows
    solver.tiles = None
    solver.reset_time_step()
    solver.advance(np.inf, max_steps=2)
    first, began = solver.steps, time.process_time()
    while solver.steps - first < steps:
        solver.advance(np.inf, max_steps=steps - (solver.steps - first))
    return (time.process_time() - began) / steps


def main() -> None:
    """Print the minimum of each and the median of the ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dimension", type=int, choices=CASES, default=2)
    parser.add_argument("--part", choices=("dam", *PARTS), default="dam")
    parser.add_argument("--pairs", type=int, default=40)
    arguments = parser.parse_args()
    set_threads(1)
    case, overrides, walls, steps = CASES[arguments.dimension]
    before, after = PARTS.get(arguments.part, ((), (walls,)))
    without, with_part = solver_of(case, *overrides, *before), solver_of(case, *overrides, *after)
    while with_part.time < START:
        with_part.advance(START)
    rows = with_part.points.rows.copy()
    times = (
        1e9
        / len(rows)
        * np.array([(seconds(without, rows, steps), seconds(with_part, rows, steps)) for _ in range(arguments.pairs)])
    )
    ratios = times[:, 1] / times[:, 0]
    print(
        f"{len(rows)} points, {len(ratios)} pairs: {times[:, 0].min():.1f} and {times[:, 1].min():.1f} ns per point; "
        f"ratio of the minima {times[:, 1].min() / times[:, 0].min():.3f}, median {np.median(ratios):.3f}, "
        f"quartiles {np.quantile(ratios, 0.25):.3f} and {np.quantile(ratios, 0.75):.3f}"
    )


if __name__ == "__main__":
    main()
