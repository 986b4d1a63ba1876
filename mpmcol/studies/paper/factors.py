"""What each assumption that we do not share with the paper, or that it leaves open, is worth: one at a time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcol.studies.paper.errors import QUANTITIES
from mpmcol.studies.paper.report import Report, Verdict
from mpmcol.studies.runs import Finished, Found, Member, with_settings

Column = tuple[str, float, float]  # case, a, node spacing in m

TITLE = "What each assumption is worth"
COLUMNS = (
    ("lube-channel", 1.0, 0.003),
    ("lube-channel", 3.0, 0.003),
    ("lube-cylinder", 0.9, 0.005),
    ("lube-cylinder", 2.75, 0.005),
    *((case, a, 0.0045) for case in ("lube-channel-loose", "lube-channel-dense") for a in (1.0, 3.0)),
)
QUICK = (("lube-cylinder", 0.9, 0.010),)
FACTORS: dict[str, dict[str, str]] = {
    "as shipped": {},
    "plain scheme without opening strain": {"method__opening_strain": "false"},
    "rigid floor (with its impulse) instead of the elastic base": {
        "geometry__base": "rigid",
        "method__wall_impulse": "true",  # points would sink into a floor that hands them none
    },
    "no damping in the collapse": {"stages__collapse__damping": "0.0"},
    "position update as printed (Eq. 27)": {"method__position_update": "paper"},
    "initial stress set, not loaded": {"stages__initial_stress": "k0"},
    "walls hand their impulse to the points": {"method__wall_impulse": "true"},
    "truncated splines at walls": {"method__kernel_correction": "false"},
}
SOFTENING: dict[str, dict[str, str]] = {
    "as shipped": {},
    "no damping in the collapse": {"stages__collapse__damping": "0.0"},
    "softening strain counted twice": {"material__strain_factor": "1.633"},  # published definitions differ
    "no dilatancy at the peak": {"material__dilatancy_peak_deg": "0.0"},
}
# The front is chaotic: runs that differ in the time step alone scatter by some per cent, so that each is repeated.
TIME_STEPS = ("0.46", "0.48", "0.5", "0.52")


def members(quick: bool) -> list[Member]:
    """Every factor on every column, some times."""
    return [
        _member(column, factor, cfl)
        for column in (QUICK if quick else COLUMNS)
        for factor in _factors(column)
        for cfl in TIME_STEPS
    ]


def report(found: Found, quick: bool) -> Report:
    """Change of runout and height by each factor, with the standard error of repeated runs."""
    rows = []
    for column in QUICK if quick else COLUMNS:
        base = _runs(found, column, "as shipped")
        rows += [_line(column, factor, _runs(found, column, factor), base) for factor in _factors(column)]
    factors = [row for row in rows if row["factor"] != "as shipped"]
    verdicts = [_verdict(row, quantity) for row in factors for quantity in ("zeta.front_height", "beta")]
    return Report(rows, verdicts)


def _factors(column: Column) -> dict[str, dict[str, str]]:
    """What is changed of a column, by name: the values that are replaced."""
    return SOFTENING if column[0].startswith("lube-channel-") else FACTORS


def _member(column: Column, factor: str, cfl: str) -> Member:
    case, a, h = column
    return with_settings(case, a, h, **_factors(column)[factor], time__cfl=cfl)


def _runs(found: Found, column: Column, factor: str) -> list[Finished]:
    return [found[m] for cfl in TIME_STEPS if (m := _member(column, factor, cfl)) in found]


def _line(column: Column, factor: str, runs: Sequence[Finished], base: Sequence[Finished]) -> dict[str, Any]:
    case, a, h = column
    line: dict[str, Any] = {"case": case, "a": a, "h_mm": 1e3 * h, "factor": factor, "runs": len(runs)}
    for quantity in QUANTITIES:
        ours, reference = _mean(runs, quantity), _mean(base, quantity)
        line[quantity] = ours and ours[0]
        change = error = None
        if ours and reference:
            change = ours[0] / reference[0] - 1.0
            error = float(np.hypot(ours[1] / ours[0], reference[1] / reference[0]))
        line[f"{quantity} change"], line[f"{quantity} change +-"] = change, error
    return line


def _mean(runs: Sequence[Finished], quantity: str) -> tuple[float, float] | None:
    """Mean and its standard error; None without two runs."""
    values = np.array([run.row[quantity] for run in runs])
    return None if len(values) < 2 else (float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values))))


def _verdict(row: dict[str, Any], quantity: str) -> Verdict:
    change, error = row[f"{quantity} change"], row[f"{quantity} change +-"]
    told = f"{row['runs']} of {len(TIME_STEPS)} runs ended well" if error is None else f"+- {100.0 * error:.1f} %"
    return Verdict(f"{row['case']}, a = {row['a']:g}, {row['factor']}: change of {quantity}", change, comment=told)
