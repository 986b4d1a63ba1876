"""The runs of an uncertainty study: the sample, on one grid for all, checked before any of them starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.case import Case, Problem, load_case
from mpmcol.case.problem import case_error, set_option
from mpmcol.case.values import leaf_values
from mpmcol.errors import CaseError, UsageError
from mpmcol.studies.definition import Value, as_overrides, as_text
from mpmcol.studies.pareto.recommend import Recommendation, recommend, require_free
from mpmcol.studies.runs import CFL
from mpmcol.studies.uncertainty.inputs import UncertainInput, realizations_option
from mpmcol.studies.uncertainty.sampling import Sample, draw_sample
from mpmcol.sweep.arguments import require_accuracy
from mpmcol.sweep.axes import Axis
from mpmcol.sweep.names import safe_name, sweep_name
from mpmcol.sweep.notes import notes_on_plan
from mpmcol.sweep.runs import PlannedRun, plan_runs

LEAST_SAMPLES, MOST_SAMPLES = 5, 10_000  # with five, the median is in the range of the sample with 94 %


@dataclass(frozen=True)
class UncertaintyPlan:
    """The planned runs of a sample, one for each of its rows."""

    inputs: Sequence[UncertainInput]
    sample: Sample
    seed: int
    runs: list[PlannedRun]
    means: Case  # the case with the means of the inputs, as configured
    recommendation: Recommendation | None  # of the grid; None without an accuracy
    accuracy: float | None
    corrected: bool = False  # runout and height are corrected for the error of the grid
    seeds: Sequence[str] = ()  # keys of those of random fields, which differ between the runs

    @property
    def remarks(self) -> list[str]:
        """What the statistics of the runs contain besides the inputs."""
        fields = ["each run has a realization of its own of the random field"] if self.seeds else []
        return fields + ["runout, front and height corrected for the error of the grid"] * self.corrected

    @property
    def residual(self) -> str:
        """What the variance contains besides the shares of the inputs."""
        return "realizations of the field, " * bool(self.seeds) + "scatter and terms that the surface omits"

    def lines(self) -> list[str]:
        """The configuration for all runs, where it was not studied, and warnings about the runs."""
        advice = self.recommendation
        chosen = [] if advice is None or self.accuracy is None else [
            f"cheapest within {100.0 * self.accuracy:.3g}%{', corrected for the error of the grid,' * self.corrected} "
            f'for the means of the inputs: "{advice.variant}" at r_i/h = {advice.cells:g}, for all runs',
            *(f"note: these errors may not apply: {difference}" for difference in advice.differences),
        ]  # fmt: skip
        return [*chosen, *(f"note: {note}" for note in notes_on_plan(self.runs))]


def study_name(
    name: str,
    fixed: Sequence[Axis],
    inputs: Sequence[UncertainInput],
    accuracy: float | None = None,
    corrected: bool = False,
    seeds: Sequence[str] = (),
) -> str:
    """Name of the default folder: the case, fixed values and uncertain keys."""
    uncertain = [Axis(key, ("uncertain", "")) for key in (*(one.key for one in inputs), *seeds)]
    return safe_name(f"{sweep_name(name, [*fixed, *uncertain], accuracy, corrected)}-uncertain")


def plan_study(
    source: str | Path,
    fixed: Sequence[Axis],
    inputs: Sequence[UncertainInput],
    out: Path,
    *,
    samples: int,
    seed: int,
    accuracy: float | None = None,
    corrected: bool = False,
    seeds: Sequence[str] = (),
    problems: Sequence[Problem] = (),
) -> UncertaintyPlan:
    """Draw the sample and plan its runs.

    All runs have the same configuration: that of the case, or the one recommended for the means of the inputs.

    Args:
        source: a TOML file or the name of a shipped case.
        fixed: keys with a value for all runs.
        out: folder of the sweep.
        corrected: the accuracy is that of runout and height corrected for the error of the grid.
        seeds: keys of those of random fields, of which each run has one of its own.
        problems: of the options, reported first.

    Raises:
        CaseError: with all problems; for a sampled value that the key does not accept, with its distribution.
        UsageError: samples, seed or accuracy are out of range, or no configuration has the accuracy.
    """
    _require_valid(samples, seed, accuracy, corrected)
    if found := [*problems, *_conflicts(fixed, [*(one.key for one in inputs), *seeds])]:
        raise case_error(found)
    overrides = [f"{axis.key}={axis.values[0]}" for axis in fixed]
    base = load_case(source, overrides)  # reports problems that do not depend on the sample
    _require_fields(base, seeds)
    sample = draw_sample(inputs, base.time.cfl, samples, seed, seeds)
    configuration: dict[str, Value] = {}
    try:
        at_means = [*overrides, *(f"{one.key}={one.distribution.mean:.6g}" for one in inputs)]
        advice = None if accuracy is None else recommend(source, at_means, accuracy, corrected)
        if advice:
            configuration |= advice.values
            require_free(advice, overrides)
        _require_chosen_once(inputs, configuration)
        means = load_case(source, [*at_means, *as_overrides(configuration)])
        sample = draw_sample(inputs, means.time.cfl, samples, seed, seeds)
        runs = plan_runs(source, _axes(fixed, sample, configuration), out, zipped=True)
    except CaseError as error:
        raise _refused(source, [*overrides, *as_overrides(configuration)], inputs, sample) or error from None
    return UncertaintyPlan(inputs, sample, seed, runs, means, advice, accuracy, corrected, seeds)


def _axes(fixed: Sequence[Axis], sample: Sample, configuration: Mapping[str, Value]) -> list[Axis]:
    """The keys of all runs: fixed and configured ones have one value, the others those sampled."""
    values = {axis.key: axis.values for axis in fixed}
    values |= {key: (as_text(value),) for key, value in configuration.items()}
    return [Axis(key, texts) for key, texts in (values | sample.values | sample.seeds | {CFL: sample.cfl}).items()]


def _require_valid(samples: int, seed: int, accuracy: float | None, corrected: bool) -> None:
    if not LEAST_SAMPLES <= samples <= MOST_SAMPLES:
        raise UsageError(f"samples = {samples}: expected {LEAST_SAMPLES} to {MOST_SAMPLES:,}")
    if seed < 0:
        raise UsageError(f"seed = {seed}: expected an integer >= 0")
    require_accuracy(accuracy, corrected)


def _require_fields(case: Case, seeds: Sequence[str]) -> None:
    """Refuse seeds of materials without a random field."""
    known = leaf_values(case)
    hint = 'set its law to "mohr-coulomb-random", whose keys are in `mpmcol explain material`, or remove the option'
    if missing := [
        Problem(realizations_option(key), None, key, f"the material has no random field, and no key {key}", hint)
        for key in seeds if key not in known
    ]:  # fmt: skip
        raise case_error(missing)


def _conflicts(fixed: Sequence[Axis], keys: Sequence[str]) -> list[Problem]:
    """Keys with several values, and keys that are both fixed and uncertain."""
    several = [
        Problem(
            _location(axis), None, axis.key, "expected one value beside uncertain keys",
            f"give one value, or a distribution, for example --uncertain {axis.key}=uniform:LOW,HIGH",
        )
        for axis in fixed if len(axis.values) > 1
    ]  # fmt: skip
    twice = [
        Problem(_location(axis), None, axis.key, f"{axis.key} is uncertain as well; remove one of them", "")
        for axis in fixed if axis.key in keys
    ]  # fmt: skip
    return several + twice


def _location(axis: Axis) -> str:
    return set_option(f"{axis.key}={','.join(axis.values)}")


def _require_chosen_once(inputs: Sequence[UncertainInput], configuration: Mapping[str, Value]) -> None:
    """Refuse uncertain keys that the configuration sets."""
    hint = "remove --accuracy and set the grid by --set grid.spacing=..., or remove the distribution"
    if chosen := [one for one in inputs if one.key in configuration]:
        raise case_error([Problem(one.option, None, one.key, f"--accuracy chooses {one.key}", hint) for one in chosen])


def _refused(
    source: str | Path, overrides: Sequence[str], inputs: Sequence[UncertainInput], sample: Sample
) -> CaseError | None:
    """The error for sampled values that the case does not accept; None if the cases of all samples are valid."""
    refused: dict[str, list[tuple[int, Problem]]] = {}  # by the key of the input
    for number, texts in enumerate(zip(*sample.values.values(), strict=True), 1):
        values = [f"{one.key}={text}" for one, text in zip(inputs, texts, strict=True)]
        try:
            load_case(source, [*overrides, *values])
        except CaseError as error:
            for problem in error.problems:
                for key in _blamed(problem, inputs):
                    refused.setdefault(key, []).append((number, problem))
    found = [_refusal(one, refused[one.key], sample) for one in inputs if one.key in refused]
    return case_error(found) if found else None


def _blamed(problem: Problem, inputs: Sequence[UncertainInput]) -> list[str]:
    """Keys of the inputs that a problem names; of all inputs if it names none."""
    texts = (problem.key, problem.file, problem.message, problem.hint)
    named = [one.key for one in inputs if any(one.key in text for text in texts)]
    return named or [one.key for one in inputs]


def _refusal(one: UncertainInput, refused: Sequence[tuple[int, Problem]], sample: Sample) -> Problem:
    """A problem for the first refused sample, with the range of those that are not refused."""
    number, first = refused[0]
    numbers, texts = {number for number, _ in refused}, sample.values[one.key]
    accepted = sorted((text for i, text in enumerate(texts, 1) if i not in numbers), key=float)
    message = (
        f"sample {number} of {len(texts)}, {one.key} = {texts[number - 1]}, is refused: {first.message} "
        f"({len(numbers)} of {len(texts)} samples)"
    )
    instead = f", for example uniform:{accepted[0]},{accepted[-1]} as in the other samples" if accepted else ""
    return Problem(
        one.option, None, one.key, message, f"give a distribution with a truncated range{instead}", about=first.about
    )
