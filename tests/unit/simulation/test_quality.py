"""Notes on dissipation and stresses: of coarse runs, and of given numbers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import mpmcol
from mpmcol.cli.run_summary import energy_line, summary_table
from mpmcol.measure.dissipation import Dissipation
from mpmcol.measure.stress import StressQuality
from mpmcol.simulation.quality import _dissipation_notes, _stress_notes

GOOD = Dissipation(1.0, 0.93, 0.03, 0.0, 0.02, 0.02, 0.0, 0.02)
QUIET = StressQuality(2000.0, 0.02, 0.0, 0.8, 1.0, 0.5, 1.2, 0.1)


def notes_of(folder: Path, *overrides: str) -> tuple[str, dict]:
    case = mpmcol.load_case("coarse-channel", ["grid.spacing=0.01", "output.snapshots=1", *overrides])
    summary = mpmcol.run(case, folder, threads=1).summary
    return "\n".join(summary["warnings"]), summary


def test_the_filter_quiets_the_stresses_of_a_run(tmp_path: Path) -> None:
    plain, noisy = notes_of(tmp_path / "plain", "method.stress_filter=none")
    filtered, quiet = notes_of(tmp_path / "filtered")
    assert "stresses of single points are noise" in plain and 'set method.stress_filter = "flow"' in plain
    assert "noise: " not in filtered
    assert quiet["stress"]["stress_free"] < 0.02 < noisy["stress"]["stress_free"]
    assert quiet["stress"]["pressure_max"] < 1.2 < noisy["stress"]["pressure_max"]
    assert quiet["dissipation"]["damping"] < noisy["dissipation"]["damping"]
    assert noisy["dissipation"]["filter"] == 0.0 < quiet["dissipation"]["filter"] < 0.05
    for shares in (noisy["dissipation"], quiet["dissipation"]):
        parts = ("friction", "damping", "walls", "transfer", "filter", "remaining")
        assert sum(shares[part] for part in parts) == pytest.approx(1.0, abs=1e-6)


def test_walls_and_transfer_that_cancel_are_one_share() -> None:
    shares = {"released": 2.0, "friction": 0.9, "damping": 0.03, "walls": 0.29, "transfer": -0.24, "filter": 0.02}
    line = energy_line(shares, 4.0, "J")
    assert line == (
        "energy released, 2 J, 50.0 % of the potential energy: friction 90.0 %, damping 3.0 %, walls and transfer "
        "together 5.0 %, filter 2.0 %"
    )
    line = energy_line(shares | {"walls": 0.002, "transfer": 0.008, "wall_friction": 0.1}, 1.0, "J")
    assert line.endswith(
        "friction 90.0 %, wall friction 10.0 %, damping 3.0 %, walls 0.2 %, transfer 0.8 %, filter 2.0 %"
    )


def test_good_numbers_give_no_note() -> None:
    assert list(_dissipation_notes(GOOD, True)) == list(_stress_notes(QUIET, True)) == []


@pytest.mark.parametrize(("is_filtered", "remedy"), [(True, "lower stages.collapse.damping"), (False, "stress_filter")])
def test_too_much_damping_is_reported(is_filtered: bool, remedy: str) -> None:
    (note,) = _dissipation_notes(replace(GOOD, damping=0.06), is_filtered)
    assert "6.0 % of the released energy, 3.0 times" in note and remedy in note


def test_large_numerical_losses_are_reported() -> None:
    (note,) = _dissipation_notes(replace(GOOD, transfer=0.09), True)
    assert "transfer and walls took 9.0 %" in note and "filter 2.0 %" in note and "smaller grid.spacing" in note


def test_locking_is_named() -> None:
    (note,) = _stress_notes(replace(QUIET, pressure_p1=-0.7, pressure_p99=1.8, pressure_max=1.9), False)
    assert "volumetric locking: 98 % of the pressures are between -0.7 and 1.8 times" in note


def test_a_bed_that_flows_down_to_the_floor_is_reported(tmp_path: Path) -> None:
    options = ["grid.spacing=0.015", "grid.points_per_cell=4", "geometry.aspect=1", "geometry.base_thickness=0.03"]
    options += ["stages.collapse.max_time_factor=3", "output.snapshots=1", "geometry.domain_length=1"]
    steep = ["geometry.slope_deg=25", "base_material.friction_deg=15"]
    flowing = mpmcol.run(mpmcol.load_case("granular-bed", [*options, *steep]), tmp_path / "steep", threads=1)
    assert flowing.summary["erosion"]["eroded_depth"] <= 0.03
    cause = "geometry.slope_deg = 25: bed and column flow on and do not stop on this slope"
    notes = [text for text in flowing.summary["warnings"] if cause in text]
    assert [text.split(",")[0] for text in notes[-2:]] == [
        "the column still moved at the time limit",
        "the bed has moved down to the floor",
    ]
    assert not any("twice as many steps" in text for text in flowing.summary["warnings"])
    assert "down to a depth of 30 mm, its whole thickness" in summary_table(flowing)
    resting = mpmcol.run(mpmcol.load_case("granular-bed", options), tmp_path / "horizontal", threads=1)
    assert not any("down to the floor" in text for text in resting.summary["warnings"])
