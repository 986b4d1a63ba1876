"""Uncertainty of results that follows from that of the inputs."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpmcol.api.arguments import Notify, warn
from mpmcol.api.sweeps import name_of, source_of, texts_of
from mpmcol.case import Case
from mpmcol.errors import UsageError
from mpmcol.io.html import html_table
from mpmcol.io.results import Results
from mpmcol.studies.uncertainty.analysis import Passing, Quantity, analyse
from mpmcol.studies.uncertainty.inputs import parse_inputs
from mpmcol.studies.uncertainty.plan import plan_study, study_name
from mpmcol.studies.uncertainty.report import write_report
from mpmcol.studies.uncertainty.statistics import QUANTILES
from mpmcol.sweep.axes import Axis
from mpmcol.sweep.replaced import runs_that_leave
from mpmcol.sweep.report import write_report as write_sweep_report
from mpmcol.sweep.runner import SweepObserver, run_sweep


@dataclass(frozen=True, repr=False)
class UncertaintyResults:
    """Results of uncertain inputs: statistics of each quantity, probabilities, and the files of the report."""

    folder: Path
    rows: list[dict[str, Any]]  # of table.csv: one for each run
    quantities: Sequence[Quantity]
    passes: Sequence[Passing]
    record: dict[str, Any]  # content of uncertainty.json
    files: list[Path]

    @property
    def runs(self) -> list[Results]:
        """The results of the runs that are done, in the order of the rows."""
        return [Results(self.folder / row["folder"]) for row in self.rows if row["status"] == "done"]

    def quantity(self, name: str) -> Quantity:
        """A quantity by its name, for example "zeta.front_height". Raises UsageError if there is none."""
        found = {one.name: one for one in self.quantities}
        if name not in found:
            raise UsageError(f"there is no quantity {name!r}; expected one of: {', '.join(found) or 'none'}")
        return found[name]

    def __repr__(self) -> str:
        return f"<UncertaintyResults {str(self.folder)!r}: {self.record['done']} of {len(self.rows)} runs done>"

    def _repr_html_(self) -> str:
        statistics = [one.statistics for one in self.quantities]
        rows = [
            [one.name, one.unit, found.mean, found.standard_deviation, *found.quantiles.values()]
            for one, found in zip(self.quantities, statistics, strict=True)
        ]
        return html_table(["quantity", "unit", "mean", "standard deviation", *QUANTILES], rows)


def propagate(
    case: Case | Path | str,
    inputs: Mapping[str, str],
    values: Mapping[str, str | float] | None = None,
    *,
    samples: int = 64,
    seed: int = 0,
    passes: Sequence[float] = (),
    accuracy: float | None = None,
    corrected: bool = False,
    out: Path | str | None = None,
    fresh: bool = False,
    jobs: int | None = None,
    threads: int | None = None,
    observer: SweepObserver | None = None,
    notify: Notify = warn,
) -> UncertaintyResults:
    """Run a case for a Latin hypercube of uncertain inputs, as `mpmcol sweep --uncertain` does, and write a report.

    Inputs are independent. Each run has a Courant number of its own within 6 %, so that the scatter of a single run is
    part of the sample. Runs that are finished in the folder are not repeated.

    Args:
        case: from `load_case`, or a TOML file or the name of a shipped case.
        inputs: key -> distribution, for example {"material.friction_deg": "normal:33,1.5"}: normal:MEAN,SD,
            lognormal:MEDIAN,FACTOR (68 % within MEDIAN/FACTOR to MEDIAN*FACTOR), uniform:LOW,HIGH or
            triangular:LOW,MODE,HIGH; {"material.seed": "realizations"} gives each run a realization of its own of a
            random field.
        values: key -> value of other keys, the same in all runs.
        samples: number of runs, 5 to 10,000.
        seed: of the hypercube, not negative.
        passes: distances from the wall or axis, m, for the probability that the front (front_height) passes them.
        accuracy: relative error of runout and height, for example 0.05, for which all runs get the cheapest
            configuration of the shipped study at the means of the inputs (default: the grid of the case).
        corrected: runout, front and height are corrected for the error of the grid at the means, and the accuracy is
            that of corrected values.
        out: folder of the sweep (default: in "sweeps", named by case and keys).
        fresh: run again what is finished.
        jobs, threads: concurrent runs and threads per run (default: chosen from cores, memory and sizes).
        observer: receives the events of the sweep.
        notify: receives notes on rounded values, on differences from the study, and on runs that leave the table
            (default: warnings).

    Returns:
        Statistics of the runs that are done; a run that failed does not stop the others.

    Raises:
        CaseError: a distribution, a value or a sampled value is invalid; nothing was run.
        UsageError: there is no uncertain input, the number of samples or the accuracy is out of range, or the folder
            holds something else.
        OutputError: a file cannot be written.
        KeyboardInterrupt: the runs were stopped with a checkpoint; the same call resumes them.
    """
    if not inputs:
        raise UsageError("no uncertain input; give for example {'material.friction_deg': 'normal:33,1.5'}")
    uncertain, seeds, problems = parse_inputs([f"{key}={text}" for key, text in inputs.items()])
    fixed = [Axis(key, texts_of(key, value)) for key, value in (values or {}).items()]
    with tempfile.TemporaryDirectory() as temporary:
        named = Path("sweeps") / study_name(name_of(case), fixed, uncertain, accuracy, corrected, seeds)
        folder = Path(out) if out is not None else named
        plan = plan_study(
            source_of(case, Path(temporary)), fixed, uncertain, folder,
            samples=samples, seed=seed, accuracy=accuracy, corrected=corrected, seeds=seeds, problems=problems,
        )  # fmt: skip
    for line in [*plan.lines(), *(f"note: {note}" for note in runs_that_leave(folder, plan.runs))]:
        notify(line)
    outcomes = run_sweep(plan.runs, folder, jobs=jobs, threads=threads, fresh=fresh, observer=observer)
    sweep, analysis = write_sweep_report(outcomes, folder), analyse(plan, outcomes, passes)
    report = write_report(analysis, folder)
    for note in sweep.notes:
        notify(f"note: {note}")
    files = [*report.files, *sweep.files]
    return UncertaintyResults(folder, sweep.rows, analysis.quantities, analysis.passes, report.record, files)
