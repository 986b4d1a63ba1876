"""Fits of unknown values of a case to measurements."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpmcol.api.arguments import NOTE, Notify, warn
from mpmcol.api.sweeps import name_of, source_of
from mpmcol.case import Case
from mpmcol.case.overrides import Overrides, assignments, split_setting
from mpmcol.errors import UsageError
from mpmcol.io.html import html_table
from mpmcol.studies.fit import REPEATS, Fit, carry_out_fit
from mpmcol.studies.fit.agreement import Agreement
from mpmcol.studies.fit.quantities import Target, parse_targets, read_profile, targets_of
from mpmcol.studies.fit.report import lines, record, write_report
from mpmcol.studies.fit.unknowns import Unknown, unknowns_of
from mpmcol.studies.fit.values import FittedValue, fitted_values
from mpmcol.sweep.axes import Axis
from mpmcol.sweep.names import safe_name, sweep_name
from mpmcol.sweep.runner import SweepObserver

FOLDER = Path("fits")
Measured = float | Sequence[float]  # a value, or a value and its standard error


@dataclass(frozen=True, repr=False)
class FitResults:
    """A fit that has ended: the unknowns with their standard errors, and the files of the report."""

    folder: Path
    values: list[FittedValue]
    agreement: Agreement  # the measurements beside the computed values, and whether these reproduce them
    record: dict[str, Any]  # content of fit.json
    text: list[str]  # the answer in words
    files: list[Path]

    def __repr__(self) -> str:
        texts = [*map(str, self.values), *map(str, self.agreement.comparisons)]
        return f"<FitResults {str(self.folder)!r}: {'; '.join(texts)}>"

    def _repr_html_(self) -> str:
        rows = [[one.key, one.value, one.error] for one in self.values]
        texts = [[str(one)] for one in self.agreement.comparisons]
        return html_table(["unknown", "value", "standard error"], rows) + html_table(["measurement"], texts)


def fit(
    case: Case | Path | str,
    to: Mapping[str, Measured],
    vary: Mapping[str, Sequence[float]],
    *,
    profile: Path | str | None = None,
    overrides: Overrides = (),
    accuracy: float | None = None,
    repeats: int = REPEATS,
    out: Path | str | None = None,
    fresh: bool = False,
    jobs: int | None = None,
    threads: int | None = None,
    observer: SweepObserver | None = None,
    notify: Notify = warn,
) -> FitResults:
    """Find values of a case for which the deposit agrees with measurements, as `mpmcol fit` does.

    Args:
        case: from `load_case`, or a TOML file or the name of a shipped case.
        to: measured values by name (zeta, beta, repose in degrees, undisturbed_radius in m; at 1 and 2 sqrt(h_i/g)
            after the release zeta_at_1, zeta_at_2, beta_at_1, beta_at_2; stop_time in sqrt(h_i/g)), each a number or a
            number and its standard error, for example {"zeta": (1.37, 0.05)}. Without one 2 % are assumed, as for a
            profile.
        vary: unknown keys with the ends of their ranges, for example {"material.friction_deg": (20, 45)}.
        profile: CSV file of the measured profile, with the columns "r" and "z" in m.
        overrides: further values of the case, as of `load_case`.
        accuracy: relative error of runout and height, for which the answer gets a configuration of the shipped study
            and the search a coarser one (default: the grid of the case).
        repeats: runs for each set of values, 2 to 20.
        out: folder of the fit (default: in "fits", named by case, fixed values and keys).
        fresh: run again what is finished.
        jobs, threads: concurrent runs and threads per run (default: chosen from cores, memory and sizes).
        observer: receives the events of the runs.
        notify: receives remarks on the answer, for example that no values reproduce the measurements, or that these do
            not determine the values.

    Raises:
        CaseError: a value is invalid.
        UsageError: fewer measured values than unknowns, an unknown quantity, a number out of range, or a profile that
            cannot be read.
        OutputError: a file cannot be written.
    """
    with tempfile.TemporaryDirectory() as temporary:
        source = source_of(case, Path(temporary))
        targets = [*targets_of(to), *([] if profile is None else [read_profile(Path(profile))])]
        fixed = assignments(overrides)
        unknowns = unknowns_of(vary, source, fixed)
        folder = Path(out) if out is not None else default_folder(name_of(case), unknowns, fixed, accuracy)
        found = carry_out_fit(
            source, fixed, unknowns, targets, folder,
            accuracy=accuracy, repeats=repeats, jobs=jobs, threads=threads, fresh=fresh, observer=observer,
        )  # fmt: skip
        results = _results(found)
    for remark in results.record["remarks"]:
        notify(f"{NOTE}{remark}")
    return results


def parse_measured(text: str, profile: Path | None) -> list[Target]:
    """Measured values from the options of the command line. Raises UsageError."""
    targets = parse_targets(text) + ([] if profile is None else [read_profile(profile)])
    if not targets:
        raise UsageError("nothing measured; give --to zeta=1.37, --to zeta=1.37,beta=0.55, or --profile FILE")
    return targets


def default_folder(
    name: str, unknowns: Sequence[Unknown], overrides: Sequence[str] = (), accuracy: float | None = None
) -> Path:
    """Folder of a fit, named by that of the case, fixed values, the accuracy, and the keys that vary."""
    fixed = [Axis(key, (value,)) for key, value in map(split_setting, overrides)]
    return FOLDER / safe_name("-".join([sweep_name(name, fixed, accuracy), *(unknown.name for unknown in unknowns)]))


def _results(found: Fit) -> FitResults:
    return FitResults(
        found.folder, fitted_values(found), found.agreement, record(found), list(lines(found)), write_report(found)
    )
