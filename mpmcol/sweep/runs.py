"""Planned runs of a sweep: the combinations of the axes' values, checked before any of them starts."""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from mpmcol.case import Case, Problem, case_hash, load_case, resolved_toml
from mpmcol.case.problem import case_error
from mpmcol.case.values import leaf_values
from mpmcol.errors import CaseError, UsageError
from mpmcol.io.atomic import atomic_write, make_folder
from mpmcol.io.names import GIVEN_CASE_FILE
from mpmcol.provenance import code_version
from mpmcol.setup.cost import durations, relative_pace
from mpmcol.setup.discretization import Discretization, discretize, require_thick_outline
from mpmcol.setup.durations import time_step
from mpmcol.setup.memory import require_memory_for
from mpmcol.setup.unfit_settings import require_stiff_column
from mpmcol.sweep.axes import MOST_VALUES, Axis
from mpmcol.sweep.names import LONGEST_NAME, UNSAFE, member_name, short_names

Combination = tuple[tuple[str, str], ...]  # keys and the texts of their values
Configure = Callable[[Sequence[str]], Sequence[str]]  # from the overrides of a run to further ones


@dataclass(frozen=True)
class PlannedRun:
    """One run of a sweep and its results folder."""

    inputs: Mapping[str, Any]  # key of the case -> its value in this run; SI units, angles in degrees
    case: Case
    folder: Path

    @property
    def name(self) -> str:
        """The folder's name without its hash."""
        return self.folder.name.rpartition("-")[0]

    @cached_property
    def discretization(self) -> Discretization:
        """Sizes of its grid and column."""
        return discretize(self.case)

    @property
    def steps(self) -> int:
        """Estimated number of time steps."""
        dt = time_step(self.case, self.discretization.h)
        return max(round(sum(durations(self.case, self.discretization)[0]) / dt), 1)

    @property
    def end(self) -> float:
        """Estimated end of the collapse, s since release."""
        return durations(self.case, self.discretization)[0][1]

    @property
    def work(self) -> float:
        """Material points times steps, estimated."""
        return float(self.discretization.most_points * self.steps)

    @property
    def cost(self) -> float:
        """Time on one thread, estimated, in units of a point and step of the default method in two dimensions."""
        return self.work * relative_pace(self.case)


def plan_run(case: Case, out: Path, inputs: Mapping[str, Any], name: str) -> PlannedRun:
    """A run whose results go to the folder `out`/`name`-hash.

    The hash covers everything that affects results and snapshots, and the version of the code.
    """
    content = [case_hash(case), case.output.model_dump(mode="json"), code_version()]
    digest = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:10]
    safe = UNSAFE.sub("_", name)[:LONGEST_NAME] or "run"
    return PlannedRun(dict(inputs), case, out / f"{safe}-{digest}")


def write_case(run: PlannedRun) -> Path:
    """Write the resolved case into the run's folder unless it is there already; return the path of the file.

    The run reads this copy, so that later edits of the case file have no effect on it.
    """
    path = make_folder(run.folder) / GIVEN_CASE_FILE
    if not path.exists():
        atomic_write(path, resolved_toml(run.case).encode())
    return path


def no_configuration(overrides: Sequence[str]) -> Sequence[str]:
    """No further overrides."""
    return ()


def plan_runs(
    source: str | Path,
    axes: Sequence[Axis],
    out: Path,
    zipped: bool = False,
    problems: Sequence[Problem] = (),
    configure: Configure = no_configuration,
) -> list[PlannedRun]:
    """Runs for all combinations of the axes' values, the last axis varying fastest.

    With `zipped`, the first values of all axes are combined, then the second ones, and so on; an axis with one value
    is combined with each.

    Raises:
        CaseError: with the problems of all runs at once, each reported once, after the given `problems`.
    """
    found = {str(problem): problem for problem in problems}
    try:
        combinations = combine(axes, zipped)
    except ValueError as error:
        found[str(error)] = Problem("values", None, "", str(error), "")
        combinations = [((axis.key, text),) for axis in axes for text in axis.values]  # to find further problems
    names = short_names([axis.key for axis in axes if len(axis.values) > 1] or [axis.key for axis in axes])
    runs: list[PlannedRun] = []
    for combination in combinations:
        try:
            runs.append(_checked(source, combination, out, names, configure))
        except CaseError as error:
            found |= {str(problem): problem for problem in error.problems}
    if found or (found := {str(problem): problem for problem in _duplicates(runs)}):
        raise case_error(list(found.values()))
    return runs


def combine(axes: Sequence[Axis], zipped: bool) -> list[Combination]:
    """Keys and values of every run; ValueError if the lengths do not match or the runs are too many."""
    lengths = {axis.key: len(axis.values) for axis in axes}
    count = 1
    for length in lengths.values():
        count = max(count, length) if zipped else count * length
    if count > MOST_VALUES:
        raise ValueError(f"{count:,} runs are too many: expected at most {MOST_VALUES:,}")
    if not zipped:
        return [tuple(zip(lengths, values, strict=True)) for values in itertools.product(*(a.values for a in axes))]
    if set(lengths.values()) - {1, count}:
        counts = ", ".join(f"{key} {length}" for key, length in lengths.items())
        raise ValueError(f"--zip requires axes with equal numbers of values, or with one value; found: {counts}")
    columns = [axis.values if len(axis.values) == count else axis.values * count for axis in axes]
    return [tuple(zip(lengths, values, strict=True)) for values in zip(*columns, strict=True)]


def _checked(
    source: str | Path, combination: Combination, out: Path, names: Mapping[str, str], configure: Configure
) -> PlannedRun:
    """The run with these values; CaseError if its case is invalid, too soft, too large, or not configurable."""
    overrides = [f"{key}={text}" for key, text in combination]
    case = load_case(source, overrides)
    leaves = leaf_values(case)
    inputs = {key: leaves.get(key, text) for key, text in combination}
    name = member_name(source, inputs, names)
    try:
        if further := configure(overrides):
            case = load_case(source, [*overrides, *further])
        run = plan_run(case, out, inputs, name)
        require_memory_for(run.discretization)
        require_thick_outline(run.discretization)
        require_stiff_column(case)
    except UsageError as error:
        raise case_error([Problem(f"run {name}", None, "", str(error), "")]) from None
    return run


def _duplicates(runs: Sequence[PlannedRun]) -> list[Problem]:
    """Runs that are the same simulation."""
    seen: dict[str, PlannedRun] = {}
    problems = []
    for run in runs:
        digest = run.folder.name.rpartition("-")[2]
        first = seen.setdefault(digest, run)
        if first is not run:
            message = f"runs {first.name} and {run.name} are the same simulation"
            problems.append(Problem("values", None, "", message, "remove one of the two values"))
    return problems
