"""`mpmcol measure`: runout, height and shape of a deposit, and its errors against published laws."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from itertools import groupby
from math import sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from mpmcol.experiments import ProfileScore, Score
    from mpmcol.io.results import Results
    from mpmcol.measure import ColumnShape, Measurement

EMPTY = "none"


@dataclass(frozen=True)
class State:
    """What was measured: how the run ended, and which moment of it this is."""

    status: str  # "done" | "failed" | "stopped" | "unfinished"
    at_rest: bool  # whether the run ended with the column at rest
    stage: str
    time: float  # s since release
    is_last: bool

    @property
    def is_deposit(self) -> bool:
        """Whether this is the deposit that the collapse left, and not a moment on the way."""
        return self.at_rest and self.is_last

    def as_dict(self) -> dict[str, Any]:
        """For JSON and CSV."""
        return {name: value for name, value in asdict(self).items() if name != "is_last"}

    def lines(self) -> list[str]:
        """Say it to a reader."""
        ends = {"done": ", at rest" if self.at_rest else ", still moving", "unfinished": " (no result.json)"}
        what = "the final deposit" if self.is_deposit else "not the final deposit"
        return [f"status: {self.status}{ends.get(self.status, '')}", f"t = {self.time:.4g} s, {what}"]


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--snapshot", metavar="N", default=-1, show_default=True, help="Which one; -1 is the last.")
@click.option("--json", "form", flag_value="json", help="One line of JSON: the profile and all scores too.")
@click.option("--csv", "form", flag_value="csv", help="A header and one row.")
def measure(folder: Path, snapshot: int, form: str | None) -> None:
    """Measure the deposit of the results in DIR and compare it with every published law of its kind."""
    from mpmcol.io.results import Results

    results = Results(folder)
    measured, shape, state = results.measure(snapshot), results.shape, _state(results, snapshot)
    stop = _stop_time(results) if state.is_deposit else None
    scores, profiles = _scores(measured, shape, stop)
    if form == "json":
        click.echo(json.dumps(state.as_dict() | _record(measured, stop, scores, profiles)))
    elif form == "csv":
        click.echo(_csv(state, measured, stop, scores))
    else:
        lines = [*state.lines(), *_deposit_lines(measured, shape, stop), "", _score_heading(state)]
        click.echo("\n".join([*lines, *_score_lines(scores, profiles)]))


def _state(results: Results, snapshot: int) -> State:
    taken = results.snapshot(snapshot)
    return State(
        status=results.status,
        at_rest=results.came_to_rest,
        stage=taken.stage,
        time=taken.time,
        is_last=snapshot in (-1, len(results.snapshots) - 1),
    )


def _stop_time(results: Results) -> float | None:
    """Time at which the front stops, in sqrt(h_i / g); None, with a note, if the history cannot be read."""
    from mpmcol.errors import OutputError
    from mpmcol.io.names import HISTORY_FILE
    from mpmcol.io.results import measure_stop_time

    try:
        history = results.history
    except OutputError:
        history = {}
    if not len(history.get("time", ())):
        path = results.folder / HISTORY_FILE
        problem = "is damaged: rows or columns are missing or truncated" if path.exists() else "is missing"
        click.echo(f"note: {path} {problem}; the stop time of the front is omitted", err=True)
        return None
    fall_time = sqrt(results.shape.h_i / results.case.geometry.gravity)
    return measure_stop_time(history, results.shape.spacing, fall_time)


def _scores(measured: Measurement, shape: ColumnShape, stop: float | None) -> tuple[list[Score], list[ProfileScore]]:
    from mpmcol.experiments import profile_scores, score

    values: dict[str, Any] = {"zeta": measured.zeta, "beta": measured.beta}
    scores = score(values if stop is None else {**values, "stop_time": stop}, shape.a, shape.model, shape.section)
    profile = measured.profile_x, measured.profile_y
    return scores, profile_scores(*profile, shape.model, shape.r_i, shape.h_i, shape.section)


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


def _csv(state: State, measured: Measurement, stop: float | None, scores: list[Score]) -> str:
    """Columns depend on the kind of column only, so that the rows of many runs can be put together."""
    from mpmcol.io.values import flatten

    row: dict[str, Any] = state.as_dict() | {"at_rest": str(state.at_rest).lower()}
    row |= dict(flatten(measured.scalars()))
    row["stop_time"] = stop
    for score in scores:
        if score.quantity != "stop_time":
            words = ("error", score.experiment, score.quantity, score.front_definition)
            row[".".join(filter(None, words))] = score.error
    return ",".join(row) + "\n" + ",".join(map(_cell, row.values()))


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    return "" if value is None else f"{value:.6g}"


def _deposit_lines(measured: Measurement, shape: ColumnShape, stop: float | None) -> list[str]:
    still = measured.undisturbed_radius
    kind = shape.release if shape.dimension == 2 else shape.section
    return [
        f"{shape.model}, {kind}, a = {shape.a:.3g}, r_i = {1e3 * shape.r_i:.4g} mm",
        *(_front_line(name, measured, shape.range_label) for name in measured.front),
        f"{'spread of zeta':<20} {measured.spread:9.3f}",
        f"{'height':<20} {1e3 * measured.height:9.1f} mm   beta {measured.beta:7.3f}",
        f"{'area factor':<20} {measured.area_factor:9.3f}",
        f"{'undisturbed radius':<20} " + (EMPTY if still is None else f"{1e3 * still:9.1f} mm"),
        *([] if stop is None else [f"{'front stops at':<20} {stop:9.2f} sqrt(h_i/g)"]),
    ]


def _front_line(name: str, measured: Measurement, range_label: str) -> str:
    line = f"{name:<20} {1e3 * measured.front[name]:9.1f} mm   zeta {measured.zeta[name]:7.3f}"
    if measured.zeta_range is None:
        return line
    low, high = measured.zeta_range[name]
    return f"{line}   {low:.3f} to {high:.3f} {range_label}"


def _score_heading(state: State) -> str:
    of = "error" if state.is_deposit else "this is no deposit at rest; its error"
    return f"{of} against published laws (zeta: front_max / front_connected / front_height; * beyond scatter)"


def _score_lines(scores: list[Score], profiles: list[ProfileScore]) -> list[str]:
    rows = [list(group) for _, group in groupby(scores, lambda score: (score.experiment, score.quantity))]
    known = [row for row in rows if row[0].expected is not None]
    unknown = [row[0] for row in rows if row[0].expected is None]
    return [
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
