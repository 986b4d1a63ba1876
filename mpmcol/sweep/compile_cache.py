"""Kernels that runs share, compiled once before several runs start."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mpmcol.sweep.runs import PlannedRun


def kernel_variant(run: PlannedRun) -> tuple[object, ...]:
    """Identify the compiled kernels that a run needs: runs with equal values share them."""
    case, method = run.case, run.case.method
    scheme = method.basis, method.stress_order, method.transfer == "apic", method.volumetric_strain
    laws = case.material.law, case.base_material.law, case.stages.equilibrate.law
    return case.geometry.dimension, bool(case.walls), *laws, *scheme


def smallest_per_variant(runs: Sequence[PlannedRun]) -> list[PlannedRun]:
    """The smallest run of each kernel variant."""
    by_variant = {kernel_variant(run): run for run in sorted(runs, key=lambda run: run.cost, reverse=True)}
    return list(by_variant.values())


def compile_kernels(source: str, overrides: Sequence[str] = ()) -> None:
    """Compile the kernels of both stages of a case, or load them from the cache."""
    from mpmcol.case import load_case
    from mpmcol.setup.model import build_model, make_solver

    model = build_model(load_case(source, overrides))
    for stage in (model.equilibrate, model.collapse):
        make_solver(model, stage).prepare()
