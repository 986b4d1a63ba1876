"""`mpmcol measure`: runout, height and shape of a deposit, and its errors against published laws."""

from __future__ import annotations

import json
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from mpmcol.experiments import ProfileScore, Score
    from mpmcol.measure import ColumnShape, Measurement
    from mpmcol.results import Results

EMPTY = "none"


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--snapshot", metavar="N", default=-1, show_default=True, help="Which one; -1 is the last.")
@click.option("--json", "form", flag_value="json", help="One line of JSON: the profile and all scores too.")
@click.option("--csv", "form", flag_value="csv", help="A header and one row.")
def measure(folder: Path, snapshot: int, form: str | None) -> None:
    """Measure the deposit of the results in DIR and compare it with every published law of its kind."""
    from mpmcol.results import Results

    results = Results(folder)
    measured, shape = results.measure(snapshot), results.shape
    stop = _stop_time(results, snapshot)
    scores, profiles = _scores(measured, shape, stop)
    if form == "json":
        click.echo(json.dumps(_record(measured, stop, scores, profiles)))
    elif form == "csv":
        click.echo(_csv(measured, stop, scores))
    else:
        click.echo("\n".join([*_deposit_lines(measured, shape, stop), "", *_score_lines(scores, profiles)]))


def _stop_time(results: Results, snapshot: int) -> float | None:
    """When the front came within a cell of its end, in sqrt(h_i / g); only for the last snapshot."""
    from mpmcol.measure import stop_time

    history, shape = results.history, results.shape
    collapse = history["stage"] != "equilibrate"
    if snapshot not in (-1, len(results.snapshots) - 1) or not collapse.any():
        return None
    stop = stop_time(history["time"][collapse], history["front_height"][collapse], shape.spacing)
    gravity: float = results.case.geometry.gravity
    return None if stop is None else stop / (shape.h_i / gravity) ** 0.5


def _scores(measured: Measurement, shape: ColumnShape, stop: float | None) -> tuple[list[Score], list[ProfileScore]]:
    from mpmcol.experiments import EXPERIMENTS, profile_score, score

    values: dict[str, Any] = {"zeta": measured.zeta, "beta": measured.beta}
    scores = score(values if stop is None else {**values, "stop_time": stop}, shape.a, shape.model)
    with_profiles = {  # once each, under the first name that has them
        experiment.profiles: experiment
        for experiment in reversed(EXPERIMENTS.values())
        if experiment.model == shape.model and experiment.fits(shape.r_i, shape.h_i)
    }
    profiles = [
        profile_score(measured.profile_x, measured.profile_y, experiment)
        for experiment in reversed(with_profiles.values())
    ]
    return scores, [profile for profile in profiles if profile is not None]


def _record(
    measured: Measurement, stop: float | None, scores: list[Score], profiles: list[ProfileScore]
) -> dict[str, Any]:
    return {
        **measured.scalars(),
        "stop_time": stop,
        "profile": {"x": measured.profile_x.tolist(), "y": measured.profile_y.tolist()},
        "scores": [score.as_dict() for score in scores],
        "profile_scores": [vars(profile) for profile in profiles],
    }


def _csv(measured: Measurement, stop: float | None, scores: list[Score]) -> str:
    """Columns depend on the kind of column only, so that the rows of many runs can be put together."""
    row: dict[str, Any] = {}
    for name, value in measured.scalars().items():
        row.update({f"{name}.{k}": v for k, v in value.items()} if isinstance(value, dict) else {name: value})
    row["stop_time"] = stop
    for score in scores:
        if score.quantity != "stop_time":
            words = ("error", score.experiment, score.quantity, score.front_definition)
            row[".".join(filter(None, words))] = score.error
    values = ("" if value is None else f"{value:.6g}" for value in row.values())
    return ",".join(row) + "\n" + ",".join(values)


def _deposit_lines(measured: Measurement, shape: ColumnShape, stop: float | None) -> list[str]:
    still = measured.undisturbed_radius
    fronts = [
        f"{name:<20} {1e3 * front:9.1f} mm   zeta {measured.zeta[name]:7.3f}" for name, front in measured.front.items()
    ]
    return [
        f"{shape.model}, {shape.release}, a = {shape.a:.3g}, r_i = {1e3 * shape.r_i:.4g} mm",
        *fronts,
        f"{'spread of zeta':<20} {measured.spread:9.3f}",
        f"{'height':<20} {1e3 * measured.height:9.1f} mm   beta {measured.beta:7.3f}",
        f"{'area factor':<20} {measured.area_factor:9.3f}",
        f"{'undisturbed radius':<20} " + (EMPTY if still is None else f"{1e3 * still:9.1f} mm"),
        f"{'front stops at':<20} " + (EMPTY if stop is None else f"{stop:9.2f} sqrt(h_i/g)"),
    ]


def _score_lines(scores: list[Score], profiles: list[ProfileScore]) -> list[str]:
    rows = [list(group) for _, group in groupby(scores, lambda score: (score.experiment, score.quantity))]
    known = [row for row in rows if row[0].expected is not None]
    unknown = [row[0] for row in rows if row[0].expected is None]
    return [
        "error against published laws (zeta: front_max / front_connected / front_height; * beyond scatter)",
        *(_law_line(row) for row in known),
        *(_shape_line(profile) for profile in profiles),
        *(f"{score.experiment:<24} {score.quantity:<10} {score.comment}" for score in unknown),
    ]


def _law_line(row: list[Score]) -> str:
    first = row[0]
    errors = " / ".join(_percent(score) for score in row)
    return (
        f"{first.experiment:<24} {first.quantity:<10}{first.expected:7.3f}  {errors:<34}"
        f"scatter {100.0 * first.scatter:4.1f} %  {first.comment}"
    )


def _percent(score: Score) -> str:
    return f"{100.0 * (score.error or 0.0):+6.1f} %" + (" " if score.within_scatter else "*")


def _shape_line(profile: ProfileScore) -> str:
    tip = "" if profile.error is None else f", tip {100.0 * profile.error:+.1f} %"
    name = f"{profile.experiment:<24} {profile.profile}"
    return f"{name}: RMS distance {profile.rms_mm:.1f} mm{tip} ({profile.comment})"
