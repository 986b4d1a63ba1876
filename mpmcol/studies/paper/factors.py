"""Effect of each assumption that the paper leaves open or that mpmcol does not share, one at a time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.stats import sem

from mpmcol.studies.paper.report import QUANTITIES, Comparison, FigureResult
from mpmcol.studies.runs import REPEATED_CFL, CompletedRun, CompletedRuns, StudyRun, study_run

Column = tuple[str, float, float]  # case, a, node spacing in m

TITLE = "Effect of each assumption"
COLUMNS = (
    ("lube-channel", 1.0, 0.003),
    ("lube-channel", 3.0, 0.003),
    ("lube-cylinder", 0.9, 0.005),
    ("lube-cylinder", 2.75, 0.005),
    *((case, a, 0.0045) for case in ("lube-channel-loose", "lube-channel-dense") for a in (1.0, 3.0)),
)
QUICK = (("lube-cylinder", 0.9, 0.010),)
UNCHANGED = "shipped case"
FACTORS: dict[str, dict[str, str]] = {
    UNCHANGED: {},
    "no opening strain": {"method__opening_strain": "false"},
    "rigid floor (with wall impulse) instead of the elastic base": {
        "geometry__base": "rigid",
        "method__wall_impulse": "true",  # without it material points sink into a rigid floor
    },
    "no damping in the collapse": {"stages__collapse__damping": "0.0"},
    "position update as printed (Eq. 27)": {"method__position_update": "paper"},
    "initial stress assigned instead of loaded": {"stages__initial_stress": "k0"},
    "wall impulse in the FLIP velocity increment": {"method__wall_impulse": "true"},
    "B-splines truncated at walls": {
        "method__kernel_correction": "false",
        "method__stress_filter": "none",  # which needs the correction
    },
}
SOFTENING: dict[str, dict[str, str]] = {
    UNCHANGED: {},
    "no damping in the collapse": {"stages__collapse__damping": "0.0"},
    "softening strain doubled": {"material__strain_factor": "1.633"},  # published definitions differ by this factor
    "no dilatancy at peak": {"material__dilatancy_peak_deg": "0.0"},
}


def runs(quick: bool) -> list[StudyRun]:
    """Return repeated runs of each column with each factor."""
    return [
        run
        for column in (QUICK if quick else COLUMNS)
        for factor in factors_of(column)
        for run in repeated_runs(column, factor)
    ]


def evaluate(completed: CompletedRuns, quick: bool) -> FigureResult:
    """Return the change of runout and height by each factor, with the standard error of the repeated runs."""
    rows = []
    for column in QUICK if quick else COLUMNS:
        done = {
            factor: [completed[run] for run in repeated_runs(column, factor) if run in completed]
            for factor in factors_of(column)
        }
        rows += [effect_row(column, factor, repeats, done[UNCHANGED]) for factor, repeats in done.items()]
    changed = [row for row in rows if row["factor"] != UNCHANGED]
    comparisons = [_comparison(row, quantity) for row in changed for quantity in ("zeta.front_height", "beta")]
    return FigureResult(rows, comparisons)


def factors_of(column: Column) -> dict[str, dict[str, str]]:
    """Return the values that each factor replaces in the case of a column."""
    return SOFTENING if column[0].startswith("lube-channel-") else FACTORS


def repeated_runs(column: Column, factor: str) -> list[StudyRun]:
    """Return the repeated runs of a column with one factor."""
    case, a, h = column
    return [study_run(case, a, h, **factors_of(column)[factor], time__cfl=cfl) for cfl in REPEATED_CFL]


def effect_row(
    column: Column, factor: str, repeats: Sequence[CompletedRun], base: Sequence[CompletedRun]
) -> dict[str, Any]:
    """Return the row of a factor: means and their relative changes from the unchanged case."""
    name, a, h = column
    case = name.removeprefix("lube-")  # with and without the stress filter
    row: dict[str, Any] = {"case": case, "a": a, "h_mm": 1e3 * h, "factor": factor, "runs": len(repeats)}
    for quantity in QUANTITIES:
        own, reference = _mean(repeats, quantity), _mean(base, quantity)
        row[quantity] = own and own[0]
        change = error = None
        if own and reference:
            change = own[0] / reference[0] - 1.0
            error = float(np.hypot(own[1] / own[0], reference[1] / reference[0]))
        row[f"{quantity} change"], row[f"{quantity} change +-"] = change, error
    return row


def _mean(repeats: Sequence[CompletedRun], quantity: str) -> tuple[float, float] | None:
    """Return mean and standard error; None for fewer than two runs."""
    values = [run.row[quantity] for run in repeats]
    return None if len(values) < 2 else (float(np.mean(values)), float(sem(values)))


def _comparison(row: dict[str, Any], quantity: str) -> Comparison:
    change, error = row[f"{quantity} change"], row[f"{quantity} change +-"]
    done = f"{row['runs']} of {len(REPEATED_CFL)} runs successful"
    comment = done if error is None else f"+- {100.0 * error:.1f} %"
    return Comparison(
        f"{row['case']}, a = {row['a']:g}, {row['factor']}: change of {quantity}", change, comment=comment
    )
