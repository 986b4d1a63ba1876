"""The chart of forces on walls: one colour and marker per wall, the line of a profile shows the time."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mpmcol.plotting import wall_charts
from mpmcol.plotting.figures import Heading
from tests.support.figures import recorded_figures
from tests.support.synthetic_run import SHAPE

TIME = np.linspace(0.0, 0.3, 31)
FACES = (  # wall, face, state
    ("back_wall", "high_x", "release"), ("gate", "low_x", "release"), ("back_wall", "high_x", "end"),
    ("dam", "low_x", "end"), ("dam", "high_x", "end"),
)  # fmt: skip


def test_a_wall_has_one_colour_in_both_panels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    figures = recorded_figures(monkeypatch, wall_charts, saved=True)
    history = {"time": TIME, **{f"force.{wall}.x": 1.0 + TIME for wall in ("floor", "back_wall", "gate", "dam")}}
    keys = [key for key in FACES for _ in range(2)]
    pressures = {name: np.array([key[i] for key in keys]) for i, name in enumerate(("wall", "face", "state"))}
    pressures |= {"position": np.tile([0.0, 0.03], len(FACES)), "pressure": np.tile([300.0, 100.0], len(FACES))}
    wall_charts.wall_chart(
        tmp_path / "walls.png", SHAPE, history, pressures, friction_deg=33.0, heading=Heading("walls")
    )
    forces, profiles = ([line for line in axes.lines if len(line.get_xdata())] for axes in figures[0].axes)
    looks = {line.get_label(): (line.get_color(), line.get_marker()) for line in forces}
    assert list(looks) == ["back wall", "gate", "dam"] and len({colour for colour, _ in looks.values()}) == 3
    named = {str(line.get_label()): line for line in profiles if ", " in str(line.get_label())}
    assert list(named) == ["back wall, release", "gate, release", "back wall, end", "dam, end", "dam, far side, end"]
    for label, line in named.items():
        assert (line.get_color(), line.get_marker()) == looks[label.partition(",")[0]]
        assert line.get_linestyle() == ("-" if label.endswith("end") else "-.")
    assert named["dam, end"].get_fillstyle() != named["dam, far side, end"].get_fillstyle()


def test_walls_that_cohesive_material_pulls_are_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    figures = recorded_figures(monkeypatch, wall_charts, saved=True)
    faces: dict[str, np.ndarray] = {"wall": np.array(["dam"] * 3), "face": np.array(["low_x"] * 3)}
    faces |= {"state": np.array(["end"] * 3), "position": np.array([0.0, 0.03, 0.06])}
    faces |= {"pressure": np.array([300.0, -60.0, -1.0])}
    (profile,) = wall_charts.wall_profiles(faces)
    assert profile.height == 0.03  # that of the material, also where it pulls
    history = {"time": TIME, "force.dam.x": 1.0 + TIME}
    wall_charts.wall_chart(tmp_path / "w.png", SHAPE, history, faces, friction_deg=None, heading=Heading("walls"))
    assert figures[0].axes[1].get_xlim()[0] < -60.0


@pytest.mark.parametrize("slope_deg", [0.0, 60.0])
def test_rankine_pressures_have_the_weight_normal_to_the_base(
    slope_deg: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    figures = recorded_figures(monkeypatch, wall_charts, saved=True)
    pressures: dict[str, np.ndarray] = {"wall": np.array(["dam"] * 2), "face": np.array(["low_x"] * 2)}
    pressures |= {"state": np.array(["end"] * 2), "position": np.array([0.0, 0.03]), "pressure": np.array([300.0, 9.0])}
    history = {"time": TIME, "force.dam.x": 1.0 + TIME}
    shape = replace(SHAPE, slope_deg=slope_deg)
    wall_charts.wall_chart(
        tmp_path / "walls.png", shape, history, pressures, friction_deg=30.0, gravity=10.0, heading=Heading("walls")
    )
    _, right = figures[0].axes
    (active,) = [line for line in right.lines if line.get_linestyle() == ":" and len(line.get_xdata())]
    (profile,) = wall_charts.wall_profiles(pressures)
    weight = 10.0 * np.cos(np.radians(slope_deg)) * SHAPE.density * profile.height
    assert active.get_xdata()[0] == pytest.approx(weight / 3.0)
    (label,) = [text.get_text() for text in right.get_legend().get_texts() if text.get_text().startswith("active")]
    assert ("theta" in label) == (slope_deg > 0.0)
