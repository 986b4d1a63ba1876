"""Charts of a results folder: profile.png, front.png, energy.png and, with recorded forces, walls.png."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import Case, compared_experiment, conditions_of
from mpmcol.errors import OutputError, UsageError
from mpmcol.io.atomic import make_folder
from mpmcol.io.results import Results, surface_of
from mpmcol.plotting.captions import heading_of, noted
from mpmcol.plotting.charts import energy_chart, front_chart, profile_chart
from mpmcol.plotting.measured_series import MeasuredSeries
from mpmcol.plotting.styles import FRONT_STYLES
from mpmcol.plotting.wall_charts import wall_chart
from mpmcol.units import length_text

FAR = 5.0  # times the length of the deposit


def chart_run(
    results: Results,
    *,
    times: Sequence[float] | None = None,
    svg: bool = False,
    points: Sequence[MeasuredSeries] = (),
    out: Path | None = None,
    notify: Callable[[str], None] = lambda note: None,
) -> list[Path]:
    """Draw profile.png, front.png, energy.png and, with recorded forces, walls.png; returns the paths written.

    Args:
        results: of the run.
        times: of the profiles, s since release; the nearest snapshots are drawn (default: four equally spaced times).
            The last state is always added.
        points: measurements of the user's own, drawn in profile.png.
        svg: also write each chart as SVG.
        out: folder of the charts, created if missing (default: the results folder).
        notify: receives a message for each unreadable snapshot, which is omitted.

    Raises:
        UsageError: the run ended before the release, or it has no snapshot near one of the times.
        OutputError: no snapshot can be read, or a chart cannot be written.
    """
    shape, history = results.shape, results.released_history
    options: dict[str, Any] = {"gravity": results.case.geometry.gravity, "svg": svg}
    experiment = compared_experiment(results.case)
    options["heading"] = heading_of(results.case, shape)
    compared = {**options, "heading": noted(options["heading"], experiment)}
    time, height, fronts = history["time"], history["height"], {name: history[name] for name in FRONT_STYLES}
    times_by_index = _readable(results, notify)
    deposits = [(times_by_index[i], results.measure(i)) for i in _nearest(times_by_index, times)]
    for note in _far_points(points, max(deposit.max_distance for _, deposit in deposits)):
        notify(note)
    at_rest = max(times_by_index) == len(results.snapshots) - 1 and results.came_to_rest
    folder = make_folder(out or Path(results.folder))
    surface = surface_of(results.snapshot(max(times_by_index)), shape)
    return [
        *profile_chart(
            folder / "profile.png",
            shape,
            deposits,
            experiment,
            at_rest=at_rest,
            points=points,
            over_bed=surface,
            **compared,
        ),
        *front_chart(folder / "front.png", shape, time, fronts, height, experiment, **compared),
        *energy_chart(folder / "energy.png", shape, time, history, **options),
        *wall_chart(
            folder / "walls.png",
            shape,
            history,
            results.wall_pressure,
            friction_deg=_rankine_angle(results.case),
            **options,
        ),
    ]


def _rankine_angle(case: Case) -> float | None:
    """Friction angle (degrees) of a column whose earth pressures follow from it alone: no layers, no cohesion."""
    conditions = conditions_of(case)
    return None if conditions.has_layers or conditions.cohesion else conditions.friction_deg


def _far_points(points: Sequence[MeasuredSeries], reach: float) -> Iterator[str]:
    """Notes on measurements far beyond the deposit, which ends at `reach` (m)."""
    for series in points:
        farthest = float(np.abs(series.r).max())
        if farthest > FAR * reach:
            yield (
                f"note: {series.label}: points up to {length_text(farthest)}, a deposit of {length_text(reach)}; "
                'lengths in mm need the header "r [mm],z [mm]"'
            )


def _readable(results: Results, notify: Callable[[str], None]) -> dict[int, float]:
    """Times (s) of the readable snapshots by index."""
    times: dict[int, float] = {}
    paths = results.snapshots
    for i, path in enumerate(paths):
        try:
            times[i] = results.snapshot(i).time
        except OutputError:
            what = "damaged" if path.exists() else "missing"
            notify(f"note: {path} is {what} and omitted; run the case again with --fresh to replace it")
    if not times:
        raise OutputError(f"{results.folder}: all {len(paths)} snapshots are damaged or missing; run the case again")
    return times


def _nearest(times_by_index: dict[int, float], times: Sequence[float] | None) -> list[int]:
    """Indices of the snapshots nearest to the times, and of the last snapshot."""
    index, moments = list(times_by_index), np.array(list(times_by_index.values()))
    spacing = np.diff(moments).max(initial=0.0)
    if times is None:  # the state at the release is the column, which every chart shows
        wanted = np.linspace(max(moments[0], 0.0), moments[-1], 5)[1:]
    else:
        wanted = np.asarray(times)
    for time in wanted:
        if not np.abs(moments - time).min() <= spacing:
            raise UsageError(
                f"no snapshot near t = {time:g} s: there are {len(index)} "
                f"from {moments[0]:.4g} s to {moments[-1]:.4g} s, at most {spacing:.4g} s apart; choose one of these"
            )
    nearest = {index[np.argmin(np.abs(moments - time))] for time in wanted}
    return sorted(nearest | {index[-1]})
