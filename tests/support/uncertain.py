"""Uncertain inputs and plans without runs, and runs whose results follow from a formula."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.studies.uncertainty.inputs import UncertainInput, parse_inputs
from mpmcol.studies.uncertainty.plan import UncertaintyPlan, plan_study
from mpmcol.studies.uncertainty.sampling import draw_sample
from mpmcol.sweep.engine import Outcome
from mpmcol.sweep.task import TaskResult

FRICTION, DENSITY, ASPECT = "material.friction_deg", "material.density", "geometry.aspect"
THREE = (f"{FRICTION}=normal:33,1.5", f"{DENSITY}=uniform:1500,1700", f"{ASPECT}=triangular:1,2,4")


def inputs_of(*options: str) -> list[UncertainInput]:
    """Inputs from valid options."""
    inputs, seeds, problems = parse_inputs(options)
    assert not problems and not seeds, problems
    return inputs


def sampled(inputs: list[UncertainInput], count: int, seed: int = 0) -> np.ndarray:
    """A Latin hypercube of the inputs, (count, inputs)."""
    sample = draw_sample(inputs, 0.5, count, seed)
    return np.column_stack([sample.numbers(one.key) for one in inputs])


def planned(
    out: Path, *options: str, samples: int = 16, accuracy: float | None = None, corrected: bool = False
) -> UncertaintyPlan:
    """A plan for the case coarse-channel."""
    return plan_study(
        "coarse-channel", [], inputs_of(*options), out,
        samples=samples, seed=0, accuracy=accuracy, corrected=corrected,
    )  # fmt: skip


def ended(plan: UncertaintyPlan, result: Callable[[Mapping[str, Any]], Mapping[str, Any]]) -> list[Outcome]:
    """Outcomes of the runs with results that follow from their inputs."""
    for run in plan.runs:
        run.folder.mkdir(parents=True, exist_ok=True)
        record = {"schema": 1, "status": "done", "at_rest": True, **result(run.inputs)}
        (run.folder / "result.json").write_text(json.dumps(record))
    return [Outcome(run, TaskResult("done", 1)) for run in plan.runs]
