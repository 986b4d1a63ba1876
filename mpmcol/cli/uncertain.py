"""`mpmcol sweep --uncertain`: runs for a sample of uncertain inputs, with statistics and shares of the variance."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import Decorator, Positive

if TYPE_CHECKING:
    from mpmcol.studies.uncertainty.plan import UncertaintyPlan
    from mpmcol.sweep.engine import Outcome
    from mpmcol.sweep.report import SweepReport

Ending = tuple[dict[str, Any], Sequence[str]]
End = Callable[["Sequence[Outcome]", "SweepReport"], Ending]  # what is printed at the end of a sweep
SAMPLES, SEED = 64, 0


@dataclass(frozen=True)
class UncertainOptions:
    """Options of a sweep with uncertain inputs, as given; without any `inputs` it has none."""

    inputs: tuple[str, ...] = ()
    samples: int = SAMPLES
    seed: int = SEED
    passes: tuple[float, ...] = ()

    def plan(
        self,
        case: str,
        aspect: str | None,
        overrides: Sequence[str],
        slope: str | None,
        *,
        out: Path | None,
        accuracy: float | None,
        corrected: bool,
    ) -> tuple[UncertaintyPlan, Path]:
        """The planned runs and the folder of the sweep. Raises CaseError and UsageError."""
        from mpmcol.studies.uncertainty.inputs import parse_inputs
        from mpmcol.studies.uncertainty.plan import plan_study, study_name
        from mpmcol.sweep.axes import parse_axes

        fixed, problems = parse_axes(aspect, overrides, slope) if aspect or overrides or slope else ([], [])
        uncertain, seeds, more = parse_inputs(self.inputs)
        folder = out or Path("sweeps") / study_name(Path(case).stem, fixed, uncertain, accuracy, corrected, seeds)
        plan = plan_study(
            case, fixed, uncertain, folder,
            samples=self.samples, seed=self.seed, accuracy=accuracy, corrected=corrected, seeds=seeds,
            problems=[*problems, *more],
        )  # fmt: skip
        return plan, folder

    def notes(self, plan: UncertaintyPlan) -> list[str]:
        """Notes on the plan, and on distances that no front can pass."""
        length = max(run.discretization.length for run in plan.runs)
        far = [f"{distance:g} m" for distance in self.passes if distance > length]
        beyond = f"note: --passes: {', '.join(far)}: beyond the domain, {length:.4g} m long; write '350 mm' for mm"
        return [*plan.lines(), *([beyond] if far else [])]

    def ending(self, plan: UncertaintyPlan, outcomes: Sequence[Outcome], report: SweepReport) -> Ending:
        """What is printed at the end: the record for JSON, and lines; writes the report."""
        from mpmcol.cli.sweep_display import failures
        from mpmcol.studies.uncertainty.analysis import analyse
        from mpmcol.studies.uncertainty.record import summary_lines
        from mpmcol.studies.uncertainty.report import write_report

        analysis = analyse(plan, outcomes, self.passes)
        written = write_report(analysis, report.folder)
        files = [*written.files, *report.files]
        lines = [
            *summary_lines(analysis),
            *failures(report),
            *(f"note: {note}" for note in report.notes),
            f"in {report.folder}: " + ", ".join(path.name for path in files),
        ]
        more = {"notes": report.notes, "folder": str(report.folder), "files": [str(path) for path in files]}
        return {**written.record, **more}, lines


def uncertain_options(command: Any) -> Any:
    """The options for uncertain inputs, which the command receives as one `uncertain` of UncertainOptions."""

    @functools.wraps(command)
    def combined(
        *arguments: Any,
        uncertain: tuple[str, ...],
        samples: int | None,
        seed: int | None,
        passes: tuple[float, ...],
        **options: Any,
    ) -> Any:
        if not uncertain and (samples is not None or seed is not None or passes):
            raise click.UsageError("--samples, --seed and --passes require --uncertain KEY=DISTRIBUTION")
        if uncertain and options["zipped"]:
            raise click.UsageError("--zip combines given values, and --uncertain draws them; omit one of them")
        given = UncertainOptions(
            uncertain, SAMPLES if samples is None else samples, SEED if seed is None else seed, passes
        )
        return command(*arguments, uncertain=given, **options)

    decorated: Any = combined
    for option in reversed(list(_options())):
        decorated = option(decorated)
    return decorated


def _options() -> Iterator[Decorator]:
    yield click.option(
        "--uncertain", multiple=True, metavar="KEY=DISTRIBUTION",
        help="Draw the values of a key: normal:MEAN,SD, lognormal:MEDIAN,FACTOR (68 % are within MEDIAN/FACTOR to "
        "MEDIAN*FACTOR), uniform:LOW,HIGH or triangular:LOW,MODE,HIGH; material.seed=realizations gives each run a "
        "realization of its own of a random field. May be repeated. The time step (time.cfl) of each run is drawn as "
        "well, so that the scatter is known.",
    )  # fmt: skip
    yield click.option(
        "--samples", metavar="N", type=click.IntRange(5, 10_000),
        help=f"With --uncertain: number of runs, a Latin hypercube  [default: {SAMPLES}]",
    )  # fmt: skip
    yield click.option(
        "--seed", metavar="N", type=click.IntRange(0, 2**32),
        help=f"With --uncertain: seed of the hypercube  [default: {SEED}]",
    )  # fmt: skip
    yield click.option(
        "--passes", multiple=True, metavar="DISTANCE", type=Positive("m", "0.35 or '350 mm'"),
        help="With --uncertain: probability that the front (front_height, m from the wall or axis as front in "
        "result.json) passes this distance. May be repeated.",
    )  # fmt: skip
