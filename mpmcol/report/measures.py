"""Measured quantities of finished runs as tables: of one run, and of several beside each other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mpmcol.experiments import EXPERIMENTS, mark
from mpmcol.io.results import Results
from mpmcol.io.run_status import run_seconds
from mpmcol.measure import Erosion
from mpmcol.report.model import Figure, Table
from mpmcol.units import length_text

FRONT_NAMES = {
    "front_height": "Runout, end of the deposit (front_height)",
    "front_connected": "Runout, without a gap (front_connected)",
    "front_max": "Runout, farthest point (front_max)",
}
SHARES = ("friction", "wall_friction", "damping", "walls", "transfer", "filter")
HEIGHT, ANGLE, END = "Height at the wall or axis (outline: largest)", "Angle of repose", "End of the run"
TIME_UNIT = "sqrt(h_i/g)"


@dataclass(frozen=True)
class Measure:
    """A quantity of a run.

    value: with its unit. normalised: without dimension. number: for differences between runs; None if they have no
    meaning.
    """

    name: str
    value: str = ""
    normalised: str = ""
    number: float | None = None

    @property
    def text(self) -> str:
        """Value and normalised value in one cell."""
        return ", ".join(filter(None, (self.value, self.normalised))) or "none"


def measures(results: Results) -> list[Measure]:
    """Runout, height and shape of the deposit, and the end of the run."""
    summary, shape = results.summary, results.shape
    tau = results.fall_time
    angle, undisturbed, stop = (summary.get(name) for name in ("repose_angle_deg", "undisturbed_radius", "stop_time"))
    to_base = " to the base" if shape.slope_deg else ""
    return [
        *(_runout(name, summary, shape.r_i, shape.range_label) for name in FRONT_NAMES),
        Measure("Spread of zeta (between the definitions of the front)", "", f"{summary['spread']:.3f}"),
        _length(HEIGHT, summary["height"], f"beta = {summary['beta']:.3f}"),
        Measure(ANGLE, "" if angle is None else f"{angle:.1f}°{to_base}{_flanks(summary)}", "", angle),
        Measure("Undisturbed radius") if undisturbed is None else _length("Undisturbed radius", undisturbed, ""),
        *_bed_measures(results.erosion, shape.r_i, summary.get("energy_unit", "J").replace("J", "kg", 1)),
        Measure("Area factor", "", f"{summary['area_factor']:.3f}", summary["area_factor"]),
        _time("Front stops after", stop, tau),
        _time(END, summary["time_over_tau"], tau),
        Measure("State at the end", "at rest" if summary["at_rest"] else "still moving"),
    ]


def _bed_measures(erosion: Erosion | None, r_i: float, unit: str) -> Iterator[Measure]:
    if erosion is not None:
        front = erosion.deposit_front
        yield _length("Runout over the old surface of the bed", front - r_i, f"zeta = {front / r_i - 1.0:.3f}")
        yield _length("Largest lowering of the surface of the bed", erosion.surface_drop, "")
        yield _length("Largest depth of material of the bed that moved", erosion.eroded_depth, "")
        yield Measure("Mass of the bed that moved", f"{erosion.eroded_mass:.3g} {unit}", "", erosion.eroded_mass)


def _flanks(summary: Mapping[str, Any]) -> str:
    low, high = summary.get("repose_low_x_deg"), summary.get("repose_high_x_deg")
    return "" if low is None or high is None else f" (mean of {low:.1f}° and {high:.1f}°)"


def cost_measures(results: Results) -> list[Measure]:
    """Size and cost of a run."""
    summary = results.summary
    h, threads = summary["spacing_used"], summary["threads"]
    return [
        Measure("Node spacing h", length_text(h), f"r_i/h = {summary['r_i'] / h:.3g}"),
        Measure("Material points", f"{summary['points']:,}", f"{summary['column_points']:,} in the column"),
        Measure("Time steps", f"{summary['steps']:,}", f"the last of {summary['dt']:.3g} s"),
        Measure("Computing time, without compilation", f"{run_seconds(summary):.1f} s", f"threads: {threads}"),
        Measure("Peak memory", f"{summary['peak_memory_bytes'] / 2**20:.0f} MiB"),
    ]  # fmt: skip


def energy_measures(results: Results) -> list[Measure]:
    """Where the potential energy released went, and the quality of the stresses."""
    shares, stress = (results.summary.get(name) or {} for name in ("dissipation", "stress"))
    foot = stress.get("weight_at_foot")
    return [
        *(Measure(f"Dissipated by {name.replace('_', ' ')}", _percent(shares.get(name))) for name in SHARES),
        Measure("Walls and transfer together", _percent(shares["walls"] + shares["transfer"] if shares else None)),
        Measure("Weight of the deposit at its foot", "" if foot is None else f"{1e-3 * foot:.3g} kPa"),
        Measure(
            "Pressure that 99 % of the points do not exceed, over this weight", _percent(stress.get("pressure_p99"))
        ),
        *(
            Measure(
                f"Percentile {p} of the pressure inside, over the weight above",
                _percent(stress.get(f"local_pressure_p{p}")),
            )
            for p in (1, 99)
        ),
        Measure("Points inside the deposit without stress", _percent(stress.get("stress_free"))),
    ]


def key_figures(results: Results, corrected: Mapping[str, tuple[float, float]]) -> list[Figure]:
    """What a reader looks for first; corrected: length in m and value of quantities that replace measured ones."""
    end = "At rest after" if results.summary["at_rest"] else "Still moving after"
    labels = {FRONT_NAMES["front_height"]: "Runout", HEIGHT: "Height", ANGLE: ANGLE, END: end}
    shown = [one for one in measures(results) if one.name in labels and one.value]
    return [_corrected_figure(labels[one.name], one, corrected) for one in shown]


def _corrected_figure(name: str, measure: Measure, corrected: Mapping[str, tuple[float, float]]) -> Figure:
    quantity = measure.normalised.partition(" ")[0]
    if quantity not in corrected:
        return Figure(name, measure.value, measure.normalised)
    length, value = corrected[quantity]
    return Figure(f"{name}, corrected", length_text(length), f"{quantity} = {value:.3f}")


def measure_table(rows: Sequence[Measure], caption: str) -> Table:
    """Measured quantities of one run."""
    cells = [(one.name, one.value or ("" if one.normalised else one.text), one.normalised) for one in rows]
    return Table(("Quantity", "Value", "Normalised"), cells, caption)


def value_table(rows: Sequence[Measure], caption: str) -> Table:
    """Other quantities of one run."""
    return Table(("Quantity", "Value"), [(one.name, one.text) for one in rows], caption)


def comparison_table(names: Sequence[str], runs: Sequence[Sequence[Measure]], caption: str) -> Table:
    """The quantities of several runs, with their relative differences from the first."""
    by_name = [{one.name: one for one in run} for run in runs]
    # a run may have quantities of its own: of a bed, of walls
    longest_first = sorted(by_name, key=len, reverse=True)
    quantities = dict.fromkeys(name for run in longest_first for name in run)
    rows = []
    for name in quantities:
        same = [run.get(name, Measure(name)) for run in by_name]
        rows.append([name, *(_compared(one, same[0]) for one in same)])
    return Table(("Quantity", *names), rows, caption)


def law_table(summary: Mapping[str, Any]) -> Table:
    """Runout (front_height) and height beside every published law that applies."""
    errors = summary["errors"] if summary["at_rest"] else ()
    scores = [one for one in errors if one["front_definition"] in ("front_height", "")]
    columns = (
        "Published by", "Material", "Quantity", "Published", "Computed", "Difference", "Scatter of the experiment",
    )  # fmt: skip
    return Table(columns, list(_law_rows(scores)), "Published experiments and simulations", texts=3)


def _law_rows(scores: Sequence[Mapping[str, Any]]) -> Iterator[Sequence[str]]:
    for one in scores:
        if one["expected"] is not None and one["error"] is not None:
            experiment = EXPERIMENTS[one["experiment"]]
            difference = f"{one['error']:+.1%}" + ("" if one["within_scatter"] else ", beyond the scatter")
            yield (
                f"{experiment.citation}{mark(one['verified'])}", experiment.material, one["quantity"],
                f"{one['expected']:.3f}", f"{one['value']:.3f}", difference, f"{one['scatter']:.0%}",
            )  # fmt: skip


def _runout(name: str, summary: Mapping[str, Any], r_i: float, range_label: str) -> Measure:
    front, zeta = summary["front"][name], summary["zeta"][name]
    if not isinstance(zeta, Mapping):
        return _length(FRONT_NAMES[name], front - r_i, f"zeta = {zeta:.3f}")
    text = f"zeta = {zeta['mean']:.3f} ({zeta['min']:.3f} to {zeta['max']:.3f} {range_label})"
    return _length(FRONT_NAMES[name], front["mean"] - r_i, text)


def _length(name: str, metres: float, normalised: str) -> Measure:
    return Measure(name, length_text(metres), normalised, metres)


def _time(name: str, over_tau: float | None, tau: float) -> Measure:
    if over_tau is None:
        return Measure(name)
    return Measure(name, f"{over_tau * tau:.3g} s", f"{over_tau:.2f} {TIME_UNIT}", over_tau * tau)


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100.0 * share:z.1f} %"


def _compared(one: Measure, first: Measure) -> str:
    if one is first or not one.number or not first.number:
        return one.text
    return f"{one.text} ({one.number / first.number - 1.0:+.1%})"
