"""`python -m mpmcol.sweep.compile_cache CASE...`: compile the kernels of cases once before many runs start."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mpmcol.sweep.runs import PlannedRun


def kernels_of(point: PlannedRun) -> tuple[object, ...]:
    """What decides which kernels a run needs: points of equal value share them."""
    case, method = point.case, point.case.method
    scheme = method.basis, method.stress_order, method.transfer == "apic"
    return case.geometry.dimension, case.material.law, case.stages.equilibrate.law, *scheme


def smallest_of_each(points: Sequence[PlannedRun]) -> list[PlannedRun]:
    """The least point for each set of kernels."""
    by_kernels = {kernels_of(point): point for point in sorted(points, key=lambda point: point.work, reverse=True)}
    return list(by_kernels.values())


def warm(source: str) -> None:
    """Compile, or load if they are kept, the kernels of both stages of a case."""
    from mpmcol.case import load_case
    from mpmcol.mpm.solver import Solver
    from mpmcol.setup.model import build_model

    model = build_model(load_case(source))
    for stage in (model.equilibrate, model.collapse):
        Solver(model.points, model.grid, stage.settings, stage.column, model.base, model.scheme).prepare()


if __name__ == "__main__":
    for name in sys.argv[1:]:
        warm(name)
