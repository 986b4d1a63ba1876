"""The points of a sweep: which simulations it consists of, checked before any of them runs."""

from __future__ import annotations

import hashlib
import itertools
import json
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from mpmcol.case import Case, Problem, case_hash, load_case, resolved_toml
from mpmcol.case.problem import case_error
from mpmcol.case.schema import leaf_values
from mpmcol.errors import CaseError, UsageError
from mpmcol.io.atomic import atomic_write, make_folder
from mpmcol.io.names import GIVEN_CASE_FILE
from mpmcol.provenance import code_version
from mpmcol.setup.cost import durations
from mpmcol.setup.discretization import Discretization, discretize
from mpmcol.setup.memory import require_memory_for
from mpmcol.sweep.ranges import MOST_VALUES, Axis

ASPECT = "geometry.aspect"
SHORT_NAMES = {ASPECT: "a"}
LONGEST_NAME = 80

Combination = tuple[tuple[str, str], ...]  # keys and the texts of their values


@dataclass(frozen=True)
class PlannedRun:
    """One simulation of a sweep and the folder of its run."""

    inputs: Mapping[str, Any]  # key of the case -> its value in this point; SI units, angles in degrees
    case: Case
    folder: Path

    @property
    def name(self) -> str:
        """What a person calls it: the folder's name without its hash."""
        return self.folder.name.rpartition("-")[0]

    @cached_property
    def discretization(self) -> Discretization:
        """Sizes of its grid and column."""
        return discretize(self.case)

    @property
    def steps(self) -> int:
        """About how many time steps it takes."""
        base, column = self.case.base_material, self.case.material
        dt = self.case.time.cfl * self.discretization.h / max(base.wave_speed, column.wave_speed)
        return max(round(sum(durations(self.case, self.discretization)[0]) / dt), 1)

    @property
    def end(self) -> float:
        """When the collapse usually ends, s since release."""
        return durations(self.case, self.discretization)[0][1]

    @property
    def work(self) -> float:
        """Material points times steps."""
        return float(self.discretization.most_points * self.steps)


def plan_run(case: Case, out: Path, inputs: Mapping[str, Any], name: str) -> PlannedRun:
    """A point whose run goes into the folder `out`/`name`-hash.

    The hash is of all that decides the results and the snapshots, and of the version of the code.
    """
    content = [case_hash(case), case.output.model_dump(mode="json"), code_version()]
    digest = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:10]
    safe = re.sub(r"[^\w.+-]+", "_", name)[:LONGEST_NAME] or "point"
    return PlannedRun(dict(inputs), case, out / f"{safe}-{digest}")


def freeze(point: PlannedRun) -> Path:
    """Write the point's resolved case into its folder, where it is not yet; returns the file.

    Later edits of the case file then change nothing.
    """
    path = make_folder(point.folder) / GIVEN_CASE_FILE
    if not path.exists():
        atomic_write(path, resolved_toml(point.case).encode())
    return path


def plan_runs(
    source: str | Path, axes: Sequence[Axis], out: Path, zipped: bool = False, problems: Sequence[Problem] = ()
) -> list[PlannedRun]:
    """All combinations of the values of the axes (the product, the last axis fastest), or with `zipped` the first
    values of all axes, the second of all, and so on; an axis with one value goes with all.

    Raises:
        CaseError: with all problems of all points at once, each told once, after those that were found before.
    """
    found = {str(problem): problem for problem in problems}
    try:
        combinations = combine(axes, zipped)
    except ValueError as wrong:
        found[str(wrong)] = Problem("the axes", None, "", str(wrong), "")
        combinations = [((axis.key, text),) for axis in axes for text in axis.values]  # to find what else is wrong
    names = short_names([axis.key for axis in axes if len(axis.values) > 1] or [axis.key for axis in axes])
    points: list[PlannedRun] = []
    for combination in combinations:
        try:
            points.append(_checked(source, combination, out, names))
        except CaseError as error:
            found |= {str(problem): problem for problem in error.problems}
    if found or (found := {str(problem): problem for problem in _twins(points)}):
        raise case_error(list(found.values()))
    return points


def combine(axes: Sequence[Axis], zipped: bool) -> list[Combination]:
    """The keys and values of every point; ValueError if lengths do not match, or there are too many."""
    lengths = {axis.key: len(axis.values) for axis in axes}
    count = 1
    for length in lengths.values():
        count = max(count, length) if zipped else count * length
    if count > MOST_VALUES:
        raise ValueError(f"{count:,} points are too many: at most {MOST_VALUES:,}")
    if not zipped:
        return [tuple(zip(lengths, values, strict=True)) for values in itertools.product(*(a.values for a in axes))]
    if set(lengths.values()) - {1, count}:
        told = ", ".join(f"{key} {length}" for key, length in lengths.items())
        raise ValueError(f"--zip takes axes of one length, or of one value; these have: {told}")
    columns = [axis.values if len(axis.values) == count else axis.values * count for axis in axes]
    return [tuple(zip(lengths, values, strict=True)) for values in zip(*columns, strict=True)]


def notes(points: Sequence[PlannedRun]) -> list[str]:
    """What was rounded to fit the grids of the points, each once, with the number of points that it is true for."""
    told = Counter(warning for point in points for warning in point.discretization.warnings)
    of = {count: "" if count == len(points) else f" ({count} of {len(points)} points)" for count in told.values()}
    return [text + of[count] for text, count in told.items()]


def short_names(keys: Iterable[str]) -> dict[str, str]:
    """What the keys are called in the names of folders: their last word, or all of it where two share that."""
    keys = list(keys)
    shared = Counter(key.rpartition(".")[2] for key in keys)
    last = {key: key.rpartition(".")[2] for key in keys}
    return {key: SHORT_NAMES.get(key, last[key] if shared[last[key]] == 1 else key) for key in keys}


def _checked(source: str | Path, combination: Combination, out: Path, names: Mapping[str, str]) -> PlannedRun:
    """The point of these values; CaseError if its case is wrong or does not fit."""
    case = load_case(source, [f"{key}={text}" for key, text in combination])
    leaves = leaf_values(case)
    inputs = {key: leaves.get(key, text) for key, text in combination}
    name = "-".join(_label(names[key], inputs[key]) for key, _ in combination if key in names)
    point = plan_run(case, out, inputs, name or Path(source).stem)
    try:
        require_memory_for(point.discretization)
    except UsageError as error:
        raise case_error([Problem(f"point {point.name}", None, "", str(error), "")]) from None
    return point


def _label(name: str, value: Any) -> str:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return f"{name}{value:.12g}" if is_number else f"{name}-{value}"


def _twins(points: Sequence[PlannedRun]) -> list[Problem]:
    """Points that are one and the same simulation."""
    seen: dict[str, PlannedRun] = {}
    problems = []
    for point in points:
        digest = point.folder.name.rpartition("-")[2]
        first = seen.setdefault(digest, point)
        if first is not point:
            message = f"points {first.name} and {point.name} are the same simulation"
            problems.append(Problem("the axes", None, "", message, "give every simulation once"))
    return problems
