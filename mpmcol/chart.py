"""Charts of a run: profile.png, front.png and energy.png. Readable in black and white: lines differ by dashes.

The three chart functions take plain arrays; `chart_run` draws all three from the folder of a run.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from math import sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from mpmcol.experiments import Experiment, Profile, find_experiment
from mpmcol.files import atomic_write
from mpmcol.measure import Array, ColumnShape, Measurement

if TYPE_CHECKING:
    from mpmcol.results import Results

EXPERIMENT_COLOUR = "#b2182b"
WITH_BARS: dict[str, Any] = {"color": EXPERIMENT_COLOUR, "capsize": 4, "linestyle": "none", "clip_on": False}
HOLLOW: dict[str, Any] = {"fillstyle": "none", "clip_on": False}
TIME_LABEL = r"time since release $t\,/\,\sqrt{h_i/g}$ (-)"
FRONT_STYLES: dict[str, dict[str, Any]] = {
    "front_max": {"linestyle": (0, (1, 1)), "color": "0.35", "marker": "v"},
    "front_connected": {"linestyle": "--", "color": "0.35", "marker": "s"},
    "front_height": {"linestyle": "-", "color": "black", "marker": "o"},
}
SINK_STYLES: dict[str, dict[str, Any]] = {
    "kinetic": {"linestyle": "-", "color": "0.55", "linewidth": 2.2},
    "plastic": {"linestyle": "--", "color": "black"},
    "damping": {"linestyle": "-.", "color": "black"},
    "elastic": {"linestyle": (0, (1, 1)), "color": "black"},
    "transfer": {"linestyle": (0, (6, 2, 1, 2, 1, 2)), "color": "0.4"},
    "walls": {"linestyle": (0, (8, 3)), "color": "0.4"},
}


def profile_chart(
    path: Path,
    shape: ColumnShape,
    deposits: Sequence[tuple[float, Measurement]],
    experiment: Experiment,
    gravity: float = 9.81,
    svg: bool = False,
) -> list[Path]:
    """The deposit at the given times (s, since release) over the column's outline, axes equal, in millimetres.

    The last deposit is drawn bold, with its three fronts marked. The experiment is drawn by the final front and
    height of its laws with their scatter, and by its digitised profiles where they apply.
    """
    tau = sqrt(shape.h_i / gravity)
    figure, axes = _profile_axes(shape, [deposit for _, deposit in deposits], experiment)
    for i, (time, deposit) in enumerate(deposits):
        last = i == len(deposits) - 1
        style = {"color": "black", "linewidth": 2.0} if last else {"color": "0.4", "linestyle": (0, (1 + i, 1.5))}
        label = rf"$t$ = {time:.3g} s = {time / tau:.2g} $\sqrt{{h_i/g}}$"
        axes.plot(*_outline(deposit), label=label, **style)
    _draw_experiment(axes, shape, experiment)
    _draw_fronts(axes, deposits[-1][1])
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize="small")
    return _save(figure, path, svg)


def front_chart(
    path: Path,
    shape: ColumnShape,
    time: Array,
    fronts: Mapping[str, Array],
    height: Array,
    experiment: Experiment,
    gravity: float = 9.81,
    svg: bool = False,
) -> list[Path]:
    """Runout by each front definition and height, both normalised, against t / sqrt(h_i / g).

    Args:
        path: of the PNG.
        shape: the column as released.
        time: (n,) since release, s.
        fronts: front definition -> (n,) positions, m.
        height: (n,) of the pile, m.
        experiment: its final values are drawn as bands as wide as their scatter.
        gravity: m/s2.
        svg: write an SVG beside the PNG too.
    """
    figure = Figure(figsize=(7.0, 7.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    tau = time / sqrt(shape.h_i / gravity)
    for name, front in fronts.items():
        style = {key: value for key, value in FRONT_STYLES[name].items() if key != "marker"}
        upper.plot(tau, front / shape.r_i - 1.0, label=name, **style)
    lower.plot(tau, height / shape.h_i, color="black", label="height at the wall or axis")
    for axes, quantity in ((upper, "zeta"), (lower, "beta")):
        _draw_band(axes, experiment, quantity, shape.a)
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
        axes.grid(color="0.9")
        axes.legend(frameon=False, fontsize="small")
    figure.align_ylabels()
    upper.set(ylabel=r"runout $\zeta = (r - r_i)/r_i$ (-)", title=f"{shape.model}, $a$ = {shape.a:.3g}")
    lower.set(ylabel=r"height $h / h_i$ (-)", xlabel=TIME_LABEL)
    return _save(figure, path, svg)


def energy_chart(
    path: Path,
    shape: ColumnShape,
    time: Array,
    energies: Mapping[str, Array],
    gravity: float = 9.81,
    svg: bool = False,
) -> list[Path]:
    """Where the potential energy went since the first of the given times, and what the ledger does not explain.

    `energies` has (n,) arrays in J per metre or per radian under "potential", "residual" and the names of
    SINK_STYLES. All is in per cent of the column's potential energy at release.
    """
    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    tau = time / sqrt(shape.h_i / gravity)
    change = {
        name: 100.0 * (energy - energy[0]) / _potential_energy(shape, gravity) for name, energy in energies.items()
    }
    upper.plot(tau, -change["potential"], color="black", linewidth=2.2, label="potential, released")
    for name, style in SINK_STYLES.items():
        upper.plot(tau, change[name], label=name, **style)
    lower.plot(tau, change["residual"], color="black")
    upper.set(ylabel="energy (% of potential at release)", title=f"{shape.model}, $a$ = {shape.a:.3g}")
    lower.set(ylabel="residual (%)", xlabel=TIME_LABEL)
    figure.align_ylabels()
    for axes in (upper, lower):
        axes.grid(color="0.9")
        axes.axhline(0.0, color="black", linewidth=0.8)
    upper.legend(frameon=False, fontsize="small", ncols=2)
    return _save(figure, path, svg)


def chart_run(results: Results, times: Sequence[float] | None = None, svg: bool = False) -> list[Path]:
    """Draw profile.png, front.png and energy.png into the folder of a run; returns the paths written.

    `times` (s since release) chooses the profiles, each by the nearest snapshot; by default five, even in time.
    """
    shape, history, folder = results.shape, results.history, Path(results.folder)
    gravity = results.case.geometry.gravity
    experiment = find_experiment(results.case.score.experiment, shape.model)
    collapse = {name: column[history["time"] >= 0.0] for name, column in history.items()}
    fronts = {name: collapse[name] for name in FRONT_STYLES}
    energies = {name: collapse[name] for name in ("potential", *SINK_STYLES, "residual")}
    time, height = collapse["time"], collapse["height"]
    return [
        *profile_chart(folder / "profile.png", shape, _deposits(results, times), experiment, gravity, svg),
        *front_chart(folder / "front.png", shape, time, fronts, height, experiment, gravity, svg),
        *energy_chart(folder / "energy.png", shape, time, energies, gravity, svg),
    ]


def _deposits(results: Results, times: Sequence[float] | None) -> list[tuple[float, Measurement]]:
    taken = np.array([results.snapshot(i).time for i in range(len(results.snapshots))])
    wanted = np.linspace(max(taken[0], 0.0), taken[-1], 5) if times is None else np.asarray(times)
    nearest = np.unique([np.argmin(np.abs(taken - time)) for time in wanted])
    return [(taken[i], results.measure(int(i))) for i in nearest]


def _profile_axes(
    shape: ColumnShape, deposits: Sequence[Measurement], experiment: Experiment
) -> tuple[Figure, Axes]:
    """Equal axes around all that will be drawn, with the column's outline; the figure is as flat as the deposit."""
    expected = experiment.expected("zeta", shape.a)
    front = shape.r_i * (1.0 + sum(expected)) if expected else shape.r_i
    length = 1e3 * max([front] + [deposit.front["front_max"] for deposit in deposits])
    top = 1e3 * max([shape.h_i] + [deposit.profile_y.max() for deposit in deposits])
    figure = Figure(figsize=(8.0, min(7.0 * top / length, 8.0) + 2.3), layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    axes.set(
        xlim=(-0.03 * length, 1.03 * length),
        ylim=(-0.04 * length, top + 0.04 * length),
        xlabel="radius $r$ (mm)" if shape.model == "axisymmetric" else "distance from the wall $x$ (mm)",
        ylabel="height (mm)",
        title=f"{shape.model}, $a$ = {shape.a:.3g}",
    )
    column = 1e3 * np.array([[0.0, shape.r_i, shape.r_i], [shape.h_i, shape.h_i, 0.0]])
    axes.plot(*column, color="0.6", linestyle="--", label="column at release")
    axes.axhline(0.0, color="black", linewidth=0.8, zorder=0)
    return figure, axes


def _outline(deposit: Measurement) -> tuple[Array, Array]:
    """Profile in mm without its empty bins, continued level from the first bin centre to the wall."""
    height = np.append(deposit.profile_y[:1], deposit.profile_y)
    return 1e3 * np.append(0.0, deposit.profile_x), np.where(height > 0.0, 1e3 * height, np.nan)


def _draw_fronts(axes: Axes, deposit: Measurement) -> None:
    """Marks on the lower edge of the axes, clear of the profiles."""
    for name, front in deposit.front.items():
        marker, label = FRONT_STYLES[name]["marker"], f"{name}: {1e3 * front:.1f} mm"
        lower_edge = axes.get_xaxis_transform()
        axes.plot(1e3 * front, 0.0, f"k{marker}", label=label, transform=lower_edge, **HOLLOW)


def _draw_experiment(axes: Axes, shape: ColumnShape, experiment: Experiment) -> None:
    name = experiment.name
    zeta, beta = (experiment.expected(quantity, shape.a) for quantity in ("zeta", "beta"))
    if zeta:
        front, error = 1e3 * shape.r_i * (1.0 + zeta[0]), 1e3 * shape.r_i * zeta[1]
        axes.errorbar(front, 0.0, xerr=error, marker="D", label=f"{name}, front and scatter", **WITH_BARS)
    if beta:
        height, error = 1e3 * shape.h_i * np.array(beta)
        axes.errorbar(0.0, height, yerr=error, marker="^", label=f"{name}, height and scatter", **WITH_BARS)
    for profile in experiment.profiles if experiment.fits(shape.r_i, shape.h_i) else ():
        if profile.unit == "m":
            _draw_profile(axes, profile, 1e3, 1e3)
        elif zeta and beta:
            _draw_profile(axes, profile, front, height)


def _draw_profile(axes: Axes, profile: Profile, x_scale: float, y_scale: float) -> None:
    x, y = x_scale * np.array(profile.x), y_scale * np.array(profile.y)
    marker = "x" if "surface" in profile.name else "+"
    axes.plot(x, y, color=EXPERIMENT_COLOUR, linestyle="none", marker=marker, markersize=5, label=profile.name)


def _draw_band(axes: Axes, experiment: Experiment, quantity: str, a: float) -> None:
    expected = experiment.expected(quantity, a)
    if expected:
        value, half = expected
        label = f"{experiment.name}, final, with scatter"
        axes.axhspan(value - half, value + half, color=EXPERIMENT_COLOUR, alpha=0.15, linewidth=0)
        axes.axhline(value, color=EXPERIMENT_COLOUR, linestyle=(0, (10, 4)), linewidth=1.0, label=label)


def _potential_energy(shape: ColumnShape, gravity: float) -> float:
    """Of the column at release above the base: J per metre of width, or per radian."""
    width = shape.r_i**2 / 2.0 if shape.model == "axisymmetric" else shape.r_i
    return shape.density * gravity * width * shape.h_i**2 / 2.0


def _save(figure: Figure, path: Path, svg: bool) -> list[Path]:
    """PNG at 150 dpi and, on request, an SVG beside it; raises OutputError."""
    FigureCanvasAgg(figure)
    paths = [path, path.with_suffix(".svg")] if svg else [path]
    for target in paths:
        data = io.BytesIO()
        figure.savefig(data, format=target.suffix[1:], dpi=150)
        atomic_write(target, data.getvalue())
    return paths
