"""Measured quantities in reports are those that `mpmcol measure` prints."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from mpmcol.cli.measure_text import text_of
from mpmcol.measure import Erosion
from mpmcol.report.measures import ANGLE, comparison_table, energy_measures, key_figures, measures
from mpmcol.report.model import Figure
from tests.support.synthetic_run import SHAPE, deposit

EROSION = Erosion(eroded_mass=3.2, eroded_depth=0.006, surface_drop=0.002, deposit_front=2.5 * SHAPE.r_i)


def results(erosion: Erosion | None = None, **changed: Any) -> Any:
    """A run with these values of its result."""
    values = replace(deposit(1.5), **changed).scalars()
    summary = {**values, "stop_time": None, "time_over_tau": 5.0, "at_rest": True}
    return SimpleNamespace(summary=summary, shape=SHAPE, fall_time=SHAPE.fall_time(9.81), erosion=erosion)


def printed(shape: Any = SHAPE, erosion: Erosion | None = None, **changed: Any) -> str:
    """The output of `mpmcol measure`."""
    measured: Any = SimpleNamespace(
        status="done", at_rest=True, time=1.0, is_deposit=True, shape=shape, stop_time=None, energy_released=None,
        friction_from_repose=None, measurement=replace(deposit(1.5), **changed), scores=[], profiles=[],
        erosion=erosion, energy_unit="J per metre of width", wall_forces=None,
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


def test_a_bed_adds_its_erosion_and_the_runout_over_its_old_surface() -> None:
    text = printed(replace(SHAPE, bed=0.01, bed_density=1500.0), EROSION)
    assert "bed: 3.2 kg per metre of width moved, down to a depth of 6 mm" in text
    assert "zeta 1.500; at most 2 mm lower" in text
    assert "its whole thickness" not in text and "nowhere lower" not in text
    (runout,) = [one for one in measures(results(EROSION)) if one.name.startswith("Runout over the old surface")]
    assert runout.normalised == "zeta = 1.500"


def test_the_spread_is_no_uncertainty_of_the_front() -> None:
    (found,) = [one.text for one in measures(results()) if "between the definitions of the front" in one.name]
    (line,) = [line for line in printed().splitlines() if line.startswith("spread of zeta")]
    assert line.split()[3] == found and line.endswith("(between the definitions of the front)")


@pytest.mark.parametrize(("walls", "transfer"), [(0.002, 0.009), (-0.08, 0.1)])
def test_walls_and_transfer_have_their_sum(walls: float, transfer: float) -> None:
    run: Any = SimpleNamespace(summary={"dissipation": {"walls": walls, "transfer": transfer}})
    found = {one.name: one.text for one in energy_measures(run)}
    assert found["Walls and transfer together"] == f"{100.0 * (walls + transfer):.1f} %"


def test_runs_with_and_without_a_bed_have_one_table() -> None:
    plain, with_bed = measures(results()), measures(results(EROSION))
    table = comparison_table(("plain", "bed"), [plain, with_bed], "")
    assert len(table.rows) == len(with_bed) == len(plain) + 4
    (row,) = [row for row in table.rows if row[0].startswith("Mass of the bed")]
    assert row[1:] == ["none", "3.2 kg"]


def test_key_figures_are_the_corrected_values_where_there_are_any() -> None:
    plain, corrected = (key_figures(results(), values) for values in ({}, {"zeta": (0.2786, 2.873)}))
    assert [one.name for one in plain][:2] == ["Runout", "Height"]
    assert corrected[0] == Figure("Runout, corrected", "278.6 mm", "zeta = 2.873")
    assert corrected[1:] == plain[1:]
