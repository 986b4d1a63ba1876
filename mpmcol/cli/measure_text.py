"""Text output of `mpmcol measure`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from textwrap import fill
from typing import TYPE_CHECKING

from mpmcol.cli.bed_text import bed_lines
from mpmcol.cli.wall_text import wall_lines
from mpmcol.experiments import EXPERIMENTS, find_experiment, mark
from mpmcol.measure import friction_bias
from mpmcol.units import length_scale, length_text

if TYPE_CHECKING:
    from mpmcol.api.measured import Measured
    from mpmcol.experiments import ProfileScore, Score
    from mpmcol.measure import ColumnShape, Measurement

WIDTH = max(len(experiment.citation) for experiment in EXPERIMENTS.values())


def text_of(measured: Measured) -> str:
    """State of the run, measurements, and errors relative to published laws."""
    lines = [*_state_lines(measured), *_deposit_lines(measured), "", _heading(measured), *_score_lines(measured)]
    return "\n".join(lines)


def _state_lines(measured: Measured) -> list[str]:
    ends = {"done": ", at rest" if measured.at_rest else ", not at rest", "unfinished": " (no result.json)"}
    kind = "the final deposit" if measured.is_deposit else "not the final deposit"
    return [f"status: {measured.status}{ends.get(measured.status, '')}", f"t = {measured.time:.4g} s, {kind}"]


def _deposit_lines(measured: Measured) -> list[str]:
    shape, measurement, stop = measured.shape, measured.measurement, measured.stop_time
    undisturbed, angle, energy = measurement.undisturbed_radius, measurement.repose_angle_deg, measured.energy_released
    kind = "cylinder" if shape.is_round else shape.release if shape.dimension == 2 else shape.section
    return [
        f"{shape.model}, {kind}, {shape.proportions}, r_i = {length_text(shape.r_i)}{shape.slope_text}",
        *(_front_line(name, measured) for name in measurement.front),
        f"{'spread of zeta':<20} {measurement.spread:9.3f} (between the definitions of the front)",
        f"{'height':<20} {_length(measurement.height, shape)}   beta {measurement.beta:7.3f}",
        f"{'area factor':<20} {measurement.area_factor:9.3f}",
        *_repose_line(angle, measurement, shape),
        *_friction_line(measured),
        f"{'undisturbed radius':<20} " + ("none" if undisturbed is None else _length(undisturbed, shape)),
        *([] if stop is None else [f"{'front stops at':<20} {stop:9.2f} sqrt(h_i/g)"]),
        *bed_lines(measured.erosion, shape, measured.energy_unit),
        *wall_lines(measured.wall_forces, shape.model),
        *([] if energy is None else [f"{'energy released':<20} {energy:9.3g} {measured.energy_unit}"]),
    ]


def _flanks(measurement: Measurement) -> str:
    """The angles of two flanks, of which the angle of repose is the mean."""
    low, high = measurement.repose_low_x_deg, measurement.repose_high_x_deg
    return "" if low is None or high is None else f" (mean; toward smaller x {low:.1f}, toward larger x {high:.1f})"


def _to_horizontal(angle: float, shape: ColumnShape) -> str:
    """On a slope, where the angle is to the base, that to the horizontal; a 3D profile is a mean of all directions."""
    if not shape.slope_deg:
        return ""
    horizontal = f", {angle + shape.slope_deg:.1f} deg to the horizontal" if shape.dimension == 2 else ""
    return f" to the base{horizontal}"


def _repose_line(angle: float | None, measurement: Measurement, shape: ColumnShape) -> list[str]:
    if angle is None:
        return []
    return [f"{'angle of repose':<20} {angle:9.1f} deg{_to_horizontal(angle, shape)}{_flanks(measurement)}"]


def _friction_line(measured: Measured) -> list[str]:
    """The friction angle that the angle of repose corresponds to, and how far below that of the material it is."""
    angle, bias = measured.friction_from_repose, friction_bias(measured.shape)
    if angle is None:
        return []
    known = "its difference from that of the material is not studied for this column and grid"
    if bias is not None:
        known = f"{-bias[1]:g} to {-bias[0]:g} deg below that of the material"
    return [f"{'friction from repose':<20} {angle:9.1f} deg; {known}"]


def _front_line(name: str, measured: Measured) -> str:
    measurement = measured.measurement
    line = f"{name:<20} {_length(measurement.front[name], measured.shape)}   zeta {measurement.zeta[name]:7.3f}"
    if measurement.zeta_range is None:
        return line
    low, high = measurement.zeta_range[name]
    return f"{line}   {low:.3f} to {high:.3f} {measured.shape.range_label}"


def _length(metres: float, shape: ColumnShape) -> str:
    """A length in the unit that suits the column, in a column of the table."""
    unit, factor = length_scale(max(shape.r_i, shape.h_i))
    return f"{factor * metres:9.{1 if unit == 'mm' else 3}f} {unit:<2}"


def _heading(measured: Measured) -> str:
    if measured.shape.outline is not None:
        return find_experiment("paper", measured.shape.model, measured.shape.section).title
    subject = "error" if measured.is_deposit else "not a deposit at rest; its error"
    return f"{subject} relative to published laws (zeta: front_max / front_connected / front_height; * beyond scatter)"


def _score_lines(measured: Measured) -> list[str]:
    by_law = groupby(measured.scores, lambda score: (score.experiment, score.quantity))
    laws = [list(group) for _, group in by_law]
    return [
        *(_law_line(law) for law in laws if law[0].expected is not None),
        *(_profile_line(profile) for profile in measured.profiles),
        *_reason_lines([law[0] for law in laws if law[0].expected is None]),
    ]


def _law_line(scores: list[Score]) -> str:
    first = scores[0]
    errors = " / ".join(_percent(score) for score in scores)
    return (
        f"{_citation(first.experiment):<{WIDTH}} {first.quantity:<10}{first.expected:7.3f}  {errors:<34}"
        f"scatter {100.0 * first.scatter:4.1f} %  {first.comment}"
    )


def _reason_lines(scores: Sequence[Score]) -> Iterator[str]:
    """Why laws are not compared: each reason once, with the experiments and quantities to which it applies."""
    quantities: dict[str, dict[str, list[str]]] = {}  # by reason and experiment
    for score in scores:
        reason = score.comment.removesuffix(mark(verified=False))
        quantities.setdefault(reason, {}).setdefault(_citation(score.experiment), []).append(score.quantity)
    for reason, experiments in quantities.items():
        named = "; ".join(f"{experiment} ({', '.join(names)})" for experiment, names in experiments.items())
        yield f"not compared, {reason}:"
        yield fill(named, 110, initial_indent="  ", subsequent_indent="  ", break_on_hyphens=False)


def _citation(experiment: str) -> str:
    return EXPERIMENTS[experiment].citation


def _percent(score: Score) -> str:
    return f"{100.0 * (score.error or 0.0):+6.1f} %" + (" " if score.within_scatter else "*")


def _profile_line(profile: ProfileScore) -> str:
    tip = "" if profile.error is None else f", tip {100.0 * profile.error:+.1f} %"
    name = f"{_citation(profile.experiment):<{WIDTH}} {profile.profile}"
    return f"{name}: RMS distance {profile.rms_mm:.1f} mm{tip} ({profile.comment})"
