"""Checks of bad input: no traceback, no long time, no large memory, and a message with file and line or key."""

from __future__ import annotations

import contextlib
import math
import re
import resource
import signal
import tempfile
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from mpmcol.case import Case, Problem, case_hash, load_case, resolved_toml
from mpmcol.errors import CaseError, UsageError
from mpmcol.setup.discretization import Discretization, discretize, require_thick_outline
from mpmcol.setup.memory import grid_bytes, memory_bytes, require_memory_for
from mpmcol.setup.model import build_model
from mpmcol.sweep.runs import PlannedRun

LONGEST = 1.0  # s of CPU time
ATTEMPTS = 3  # at an action that takes too long: other programs slow it down
PATIENCE = 120  # s of wall-clock time after which an action counts as hanging
ROOM = 2**30  # bytes that an action may allocate
SMALL = 20_000_000  # bytes of a model that is built for the check
EVERYWHERE = ("nested too deeply", "larger than", "cannot be read", "no such case file")  # messages without a line


class Hang(BaseException):
    """Raised when an action hangs; not an Exception, so that only `find_failure` catches it."""


def find_failure(action: Callable[[], str | None], longest: float = LONGEST) -> str | None:
    """Execute an action; return its own report, a traceback, or that it took too long; None if it passed.

    An action that takes too long is repeated; its shortest time counts.
    """
    took = math.inf
    try:
        for _ in range(ATTEMPTS):
            with _limited():
                started = time.process_time()
                failure = action()
                took = min(took, time.process_time() - started)
            if failure or took <= longest:
                break
    except Hang:
        return f"hangs: {PATIENCE} s"
    except Exception as bug:
        return "".join(traceback.format_exception(bug)[-4:])
    return failure or (f"takes {took:.1f} s" if took > longest else None)


@contextlib.contextmanager
def _limited() -> Iterator[None]:
    def hang(*_: object) -> None:
        raise Hang

    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    before = signal.signal(signal.SIGALRM, hang)
    resource.setrlimit(resource.RLIMIT_AS, (taken + ROOM, hard))
    signal.alarm(PATIENCE)
    try:
        yield
    finally:
        signal.alarm(0)
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
        signal.signal(signal.SIGALRM, before)


def failure_in_reading(source: str | Path, overrides: Sequence[str] = ()) -> str | None:
    """Read and discretize a case as a command does before running it; return what is wrong with the result."""
    try:
        case = load_case(source, overrides)
    except CaseError as refused:
        return failure_in_refusal(refused)
    try:
        discretization = discretize(case)
        require_memory_for(discretization)
        require_thick_outline(discretization)
    except UsageError as refused:
        return None if re.search(r"\b[a-z]+\.[a-z_]+\b", str(refused)) else f"the message names no key: {refused}"
    return _failure_in_case(case, discretization)


def failure_in_refusal(refused: CaseError) -> str | None:
    """Every problem must state its file, and its line or key."""
    return next(filter(None, map(_failure_in_problem, refused.problems)), None)


def _failure_in_problem(problem: Problem) -> str | None:
    placed = problem.line or problem.key or problem.file.startswith("--set ")
    is_complete = problem.file and problem.message and (placed or any(part in problem.message for part in EVERYWHERE))
    return None if is_complete and str(problem).replace("\n", "").isprintable() else f"the message is {str(problem)!r}"


def _failure_in_case(case: Case, discretization: Discretization) -> str | None:
    point = PlannedRun({}, case, Path())
    sizes = (
        discretization.h,
        discretization.base + discretization.h,
        discretization.depth,
        discretization.length,
        discretization.point_size,
        discretization.h_i,
        point.work,
    )
    if not all(math.isfinite(size) and size > 0.0 for size in (*sizes, point.end, point.steps)):
        return f"sizes are {sizes}, the end {point.end}, steps {point.steps}"
    if max(memory_bytes(discretization), grid_bytes(discretization)) < SMALL:
        points = build_model(case).points
        if not (np.isfinite(points.x).all() and np.isfinite(points.sigma).all() and (points.m > 0.0).all()):
            return "positions, stresses or masses are not finite"
    return _failure_in_copy(case)


def _failure_in_copy(case: Case) -> str | None:
    """A case must be read from its own resolved file unchanged."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.resolved.toml"
        path.write_text(resolved_toml(case), encoding="utf-8")
        copy = load_case(path)
    return None if case_hash(copy) == case_hash(case) else "its resolved file is another case"
