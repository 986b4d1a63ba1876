"""Parts of a profile chart: outlines, column and gate at release, fronts, experiments and measurements of the user."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from mpmcol.experiments import Experiment, Profile, mark
from mpmcol.measure import Array, ColumnShape, Measurement
from mpmcol.plotting.measured_series import MeasuredSeries
from mpmcol.plotting.styles import (
    BED_STYLE,
    FRONT_STYLES,
    GATE_STYLE,
    HOLLOW,
    POINT_MARKERS,
    POINTS_COLOUR,
    SURFACE_STYLE,
    WALL_STYLE,
    author_of,
)
from mpmcol.plotting.styles import experiment_style as style_of

RELEASED: dict[str, Any] = {"color": "0.6", "linestyle": "--"}  # line of the column at release
AVERAGE = (0.25, 0.5, 0.25)  # weights of neighbouring bins in a drawn line
SAMPLES = 8  # of the drawn line per bin
ARROW_TIP, ARROW_LENGTH = (0.95, 0.7), 30.0  # of gravity: fractions of the axes, points
MOST_SERIES = 2  # of the user's with legend entries of their own


@dataclass(frozen=True)
class LengthAxes:
    """Axes with equal scales in `unit`; `factor` converts from m."""

    axes: Axes
    unit: str
    factor: float


def set_up_axes(target: LengthAxes, shape: ColumnShape, deposits: Sequence[Measurement], reach: float) -> float:
    """Fit the axes to column, deposits and `reach` (m), draw column, gate and floor; returns height over length."""
    axes, unit, factor = target.axes, target.unit, target.factor
    walls = [(one.low_x, one.high_x) for one in shape.obstacles]
    length = factor * with_walls(max([reach] + [deposit.max_distance for deposit in deposits]), walls)
    top = factor * max([shape.h_i] + [deposit.profile_y.max() for deposit in deposits])
    bed = factor * shape.bed if shape.bed_density else 0.0
    height = "mean height around the axis" if shape.has_sectors else "height"
    axes.set(
        xlim=(-0.03 * length, 1.03 * length),
        ylim=(-bed - 0.04 * length, top + 0.07 * length),
        xlabel=f"{distance_label(shape)} ({unit})",
        ylabel=f"{height} ({unit})",
    )
    axes.plot(*(factor * shape.surface), label="column at release", **RELEASED)
    if shape.gate:
        draw_gate(axes, factor * shape.r_i, shape.lean)
    axes.axhline(-bed, color="black", linewidth=0.8, zorder=0)
    if bed:
        axes.axhspan(-bed, 0.0, **BED_STYLE)
    if not shape.has_sectors:
        # over the surfaces, whose lines end in the bin behind the last point
        draw_walls(axes, [(one.low_x, one.high_x, one.height) for one in shape.obstacles], factor, zorder=3.0)
    return float((top + bed) / length)


def draw_over_bed(target: LengthAxes, surface: tuple[Array, Array]) -> Line2D:
    """Draw the surface of deposit and bed (m) over that of the bed at the release, which is at zero."""
    x, height = surface
    averaged = np.convolve(np.pad(height, 1, mode="edge"), AVERAGE, "valid")
    (line,) = target.axes.plot(
        target.factor * x,
        target.factor * averaged,
        label="surface of deposit and bed (grey: bed at release)",
        **SURFACE_STYLE,
    )
    return line


def with_walls(reach: float, walls: Sequence[tuple[float, float]]) -> float:
    """Distance (m) up to which an image shows walls, given by their faces, that the deposit reaches.

    Of an end wall it shows the face only.
    """
    near = [(low, high) for low, high in walls if low <= 1.1 * reach]
    return max([reach] + [min(high, 1.1 * max(reach, low)) for low, high in near])


def draw_walls(axes: Axes, walls: Sequence[tuple[float, float, float]], factor: float = 1.0, **style: Any) -> None:
    """Walls from low to high x and up to a height (m times `factor`), which do not change the limits of the axes."""
    for low, high, height in walls:
        axes.add_patch(Rectangle((factor * low, 0.0), factor * (high - low), factor * height, **(WALL_STYLE | style)))


def draw_gate(axes: Axes, position: float, lean: float = 0.0, size: float | str = "small") -> None:
    """A thin line from r_i on the base over the height of the axes, with its name; lean: as of the column."""
    height = axes.get_ylim()[1]
    top = position - lean * height
    axes.plot([position, top], [0.0, height], label="gate", **GATE_STYLE)
    axes.annotate(
        "gate", (top, 1.0), (3.0, -3.0), xycoords=axes.get_xaxis_transform(), textcoords="offset points",
        ha="left", va="top", fontsize=size, color=GATE_STYLE["color"],
    )  # fmt: skip


def draw_gravity(axes: Axes, slope_deg: float, size: float | str = "small") -> None:
    """On a slope, an arrow along gravity at the upper right of axes with equal scales, along and normal to the base."""
    if slope_deg:
        slope = np.radians(slope_deg)
        tail = (-ARROW_LENGTH * np.sin(slope), ARROW_LENGTH * np.cos(slope))
        axes.annotate(
            rf"$g$, {slope_deg:g}$\degree$", ARROW_TIP, tail, xycoords="axes fraction", textcoords="offset points",
            ha="center", va="bottom", fontsize=size, arrowprops={"arrowstyle": "->", "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip


def origin(shape: ColumnShape) -> str:
    """What is at x = 0."""
    if shape.model != "plane":
        return "axis"
    return "plane of symmetry" if shape.release == "two-sided" else "wall"


def distance_label(shape: ColumnShape) -> str:
    """Name of the horizontal coordinate of a profile."""
    if shape.is_round:
        return "radius"
    return "distance from the axis along x" if shape.dimension == 3 else f"distance from the {origin(shape)}"


def outline(deposit: Measurement, factor: float) -> tuple[Array, Array]:
    """Surface of a deposit times `factor` as a smooth line, horizontal from the first bin centre to x = 0.

    Between the bins it is monotonic (PCHIP), so that the line adds no extremum. Of the empty bins only the first and
    last of each gap are drawn, where the line falls to zero. It ends at the farthest point.
    """
    from scipy.interpolate import PchipInterpolator  # here, since it takes long to import

    surface = _averaged(deposit.profile_y)
    x, height = np.append(0.0, deposit.profile_x), np.append(surface[:1], surface)
    drawn = np.convolve(height > 0.0, np.ones(3), "same") > 0.0
    bins = np.arange(len(x))
    fine = np.linspace(0, bins[-1], bins[-1] * SAMPLES + 1)
    smooth = PchipInterpolator(bins, height)(fine)
    smooth[~(drawn[np.floor(fine).astype(int)] & drawn[np.ceil(fine).astype(int)])] = np.nan
    return factor * np.minimum(np.interp(fine, bins, x), deposit.max_distance), factor * smooth


def _averaged(height: Array) -> Array:
    """Heights of the bins, averaged over neighbours where a bin and its four neighbours are filled.

    Where material has been stretched, bins hold few points, and their number alternates from bin to bin. The average
    keeps the area; at the front, where it would move the end of the deposit, the bins stay as they are.
    """
    padded = np.pad(height, 2, mode="reflect" if len(height) > 2 else "edge")
    filled = np.convolve(padded > 0.0, np.ones(5), "valid") == 5
    return np.where(filled, np.convolve(padded, AVERAGE, "valid")[1:-1], height)


def reach_of(shape: ColumnShape, experiment: Experiment | None, points: Sequence[MeasuredSeries]) -> float:
    """Largest distance at which an experiment or a measurement of the user is drawn, m."""
    zeta = experiment.expected("zeta", shape.a) if experiment else None
    return max([shape.r_i * (1.0 + sum(zeta or ())), *(float(series.r.max()) for series in points)])


def draw_fronts(target: LengthAxes, deposit: Measurement) -> tuple[list[Line2D], str]:
    """Draw markers on the lower edge of the axes, in 3D also the range of front_height; returns them and their text."""
    ranges, factor = deposit.front_range or {}, target.factor
    lines, texts = [], []
    for name, front in reversed(deposit.front.items()):
        marker, lower_edge = f"k{FRONT_STYLES[name]['marker']}", target.axes.get_xaxis_transform()
        label = f"{name}: {factor * front:.4g} {target.unit}"
        if name in ranges:
            label += " ({:.4g} to {:.4g})".format(*(factor * end for end in ranges[name]))
        lines += target.axes.plot(factor * front, 0.0, marker, label=label, transform=lower_edge, **HOLLOW)
        texts.append(f"{name.removeprefix('front_')} {factor * front:.4g}")
    text = f"front: {', '.join(texts)} {target.unit}"
    if ranges:
        low, high = (factor * end for end in ranges["front_height"])
        target.axes.axvspan(low, high, color="0.9", zorder=-1, label="range of front_height")
        text += f"\n(height: {low:.4g} to {high:.4g} {target.unit} in the sections)"
    return lines, text


def draw_experiment(target: LengthAxes, shape: ColumnShape, experiment: Experiment) -> tuple[list[Any], list[str]]:
    """Draw front and height of the laws with their scatter, and digitised profiles; returns handles and labels."""
    zeta, beta = (experiment.expected(quantity, shape.a) for quantity in ("zeta", "beta"))
    style, factor = style_of(experiment), target.factor
    bars: dict[str, Any] = {"color": style.colour, "capsize": 4, "linestyle": "none", "clip_on": False}
    handles: list[Any] = []
    parts = []
    if zeta:
        front, error = factor * shape.r_i * (1.0 + zeta[0]), factor * shape.r_i * zeta[1]
        label = f"{experiment.label('zeta')}: front, scatter"
        handles.append(target.axes.errorbar(front, 0.0, xerr=error, marker=style.marker, label=label, **bars))
        parts.append("front" + experiment.label("zeta").removeprefix(experiment.citation))
    if beta:
        height, error = (factor * shape.h_i * value for value in beta)
        label = f"{experiment.label('beta')}: height, scatter"
        handles.append(target.axes.errorbar(0.0, height, yerr=error, marker=style.marker, label=label, **bars))
        parts.append("height" + experiment.label("beta").removeprefix(experiment.citation))
    labels = [f"{experiment.citation}: {', '.join(parts)}, scatter"] if parts else []
    shown = handles[:1]
    for profile in experiment.profiles if experiment.fits(shape.r_i, shape.h_i) else ():
        if profile.unit == "m" or (zeta and beta):
            scales = (factor, factor) if profile.unit == "m" else (front, height)
            shown += _draw_profile(target.axes, profile, author_of(profile), scales)
            labels.append(str(shown[-1].get_label()))
    return shown, labels


def _draw_profile(axes: Axes, profile: Profile, author: Experiment, scales: tuple[float, float]) -> list[Line2D]:
    marker = "x" if "surface" in profile.name else "+"
    x, y = scales[0] * np.array(profile.x), scales[1] * np.array(profile.y)
    label = f"{author.citation}: {profile.name}{mark(profile.verified)}"
    return axes.plot(x, y, marker, color=style_of(author).colour, markersize=5, label=label)


def draw_points(target: LengthAxes, measured: Sequence[MeasuredSeries]) -> tuple[list[Line2D], list[str]]:
    """Draw measurements of the user; returns handles and labels, one for all if there are many series."""
    lines = []
    for i, series in enumerate(measured):
        style: dict[str, Any] = {"marker": POINT_MARKERS[i % len(POINT_MARKERS)], "color": POINTS_COLOUR}
        x, y = target.factor * series.r, target.factor * series.z
        lines += target.axes.plot(x, y, linestyle="none", fillstyle="none", markersize=5, label=series.label, **style)
    if len(measured) <= MOST_SERIES:
        return lines, [series.label for series in measured]
    return [tuple(lines)], [f"{len(measured)} series: {', '.join(series.name for series in measured)}"]  # type: ignore[list-item]
