"""Summary table of a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from mpmcol.case import compared_experiment
from mpmcol.cli.bed_text import bed_lines
from mpmcol.cli.wall_text import wall_lines
from mpmcol.experiments import mark, without_laws
from mpmcol.io.results import Results
from mpmcol.measure.dissipation import walls_and_transfer
from mpmcol.studies.judgement import STILL_MOVING, judge
from mpmcol.units import length_scale

LABEL = 54  # width of the column with the names of quantities
FRONT_TEXT = {
    "front_max": "farthest point",
    "front_connected": "farthest without a gap",
    "front_height": "end of the deposit",
}


def summary_table(results: Results, accuracy: Sequence[str] = ()) -> str:
    """Runout and height with their errors, the cost of the run, its judgement, and its statement of accuracy if any."""
    judged = judge(results, with_grid=not accuracy)
    return "\n".join([*_measured(results), "", *_cost(results), "", *judged, *accuracy])


def _measured(results: Results) -> Iterator[str]:
    summary, shape = results.summary, results.shape
    experiment = compared_experiment(results.case) if summary["at_rest"] else without_laws(STILL_MOVING)
    nothing = "no law" if experiment.laws else ""
    errors = {
        (score["quantity"], score["front_definition"]): score
        for score in summary["errors"]
        if score["experiment"] == experiment.name
    }
    unit, factor = length_scale(max(shape.r_i, shape.h_i))
    heading = f"relative to {experiment.citation}" if experiment.laws else ""
    yield f"{'':{LABEL}s}{unit:>8s}{'':>8s}   {heading}".rstrip()
    for name, front in summary["front"].items():
        comparison = _comparison(errors.get(("zeta", name))) or nothing
        zeta, label = summary["zeta"][name], f"zeta, {name} ({FRONT_TEXT[name]})"
        if isinstance(zeta, dict):
            yield _line(label, f"{factor * front['mean']:.4g}", zeta["mean"], comparison)
            yield f"{'':{LABEL + 16}s}   {zeta['min']:.3f} to {zeta['max']:.3f} {shape.range_label}"
        else:
            yield _line(label, f"{factor * front:.4g}", zeta, comparison)
    yield _line("spread of zeta (between the definitions of the front)", "", summary["spread"], "")
    comparison = _comparison(errors.get(("beta", ""))) or nothing
    place = "at the wall or axis" if shape.outline is None else "of the deposit"
    yield _line(f"beta, height {place}", f"{factor * summary['height']:.4g}", summary["beta"], comparison)
    yield from bed_lines(results.erosion, shape, summary["energy_unit"])
    yield from _flows(summary)
    yield from wall_lines(summary.get("wall_forces"), shape.model)


def _flows(summary: dict[str, Any]) -> Iterator[str]:
    """Range of I and mu of each material with the mu(I) law."""
    flows = {"column": summary.get("flow"), **(summary.get("flow_by_material") or {})}
    for name, flow in flows.items():
        if flow:
            numbers = f"I {flow['I_p5']:.2g} to {flow['I_p95']:.2g}, median {flow['I_median']:.2g}"
            friction = f"mu {flow['mu_p5']:.3f} to {flow['mu_p95']:.3f}, median {flow['mu_median']:.3f}"
            yield f"flow of the {name}: {numbers}; {friction} (percentiles 5 to 95 of its mass and time with I > 1e-3)"


def _line(label: str, length: str, value: float, comparison: str) -> str:
    return f"{label:{LABEL}s}{length:>8s}{value:8.3f}   {comparison}".rstrip()


def _comparison(score: dict[str, Any] | None) -> str:
    if score is None:
        return ""
    if score["error"] is None:
        return str(score["comment"])
    return f"{score['expected']:.3f} ({score['error']:+.1%}, scatter {score['scatter']:.0%}){mark(score['verified'])}"


def _cost(results: Results) -> Iterator[str]:
    summary = results.summary
    wall, total = summary["wall_s"], sum(summary["wall_s"].values())
    ledger = summary["ledger"]
    ended = "at rest" if summary["at_rest"] else "stopped, not at rest,"
    rate = 1e3 / summary["ns_per_point_step"] if summary["ns_per_point_step"] else 0.0
    yield f"{summary['points']:,} material points, {summary['steps']:,} steps of {summary['dt']:.3g} s"
    parts = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in wall.items())
    yield f"{total:.1f} s: {parts}"
    threads = summary["threads"]
    yield f"{rate:.1f} million particle-steps per second with {threads} thread{'s' if threads > 1 else ''}"
    yield (
        f"{ended} after {summary['time_over_tau']:.2f} sqrt(h_i/g); worst J {summary['worst_J'][0]:.3f} ... "
        f"{summary['worst_J'][1]:.3f}; energy residual {ledger['residual']:+.2e} "
        f"{summary.get('energy_unit', 'J')}"
    )
    yield from _quality(summary, results.shape.potential_energy(results.case.geometry.gravity))


def _quality(summary: dict[str, Any], at_release: float) -> Iterator[str]:
    """Where the energy went, and how quiet the stresses are; at_release: potential energy of the column, J."""
    if shares := summary.get("dissipation"):
        yield energy_line(shares, at_release, summary.get("energy_unit", "J"))
    if stress := summary.get("stress"):
        yield (
            f"pressures, relative to the weight of the deposit at its foot: 99 % below {stress['pressure_p99']:.2f}, "
            f"at most {stress['pressure_max']:.2f}; points inside without stress: {100.0 * stress['stress_free']:.1f} %"
        )
        if "local_pressure_p1" in stress:  # results of earlier versions do not have it
            low, high = stress["local_pressure_p1"], stress["local_pressure_p99"]
            yield f"pressures inside, relative to the weight above them: 98 % between {low:z.2f} and {high:.2f}"


def energy_line(shares: Mapping[str, float], at_release: float, unit: str) -> str:
    """Where the released potential energy went; of walls and transfer the sum where one gives what the other takes.

    at_release: potential energy of the column at its release, J, of which the chart of the energies shows per cents.
    """
    together = walls_and_transfer(shares)
    walls = ("wall_friction",) if shares.get("wall_friction") else ()
    named = {name: shares[name] for name in ("friction", *walls, "damping")}
    if together is None:
        named |= {name: shares[name] for name in ("walls", "transfer")}
    else:
        named["walls and transfer together"] = together
    named["filter"] = shares["filter"]
    parts = ", ".join(f"{name.replace('_', ' ')} {100.0 * share:.1f} %" for name, share in named.items())
    share = 100.0 * shares["released"] / at_release
    return f"energy released, {shares['released']:.3g} {unit}, {share:.1f} % of the potential energy: {parts}"
