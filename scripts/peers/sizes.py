"""Time per point and step of 2 million points over that of 20 thousand: both columns advance in turn, on one thread.

python -m scripts.peers.sizes
"""

from __future__ import annotations

import numpy as np

from mpmcol.bench.cases import make_solver
from mpmcol.bench.measure import step_seconds
from mpmcol.mpm.threads import set_threads

SMALL, LARGE, STEPS = 20_000, 2_000_000, 3
ROUNDS = 9


def main() -> None:
    """Print the times (ns) and the median and the quartiles of their ratios."""
    set_threads(1)
    for model in ("plane", "quarter"):
        small, large = make_solver(model, SMALL), make_solver(model, LARGE)
        more = STEPS * LARGE // SMALL  # so that both take equally long
        step_seconds(small, more)
        step_seconds(large, STEPS)
        pairs = [
            (
                step_seconds(small, more) / more / len(small.points),
                step_seconds(large, STEPS) / STEPS / len(large.points),
            )
            for _ in range(ROUNDS)
        ]
        times = 1e9 * np.median(pairs, axis=0)
        low, median, high = np.quantile([of_large / of_small for of_small, of_large in pairs], [0.25, 0.5, 0.75])
        print(f"{model}: {times[0]:.1f}, {times[1]:.1f} ns; ratio {median:.2f} ({low:.2f} to {high:.2f})", flush=True)


if __name__ == "__main__":
    main()
