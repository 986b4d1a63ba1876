"""Random cases of the soak: properties of the draw, and detection of inconsistent results."""

from __future__ import annotations

import random
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mpmcol.case import load_case
from mpmcol.mpm.constitutive import LAWS
from mpmcol.sweep.runs import PlannedRun
from tests.soak.trials.random_cases import PACE, SECONDS, draw_case, inconsistencies


def test_draws_are_reproducible_cheap_and_of_all_kinds() -> None:
    cases = [draw_case(random.Random(seed))[0] for seed in range(60)]
    assert [draw_case(random.Random(seed))[0] for seed in range(3)] == cases[:3]
    assert {case.geometry.model for case in cases} == {"plane", "axisymmetric", "quarter", "full"}
    assert {case.material.law for case in cases} == set(LAWS)
    assert max(case.geometry.a for case in cases) > 5.0
    assert {case.geometry.model for case in cases if case.geometry.slope_deg} >= {"plane"}
    for case in cases:
        assert PlannedRun({}, case, Path()).work * PACE[case.geometry.dimension] < SECONDS


def result(**changes: Any) -> SimpleNamespace:
    """The results that are checked of a run; consistent except for the changes."""
    zeta = {"front_max": 1.1, "front_connected": 1.0, "front_height": 0.9} | changes.get("zeta", {})
    ledger = {"potential": [1.0, 0.5], "elastic": [0.1, 0.0], "kinetic": [0.0, 0.2], "residual": [0.0, 1e-12]}
    history = {name: np.array(changes.get(name, values)) for name, values in ledger.items()}
    history |= {"stage": np.array(["collapse"] * 2), "height": np.array(changes.get("height", [0.09, 0.05]))}
    arrays = {"mass": np.ones(3), "id": np.arange(3), "stress": np.zeros((3, 6))}
    last = arrays | {name: np.array(changes[name]) for name in arrays if name in changes}
    return SimpleNamespace(
        measure=lambda: SimpleNamespace(zeta=zeta, beta=changes.get("beta", 0.5)),
        history=history,
        summary={"warnings": changes.get("warnings", [])},
        snapshot=lambda index: SimpleNamespace(arrays=last if index else arrays),
    )


def test_a_consistent_result_passes() -> None:
    assert list(inconsistencies(load_case("coarse-channel"), result())) == []
    reported = {"zeta": {"front_max": 3.5}, "warnings": ["detached particles ahead of the flow front: ..."]}
    assert list(inconsistencies(load_case("coarse-channel"), result(**reported))) == []


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"zeta": {"front_height": np.nan}}, "are not finite"),
        ({"beta": np.inf}, "are not finite"),
        ({"zeta": {"front_connected": 30.0}}, "its front is at 30 r_i"),
        ({"zeta": {"front_max": 3.5}}, "detached particles are at 3.5 r_i"),
        ({"beta": 1.2}, "its height is 1.2 h_i"),
        ({"beta": 0.0}, "its height is 0 h_i"),
        ({"height": [0.09, 0.11]}, "at most 1.22"),
        ({"residual": [0.0, 1e-3]}, "of the energy is unaccounted for"),
        ({"residual": [0.0, np.nan]}, "of the energy is unaccounted for"),
        ({"kinetic": [0.0, 0.7]}, "its kinetic energy exceeds the energy released"),
        ({"mass": [1.0, 1.0, 2.0]}, "the points' mass changed"),
        ({"id": [0, 1, 1]}, "the points' id changed"),
        ({"stress": [[np.nan] * 6] * 3}, "the points' stress are not finite"),
    ],
)
def test_inconsistent_results_are_detected(changes: dict[str, Any], message: str) -> None:
    assert message in "; ".join(inconsistencies(load_case("coarse-channel"), result(**changes)))
