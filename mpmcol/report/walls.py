"""Recorded forces on walls: table of one run, and rows for several beside each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mpmcol.io.glossary import FORCE_UNITS, MOMENT_UNITS
from mpmcol.io.results import Results
from mpmcol.report.measures import Measure, comparison_table
from mpmcol.report.model import Table

CAPTION = "Forces on walls (peaks with elastic waves)"
FORCES = {  # entries of wall_forces in result.json -> heading
    "at_release": "at release", "peak": "peak", "sustained": "sustained over 0.2 sqrt(h_i/g)", "at_end": "at the end",
}  # fmt: skip
COMPARED = {"peak": "Force on {}, peak", "sustained": "Force on {}, sustained", "moment": "Largest moment on {}"}


def force_tables(results: Results) -> list[Table]:
    """The forces and moments on each wall of a run; none if it records none."""
    forces, model = results.summary.get("wall_forces"), results.shape.model
    if not forces:
        return []
    moment = f"largest moment about the foot, of the floor about x = 0 ({MOMENT_UNITS[model]})"
    forces_in = (f"{text} ({FORCE_UNITS[model]})" for text in FORCES.values())
    columns = ("Wall", *forces_in, "end of the peak (s)", "mean over (s)", moment)
    names = (*FORCES, "time", "window", "moment")
    rows = [(wall.replace("_", " "), *(_digits(force.get(name)) for name in names)) for wall, force in forces.items()]
    return [Table(columns, rows, CAPTION)]


def compared_forces(names: Sequence[str], runs: Sequence[Results]) -> list[Table]:
    """The largest forces and moments of several runs; none if no run records them."""
    measured = [list(_measures(results)) for results in runs]
    if not any(measured):
        return []
    unrecorded = [name for name, results in zip(names, runs, strict=True) if not results.summary.get("wall_forces")]
    caption = CAPTION + (f" (not recorded: {', '.join(unrecorded)})" if unrecorded else "")
    return [comparison_table(names, measured, caption)]


def _measures(results: Results) -> Iterator[Measure]:
    """Largest forces and moments on the walls that the flow presses on."""
    model = results.shape.model
    for wall, force in (results.summary.get("wall_forces") or {}).items():
        for name, text in COMPARED.items():
            value, unit = force.get(name), (MOMENT_UNITS if name == "moment" else FORCE_UNITS)[model]
            if force["peak"] > 0.0 and value is not None:
                yield Measure(text.format(wall.replace("_", " ")), f"{value:.3g} {unit}", "", value)


def _digits(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"
