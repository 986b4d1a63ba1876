"""Scatter between neighbouring spacings: how much of a result depends on where the nodes lie."""

from __future__ import annotations

from mpmcol.studies.pareto.score import BETA, ZETA

# Relative standard deviation of runs whose r_i / h differ by one, by r_i / h and quantity: pooled over two columns and
# two numbers of points per cell (scripts/pareto/neighbouring-spacings.toml).
NODE_SCATTER = {
    14.0: {ZETA: 0.020, BETA: 0.0016},
    20.0: {ZETA: 0.024, BETA: 0.0014},
    28.0: {ZETA: 0.0080, BETA: 0.0009},
    40.0: {ZETA: 0.0031, BETA: 0.0016},
}


def node_scatter(quantity: str, cells: float) -> float:
    """Relative standard deviation of a quantity at r_i / h = cells: that of the next coarser grid that was measured."""
    studied = max((one for one in NODE_SCATTER if one <= cells), default=min(NODE_SCATTER))
    return NODE_SCATTER[studied][quantity]
