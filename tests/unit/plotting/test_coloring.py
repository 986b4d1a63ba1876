"""Quantities by which points are coloured."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mpmcol.errors import OutputError
from mpmcol.io.snapshot import Snapshot
from mpmcol.plotting.limits import COLORS
from mpmcol.plotting.render import backends, render
from mpmcol.plotting.render.coloring import COLORINGS
from tests.support.cli import invoke

META = {"point_size": 0.005}
N = 200


def snapshot(**changed: np.ndarray) -> Snapshot:
    """Points of a column, of which one has a pressure far above that of the others, and one point of the base."""
    pressure = np.linspace(0.0, 1e3, N)
    pressure[7] = 1e6
    arrays = {
        "displacement": np.full((N, 3), (0.03, 0.04, 0.0)),
        "velocity": np.full((N, 3), (0.6, 0.8, 0.0)),
        "pressure": pressure,
        "shear_stress": 0.5 * pressure,
        "material": (np.arange(N) == N - 1).astype(np.uint8),
    }
    return Snapshot(0.0, 0, "collapse", arrays | changed)


def test_the_command_offers_all_quantities() -> None:
    assert list(COLORINGS) == list(COLORS)


def test_values_and_limits_are_in_si_units() -> None:
    displacement, velocity = COLORINGS["displacement"], COLORINGS["velocity"]
    assert displacement.values(snapshot()) == pytest.approx(0.05) and velocity.values(snapshot()) == pytest.approx(1.0)
    assert displacement.limits(snapshot(), META) == pytest.approx((0.0, 0.05))
    assert displacement.scale((0.0, 0.05)) == ("displacement magnitude (mm)", (0.0, 50.0))


def test_the_unit_of_the_colour_bar_suits_the_largest_value() -> None:
    pressure = COLORINGS["pressure"]
    labels = [pressure.scale((0.0, limit))[0].rpartition(" ")[2] for limit in (0.5, 20.0, 3e3, 2e6)]
    assert labels == ["(Pa)", "(Pa)", "(kPa)", "(MPa)"]
    assert COLORINGS["displacement"].scale((0.0, 2.0))[0].endswith("(m)")
    labels = {name: coloring.scale((0.0, 1.0))[0] for name, coloring in COLORINGS.items()}
    assert [name for name, label in labels.items() if not label.endswith(")")] == ["inertial"]
    assert COLORINGS["inertial"].scale((0.0, 0.1)) == ("inertial number I", (0.0, 0.1))


def test_single_large_stresses_do_not_set_the_scale() -> None:
    assert 900.0 < COLORINGS["pressure"].limits(snapshot(), META)[1] < 1e5
    assert 450.0 < COLORINGS["shear"].limits(snapshot(), META)[1] < 5e4


def test_a_column_at_rest_has_a_scale() -> None:
    still = snapshot(displacement=np.zeros((N, 3)), velocity=np.zeros((N, 3)))
    assert COLORINGS["displacement"].limits(still, META) == (0.0, 0.005)
    assert COLORINGS["velocity"].limits(still, META)[1] > 0.0


def test_an_old_snapshot_without_pressure_is_reported() -> None:
    old = snapshot()
    del old.arrays["pressure"]
    with pytest.raises(OutputError, match="no array pressure: an earlier version of mpmcol wrote it"):
        COLORINGS["pressure"].limits(old, META)


OF_LAWS = ("inertial", "friction")


@pytest.mark.parametrize("color", [color for color in COLORS if color not in OF_LAWS])
def test_a_run_is_drawn_in_every_colour(finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, color: str):
    monkeypatch.setattr(backends, "has_egl", lambda: False)
    render(finished, gif=False, color=color, size=(400, 240), out=tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 5000


def test_a_colour_that_the_law_does_not_give_is_refused(finished: Path, tmp_path: Path) -> None:
    refused = invoke("render", finished, "--color", "inertial", "--out", tmp_path / "a.png")
    assert refused.exit_code == 2 and "only runs with law mu-i have the inertial_number" in refused.stderr


def test_an_unknown_colour_is_refused(finished: Path) -> None:
    refused = invoke("render", finished, "--color", "temperature")
    assert refused.exit_code == 2 and "pressure" in refused.stderr
