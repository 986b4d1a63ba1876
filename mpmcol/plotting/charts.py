"""Charts from arrays: deposit profiles, front and height over time, energy balance.

Lines differ by their dashes, so that charts are readable without colour.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from mpmcol.experiments import Experiment, Profile, mark
from mpmcol.io.atomic import atomic_write
from mpmcol.io.glossary import ENERGY_UNITS
from mpmcol.measure import Array, ColumnShape, Measurement

EXPERIMENT_COLOUR = "#b2182b"
ERROR_BAR_STYLE: dict[str, Any] = {"color": EXPERIMENT_COLOUR, "capsize": 4, "linestyle": "none", "clip_on": False}
DEPOSIT_STYLE: dict[str, Any] = {"color": "black", "linewidth": 2.0}
HOLLOW: dict[str, Any] = {"fillstyle": "none", "clip_on": False}
TIME_LABEL = r"time since release $t\,/\,\sqrt{h_i/g}$ (-)"
MODELS = {"plane": "plane strain", "axisymmetric": "axisymmetric", "quarter": "3D quarter model", "full": "3D model"}
FRONT_STYLES: dict[str, dict[str, Any]] = {
    "front_max": {"linestyle": (0, (1, 1)), "color": "0.6", "linewidth": 2.5, "marker": "v"},
    "front_connected": {"linestyle": "--", "color": "0.35", "marker": "s"},
    "front_height": {"linestyle": "-", "color": "black", "marker": "o"},
}
FRONT_LABELS = {
    "front_max": "front_max (farthest point)",
    "front_connected": "front_connected (farthest point without a gap)",
    "front_height": "front_height (end of the deposit)",
}
ENERGY_STYLES: dict[str, dict[str, Any]] = {  # columns of the history
    "kinetic": {"label": "kinetic energy", "linestyle": "-", "color": "0.55", "linewidth": 2.2},
    "plastic": {"label": "plastic work", "linestyle": "--", "color": "black"},
    "damping": {"label": "dissipated by damping", "linestyle": "-.", "color": "black"},
    "filter": {"label": "dissipated by the stress filter", "linestyle": (0, (3, 1, 1, 1)), "color": "0.4"},
    "elastic": {"label": "elastic energy", "linestyle": (0, (1, 1)), "color": "black"},
    "transfer": {"label": "dissipated by transfer", "linestyle": (0, (6, 2, 1, 2, 1, 2)), "color": "0.4"},
    "walls": {"label": "dissipated at walls", "linestyle": (0, (8, 3)), "color": "0.4"},
}


def profile_chart(
    path: Path,
    shape: ColumnShape,
    deposits: Sequence[tuple[float, Measurement]],
    experiment: Experiment,
    *,
    gravity: float = 9.81,
    svg: bool = False,
    at_rest: bool = True,
) -> list[Path]:
    """Draw profiles at the given times (s since release) and the column at release, in mm with equal axes.

    The last profile is drawn bold with its three fronts; it is labelled as the deposit if `at_rest`. The experiment is
    shown by front and height of its laws with their scatter, and by its digitised profiles if they apply.
    """
    tau = sqrt(shape.h_i / gravity)
    figure = Figure(layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    flatness = _set_up_axes(axes, shape, [deposit for _, deposit in deposits], experiment)
    figure.set_size_inches(8.0, min(7.0 * flatness, 8.0) + 2.7)
    styles: list[dict[str, Any]] = [{"linestyle": (0, (1 + 2 * i, 1.5))} for i in range(len(deposits) - 1)]
    names = [""] * len(styles) + [", deposit" if at_rest else ", last state"]
    for (time, deposit), style, name in zip(deposits, [*styles, DEPOSIT_STYLE], names, strict=True):
        label = rf"$t$ = {time:.3g} s = {time / tau:.2g} $\sqrt{{h_i/g}}${name}"
        axes.plot(*_outline(deposit), label=label, **({"color": "0.4"} | style))
    _draw_experiment(axes, shape, experiment)
    _draw_fronts(axes, deposits[-1][1], shape.range_label)
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize="small")
    return save_figure(figure, path, svg)


def front_chart(
    path: Path,
    shape: ColumnShape,
    time: Array,
    fronts: Mapping[str, Array],
    height: Array,
    experiment: Experiment,
    *,
    gravity: float = 9.81,
    svg: bool = False,
) -> list[Path]:
    """Draw the runout by each front definition and the height, both normalised, over t / sqrt(h_i / g).

    Args:
        path: of the PNG; with `svg`, an SVG is written beside it.
        shape: the column as released.
        time: (n,) since release, s.
        fronts: front definition -> (n,) positions, m.
        height: (n,) of the pile, m.
        experiment: its final values are drawn with bands for their scatter.
        gravity: m/s2.
    """
    figure = Figure(figsize=(7.0, 7.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    tau = time / sqrt(shape.h_i / gravity)
    for name, front in fronts.items():
        style = {key: value for key, value in FRONT_STYLES[name].items() if key != "marker"}
        upper.plot(tau, front / shape.r_i - 1.0, label=FRONT_LABELS[name], **style)
    lower.plot(tau, height / shape.h_i, color="black", label=f"height at the {_origin(shape)}")
    for axes, quantity in ((upper, "zeta"), (lower, "beta")):
        _draw_band(axes, experiment, quantity, shape.a)
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
        axes.grid(color="0.9")
        axes.legend(frameon=False, fontsize="small")
    figure.align_ylabels()
    upper.set(ylabel=r"runout $\zeta = (r - r_i)/r_i$ (-)", title=_column_name(shape))
    lower.set(ylabel=r"height $h / h_i$ (-)", xlabel=TIME_LABEL)
    return save_figure(figure, path, svg)


def energy_chart(
    path: Path,
    shape: ColumnShape,
    time: Array,
    energies: Mapping[str, Array],
    *,
    gravity: float = 9.81,
    svg: bool = False,
) -> list[Path]:
    """Draw the potential energy released since the first time, the other energies, and the residual of the balance.

    All are in per cent of the potential energy of the column at release. `energies` has (n,) arrays in J under
    "potential", "residual" and the keys of ENERGY_STYLES.
    """
    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    tau = time / sqrt(shape.h_i / gravity)
    total = shape.potential_energy(gravity)

    def change(name: str) -> Array:
        return 100.0 * (energies[name] - energies[name][0]) / total

    upper.plot(tau, -change("potential"), color="black", linewidth=2.2, label="potential energy released")
    for name, style in ENERGY_STYLES.items():
        upper.plot(tau, change(name), **style)
    lower.plot(tau, change("residual"), color="black")
    scale = f"% of {total:.3g} {ENERGY_UNITS[shape.model][1]}"
    upper.set(ylabel=f"energy ({scale},\nthe potential energy at release)", title=_column_name(shape))
    lower.set(ylabel="residual (%)", xlabel=TIME_LABEL)
    figure.align_ylabels()
    for axes in (upper, lower):
        axes.grid(color="0.9")
        axes.axhline(0.0, color="black", linewidth=0.8)
    upper.legend(frameon=False, fontsize="small", ncols=2)
    return save_figure(figure, path, svg)


def _set_up_axes(axes: Axes, shape: ColumnShape, deposits: list[Measurement], experiment: Experiment) -> float:
    """Fit the axes to everything that will be drawn, draw the column at release; returns height over length."""
    front = shape.r_i * (1.0 + sum(experiment.expected("zeta", shape.a) or (0.0, 0.0)))
    length = 1e3 * max([front] + [deposit.max_distance for deposit in deposits])
    top = 1e3 * max([shape.h_i] + [deposit.profile_y.max() for deposit in deposits])
    axes.set(
        xlim=(-0.03 * length, 1.03 * length),
        ylim=(-0.04 * length, top + 0.04 * length),
        xlabel=_distance_label(shape),
        ylabel="mean height around the axis (mm)" if shape.has_sectors else "height (mm)",
        title=_column_name(shape),
    )
    column = 1e3 * np.array([[0.0, shape.r_i, shape.r_i], [shape.h_i, shape.h_i, 0.0]])
    axes.plot(*column, color="0.6", linestyle="--", label="column at release")
    axes.axhline(0.0, color="black", linewidth=0.8, zorder=0)
    return float(top / length)


def _column_name(shape: ColumnShape) -> str:
    return f"{MODELS[shape.model]}, $a$ = {shape.a:.3g}"


def _origin(shape: ColumnShape) -> str:
    """What is at x = 0."""
    if shape.model != "plane":
        return "axis"
    return "plane of symmetry" if shape.release == "two-sided" else "wall"


def _distance_label(shape: ColumnShape) -> str:
    if shape.is_round:
        return "radius (mm)"
    if shape.dimension == 3:
        return "distance from the axis along x (mm)"
    return f"distance from the {_origin(shape)} (mm)"


def _outline(deposit: Measurement) -> tuple[Array, Array]:
    """Profile in mm, extended horizontally from the first bin centre to x = 0.

    Of the empty bins only the first and last of each gap are kept, where the line falls to zero.
    """
    height = np.append(deposit.profile_y[:1], deposit.profile_y)
    drawn = np.convolve(height > 0.0, np.ones(3), "same") > 0.0
    return 1e3 * np.append(0.0, deposit.profile_x), np.where(drawn, 1e3 * height, np.nan)


def _draw_fronts(axes: Axes, deposit: Measurement, range_label: str) -> None:
    """Draw markers on the lower edge of the axes; in 3D also a band for the range of front_height."""
    ranges = deposit.front_range or {}
    for name, front in deposit.front.items():
        marker, lower_edge = f"k{FRONT_STYLES[name]['marker']}", axes.get_xaxis_transform()
        label = f"{name}: {1e3 * front:.1f} mm"
        if name in ranges:
            label += " ({:.1f} to {:.1f})".format(*(1e3 * end for end in ranges[name]))
        axes.plot(1e3 * front, 0.0, marker, label=label, transform=lower_edge, **HOLLOW)
    if ranges:
        low, high = ranges["front_height"]
        axes.axvspan(1e3 * low, 1e3 * high, color="0.9", zorder=-1, label=f"front_height {range_label}")


def _draw_experiment(axes: Axes, shape: ColumnShape, experiment: Experiment) -> None:
    zeta, beta = (experiment.expected(quantity, shape.a) for quantity in ("zeta", "beta"))
    if zeta:
        front, error = 1e3 * shape.r_i * (1.0 + zeta[0]), 1e3 * shape.r_i * zeta[1]
        label = f"{experiment.label('zeta')}: front, scatter"
        axes.errorbar(front, 0.0, xerr=error, marker="D", label=label, **ERROR_BAR_STYLE)
    if beta:
        height, error = (1e3 * shape.h_i * value for value in beta)
        label = f"{experiment.label('beta')}: height, scatter"
        axes.errorbar(0.0, height, yerr=error, marker="^", label=label, **ERROR_BAR_STYLE)
    for profile in experiment.profiles if experiment.fits(shape.r_i, shape.h_i) else ():
        if profile.unit == "m":
            _draw_profile(axes, profile, 1e3, 1e3)
        elif zeta and beta:
            _draw_profile(axes, profile, front, height)


def _draw_profile(axes: Axes, profile: Profile, x_scale: float, y_scale: float) -> None:
    marker = "x" if "surface" in profile.name else "+"
    x, y = x_scale * np.array(profile.x), y_scale * np.array(profile.y)
    axes.plot(x, y, marker, color=EXPERIMENT_COLOUR, markersize=5, label=profile.name + mark(profile.verified))


def _draw_band(axes: Axes, experiment: Experiment, quantity: str, a: float) -> None:
    if expected := experiment.expected(quantity, a):
        value, half = expected
        axes.axhspan(value - half, value + half, color=EXPERIMENT_COLOUR, alpha=0.15, linewidth=0)
        label = f"{experiment.label(quantity)}: final value, scatter"
        axes.axhline(value, color=EXPERIMENT_COLOUR, linestyle=(0, (10, 4)), linewidth=1.0, label=label)


def save_figure(figure: Figure, path: Path, svg: bool) -> list[Path]:
    """Write a PNG with 150 dpi and, if `svg`, an SVG beside it; raises OutputError."""
    FigureCanvasAgg(figure)
    paths = [path, path.with_suffix(".svg")] if svg else [path]
    for target in paths:
        data = io.BytesIO()
        figure.savefig(data, format=target.suffix[1:], dpi=150, bbox_inches="tight")
        atomic_write(target, data.getvalue())
    return paths
