"""Parameter sweeps."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcol.api.arguments import Notify, warn
from mpmcol.case import Case, Problem, resolved_toml
from mpmcol.errors import UsageError
from mpmcol.io.html import html_table
from mpmcol.io.results import Results
from mpmcol.sweep.arguments import require_accuracy
from mpmcol.sweep.axes import ASPECT, Axis, parse_values
from mpmcol.sweep.fits import Slope
from mpmcol.sweep.names import UNSAFE, sweep_name
from mpmcol.sweep.notes import notes_on_plan
from mpmcol.sweep.replaced import runs_that_leave
from mpmcol.sweep.report import write_report
from mpmcol.sweep.runner import SweepObserver, run_sweep
from mpmcol.sweep.runs import PlannedRun, no_configuration, plan_runs

if TYPE_CHECKING:
    from mpmcol.api.accuracy import Recommendations

Values = str | float | Sequence[str | float]  # one value, several, or a text such as "0.5:7"
SHOWN = ("status", "a", "zeta.front_height", "beta", "at_rest", "seconds")  # columns of the table in a notebook


@dataclass(frozen=True, repr=False)
class SweepResults:
    """A sweep that has ended: a row for each run, fitted slopes, and the files of the report."""

    folder: Path
    rows: list[dict[str, Any]]  # inputs, status, measurements, errors, cost; None where there is no value
    slopes: list[Slope]
    files: list[Path]

    @property
    def runs(self) -> list[Results]:
        """The results of the runs that are done, in the order of the rows."""
        return [Results(self.folder / row["folder"]) for row in self.rows if row["status"] == "done"]

    def column(self, name: str) -> np.ndarray:
        """A column of the table as numbers, NaN where there is no value, for example "zeta.front_height".

        Raises UsageError if there is no such column.
        """
        if name not in self.rows[0]:
            raise UsageError(f"the table has no column {name!r}; expected one of: {', '.join(self.rows[0])}")
        return np.array([np.nan if row[name] is None else row[name] for row in self.rows], dtype=np.float64)

    def __repr__(self) -> str:
        done = sum(row["status"] == "done" for row in self.rows)
        return f"<SweepResults {str(self.folder)!r}: {done} of {len(self.rows)} runs done>"

    def _repr_html_(self) -> str:
        columns = [name for name in SHOWN if name in self.rows[0]]
        rows = [[row["folder"].rpartition("-")[0], *(row[name] for name in columns)] for row in self.rows]
        return html_table(["run", *columns], rows)


def sweep(
    case: Case | Path | str,
    values: Mapping[str, Values] | None = None,
    *,
    aspect: Values | None = None,
    accuracy: float | None = None,
    corrected: bool = False,
    zipped: bool = False,
    out: Path | str | None = None,
    fresh: bool = False,
    jobs: int | None = None,
    threads: int | None = None,
    observer: SweepObserver | None = None,
    notify: Notify = warn,
) -> SweepResults:
    """Run a case for many values of its keys, as `mpmcol sweep` does, and write table, fits and charts.

    Runs that are finished in the folder are not repeated; the others are executed in child processes.

    Args:
        case: from `load_case`, or a TOML file or the name of a shipped case.
        values: key -> value or values, for example {"material.friction_deg": [30, 33, 36]}; a text may hold ranges,
            such as "30:36:3". The values of several keys are combined in all ways.
        aspect: aspect ratios h_i / r_i, the same as the values of geometry.aspect.
        accuracy: relative error of runout and height, for example 0.05, for which each run gets the cheapest
            configuration of the shipped study (default: the grid of the case).
        corrected: the accuracy is that of runout and height corrected for the known error of the grid, which may then
            be coarser: columns zeta.finer_grids and beta.finer_grids.
        zipped: combine the first values of all keys, then the second ones, and so on.
        out: folder of the sweep (default: in "sweeps", named by case and keys).
        fresh: run again what is finished.
        jobs, threads: concurrent runs and threads per run (default: chosen from cores, memory and sizes).
        observer: receives the events of the sweep.
        notify: receives notes on rounded values, on runs that the study does not cover, and on those that leave the
            table (default: warnings).

    Returns:
        The table with the status of each run; a run that failed does not stop the others.

    Raises:
        CaseError: a value is invalid; lists all problems of all runs.
        UsageError: the folder holds something else.
        OutputError: a file cannot be written.
        KeyboardInterrupt: the runs were stopped with a checkpoint; the same call resumes them.
    """
    given = ({} if aspect is None else {ASPECT: aspect}) | dict(values or {})
    if aspect is not None and ASPECT in (values or {}):
        raise UsageError(f"aspect and values[{ASPECT!r}] are the same key; give one of them")
    if not given:
        raise UsageError("no key to vary; give aspect or values, for example {'material.friction_deg': [30, 33, 36]}")
    axes = [Axis(key, texts_of(key, one)) for key, one in given.items()]
    with tempfile.TemporaryDirectory() as temporary:
        source = source_of(case, Path(temporary))
        named = Path("sweeps") / sweep_name(name_of(case), axes, accuracy, corrected)
        folder = Path(out) if out is not None else named
        chosen = recommendations(source, accuracy, corrected)
        runs = planned_runs(source, axes, folder, chosen, zipped=zipped, notify=notify)
    for note in runs_that_leave(folder, runs):
        notify(f"note: {note}")
    outcomes = run_sweep(runs, folder, jobs=jobs, threads=threads, fresh=fresh, observer=observer)
    if chosen:
        chosen.state(outcomes)
    report = write_report(outcomes, folder)
    for note in report.notes:
        notify(f"note: {note}")
    return SweepResults(folder, report.rows, report.slopes, report.files)


def planned_runs(
    source: Path | str,
    axes: Sequence[Axis],
    out: Path,
    chosen: Recommendations | None,
    *,
    zipped: bool,
    notify: Notify,
    problems: Sequence[Problem] = (),
) -> list[PlannedRun]:
    """The runs of a sweep, with the grid of the case or those that `chosen` gives them.

    notify: receives which configurations were chosen, for which runs they were not studied, and rounded values.

    Raises CaseError with all problems of all runs, after the given `problems`.
    """
    runs = plan_runs(source, axes, out, zipped, problems, chosen or no_configuration)
    for line in [*(chosen.lines() if chosen else []), *(f"note: {note}" for note in notes_on_plan(runs))]:
        notify(line)
    return runs


def texts_of(key: str, values: Values) -> tuple[str, ...]:
    """Values as `--set` takes them. Raises UsageError if there is none."""
    if isinstance(values, str):
        try:
            return parse_values(values)
        except ValueError as error:
            raise UsageError(f"{key}: {error}") from None
    texts = tuple(_text(value) for value in (values if isinstance(values, Iterable) else [values]))
    if not texts:
        raise UsageError(f"{key}: no value; give one or more")
    return texts


def _text(value: str | float) -> str:
    if isinstance(value, str):
        return value
    return str(value).lower() if isinstance(value, (bool, np.bool_)) else repr(float(value)).removesuffix(".0")


def name_of(case: Case | Path | str) -> str:
    """The name of a case for a folder."""
    return UNSAFE.sub("_", case.title) or "case" if isinstance(case, Case) else Path(case).stem


def source_of(case: Case | Path | str, folder: Path) -> Path | str:
    """A file or name from which the case can be loaded with other values."""
    if not isinstance(case, Case):
        return case
    path = folder / "case.toml"
    path.write_text(resolved_toml(case), encoding="utf-8")
    return path


def recommendations(source: str | Path, accuracy: float | None, corrected: bool) -> Recommendations | None:
    """The configurations of the runs for an accuracy; None without one, for the grid of the case.

    Raises UsageError for an accuracy out of range, and for corrected values without one.
    """
    require_accuracy(accuracy, corrected)
    if accuracy is None:
        return None
    from mpmcol.api.accuracy import Recommendations  # with the studies, which take longer to import than all else

    return Recommendations(source, accuracy, corrected)
