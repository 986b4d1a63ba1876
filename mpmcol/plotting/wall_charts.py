"""Chart of the forces on walls over time, and of the pressure on their vertical faces over the height."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import cycle
from math import cos, radians, sin
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpmcol.case.walls import BACK_WALL, FLOOR, GATE_WALL
from mpmcol.io.glossary import FORCE_UNITS
from mpmcol.measure import Array, ColumnShape
from mpmcol.measure.wall_forces import AXES, column
from mpmcol.plotting.figures import LABEL_SIZE, Heading, save_figure, with_heading
from mpmcol.plotting.styles import POINT_MARKERS, RUN_COLOURS
from mpmcol.units import length_scale

TOP = "top"
SIDES: dict[str, tuple[str, Any]] = {  # faces of a wall in the domain -> text, filled part of the markers
    "low_x": ("", "full"),
    "high_x": (", far side", "none"),
    "low_z": (", low z", "left"),
    "high_z": (", high z", "right"),
}
ONLY_SIDE = "", "full"
MARKERS = 12  # along a line over time
STATE_LINES = {"release": "-.", "end": "-"}
LEAST_PRESSURE = 0.01  # of the largest: smaller ones are not counted to the height of the material
HEADROOM = 1.3  # of the axes, over the largest pressure and the active lines


class WallProfile(NamedTuple):
    """Normal pressure on a vertical face of a wall; state: "release" or "end"."""

    wall: str
    face: str
    state: str
    y: Array  # height of the rows of nodes, m
    pressure: Array  # Pa

    @property
    def label(self) -> str:
        """Wall, side and state."""
        return f"{_text(self.wall)}{self.side[0]}, {self.state}"

    @property
    def side(self) -> tuple[str, Any]:
        """Text for the face, and the filled part of the markers."""
        return ONLY_SIDE if self.wall in (BACK_WALL, GATE_WALL) else SIDES[self.face]

    @property
    def height(self) -> float:
        """Height h_w of the material that presses on the face, m."""
        size = np.abs(self.pressure)  # cohesive material may pull
        pressed = self.y[size > LEAST_PRESSURE * size.max(initial=0.0)]
        return float(pressed.max(initial=0.0))


def wall_chart(
    path: Path,
    shape: ColumnShape,
    history: Mapping[str, Array],
    pressures: Mapping[str, Array],
    *,
    friction_deg: float | None,
    heading: Heading,
    gravity: float = 9.81,
    svg: bool = False,
) -> list[Path]:
    """Draw the resultant on each wall but the floor over time, and pressures; nothing without such forces.

    history, pressures: columns of history.csv since the release, and of wall_pressure.csv. Profiles are drawn beside
    the active and passive pressures K_a and K_p = (1 -+ sin phi) / (1 +- sin phi) times rho g (h_w - y), with the
    height h_w of the material that presses or pulls and, on a slope, the part of g normal to the base; without
    `friction_deg` they are omitted. A wall has one colour and marker in both panels.
    """
    walls = dict.fromkeys(name.split(".")[1] for name in history if name.startswith("force."))
    walls.pop(FLOOR, None)
    if not walls:
        return []
    figure = Figure(figsize=(10.0, 5.2), layout="constrained")
    left, right = with_heading(figure, heading).subplots(1, 2, width_ratios=[3, 2])
    tau = history["time"] / shape.fall_time(gravity)
    styles = {
        wall: {"color": colour, "marker": marker, "markersize": 4.5}
        for wall, colour, marker in zip(walls, cycle(RUN_COLOURS), cycle(POINT_MARKERS), strict=False)
    }
    for wall, style in styles.items():
        parts = [history[column(wall, axis)] for axis in AXES if column(wall, axis) in history]
        left.plot(tau, np.linalg.norm(parts, axis=0), markevery=max(len(tau) // MARKERS, 1), label=_text(wall), **style)
    unit = FORCE_UNITS[shape.model]
    left.set(
        xlabel=r"time since release $t\,/\,\sqrt{h_i/g}$ (-)", ylabel=f"force on the wall ({unit})", ylim=(0.0, None)
    )
    _draw_profiles(right, shape, list(wall_profiles(pressures)), styles, friction_deg, gravity)
    for axes in (left, right):
        axes.grid(color="0.9")
        axes.legend(edgecolor="none", fontsize=LABEL_SIZE, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2)
    return save_figure(figure, path, svg)


def wall_profiles(pressures: Mapping[str, Array]) -> Iterator[WallProfile]:
    """The profiles with pressure on vertical faces, of gate and back wall at release, of all walls at the end."""
    if not pressures:
        return
    keys = list(zip(pressures["wall"], pressures["face"], pressures["state"], strict=True))
    for key in dict.fromkeys(keys):
        rows = np.array([other == key for other in keys])
        if key[1] == TOP:
            continue
        profile = WallProfile(*key, pressures["position"][rows], pressures["pressure"][rows])
        if profile.pressure.max() > 0.0:
            yield profile


def _text(wall: str) -> str:
    return wall.replace("_", " ")


def _draw_profiles(
    axes: Axes,
    shape: ColumnShape,
    profiles: list[WallProfile],
    styles: Mapping[str, Mapping[str, Any]],
    friction_deg: float | None,
    gravity: float,
) -> None:
    unit, factor = length_scale(shape.h_i)
    smallest = min((float(profile.pressure.min()) for profile in profiles), default=0.0)
    weight, largest = shape.density * gravity * cos(radians(shape.slope_deg)), 0.0  # per height, normal to the base
    for profile in profiles:
        style, colour = styles[profile.wall], styles[profile.wall]["color"]
        line, fill = STATE_LINES[profile.state], profile.side[1]
        axes.plot(profile.pressure, factor * profile.y, linestyle=line, fillstyle=fill, label=profile.label, **style)
        largest = max(largest, float(profile.pressure.max()))
        if friction_deg is not None:
            active = (1.0 - sin(radians(friction_deg))) / (1.0 + sin(radians(friction_deg)))
            ends = weight * profile.height, factor * profile.height
            axes.plot((active * ends[0], 0.0), (0.0, ends[1]), color=colour, linestyle=":", linewidth=1.0)
            axes.plot((ends[0] / active, 0.0), (0.0, ends[1]), color=colour, linestyle="--", linewidth=1.0)
            largest = max(largest, active * ends[0])
    if friction_deg is not None and profiles:
        normal = r"g \cos\theta" if shape.slope_deg else "g"
        for name, line in (("active, $K_a", ":"), ("passive, $K_p", "--")):
            axes.plot([], [], color="0.4", linestyle=line, linewidth=1.0, label=rf"{name} \rho {normal} (h_w - y)$")
    axes.set(xlabel="normal pressure (Pa)", ylabel=f"height ({unit})")
    axes.set_xlim(HEADROOM * min(smallest, 0.0), HEADROOM * largest or 1.0)
    axes.set_ylim(0.0, 1.2 * factor * max((profile.height for profile in profiles), default=shape.h_i))
