"""Measured quantities in reports are those that `mpmcol measure` prints."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from mpmcol.case import load_case
from mpmcol.cli.measure_text import text_of
from mpmcol.report.measures import ANGLE, measures
from tests.support.synthetic_run import SHAPE, deposit


def results(**changed: Any) -> Any:
    """A run with these values of its result."""
    values = replace(deposit(1.5), **changed).scalars()
    summary = {**values, "stop_time": None, "time_over_tau": 5.0, "at_rest": True}
    return SimpleNamespace(summary=summary, shape=SHAPE, case=load_case("coarse-channel"))


def printed(shape: Any = SHAPE, **changed: Any) -> str:
    """The output of `mpmcol measure`."""
    measured: Any = SimpleNamespace(
        status="done", at_rest=True, time=1.0, is_deposit=True, shape=shape, stop_time=None, energy_released=None,
        friction_from_repose=None, measurement=replace(deposit(1.5), **changed), scores=[], profiles=[],
    )  # fmt: skip
    return text_of(measured)


@pytest.mark.parametrize(("radius", "text"), [(0.0, "0 mm"), (0.02, "20 mm"), (None, "none")])
def test_the_undisturbed_radius_is_none_only_where_it_is_unknown(radius: float | None, text: str) -> None:
    (found,) = [one.text for one in measures(results(undisturbed_radius=radius)) if one.name == "Undisturbed radius"]
    assert found == text
    (line,) = [one for one in printed(undisturbed_radius=radius).splitlines() if one.startswith("undisturbed")]
    assert ("none" in line) is (text == "none") and (radius is None or float(line.split()[2]) == 1e3 * radius)


def test_two_flanks_have_their_angles_beside_the_mean() -> None:
    angles = {"repose_angle_deg": 28.0, "repose_low_x_deg": 26.0, "repose_high_x_deg": 30.0}
    (found,) = [one.text for one in measures(results(**angles)) if one.name == ANGLE]
    assert found == "28.0° (mean of 26.0° and 30.0°)"
    assert "28.0 deg (mean; toward smaller x 26.0, toward larger x 30.0)" in printed(**angles)


def test_a_cylinder_is_called_so() -> None:
    assert "axisymmetric, cylinder, a = 1" in printed(replace(SHAPE, model="axisymmetric"))
    assert "plane, one-sided, a = 1" in printed()
