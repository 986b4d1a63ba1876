"""What no input may do to mpmcol: end in a traceback, take longer than a second or a gigabyte, be refused nowhere."""

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
from mpmcol.setup.discretization import Discretization, discretize, require_memory_for
from mpmcol.setup.model import build_model
from mpmcol.sweep.runs import PlannedRun

LONGEST = 1.0  # s of CPU: of the wall's time other programs have a share
PATIENCE = 120  # s of the wall, after which a trial hangs
ROOM = 2**30  # bytes that a trial may take beyond what the process has
SMALL = 20_000_000  # bytes of a scene that is built, too
EVERYWHERE = ("nested too deeply", "larger than", "cannot be read", "no such case file")  # of no line


class Hang(BaseException):
    """No Exception, so that nobody but the judge takes it."""


def judge(action: Callable[[], str | None], longest: float = LONGEST) -> str | None:
    """Do it, and say what went wrong: what it says itself, a traceback, or too much time or memory; None if nothing."""
    try:
        with _limited():
            started = time.process_time()
            wrong = action()
            took = time.process_time() - started
    except Hang:
        return f"hangs: {PATIENCE} s"
    except Exception as bug:
        return "".join(traceback.format_exception(bug)[-4:])
    return wrong or (f"takes {took:.1f} s" if took > longest else None)


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


def wrong_with_reading(source: str | Path, overrides: Sequence[str] = ()) -> str | None:
    """Do with a case what a command does before it runs it; say what is wrong with how it goes or is refused."""
    try:
        case = load_case(source, overrides)
    except CaseError as refused:
        return wrong_with_refusal(refused)
    try:
        discretization = discretize(case)
        require_memory_for(discretization)
    except UsageError as refused:
        return None if re.search(r"\b[a-z]+\.[a-z_]+\b", str(refused)) else f"names no key: {refused}"
    return _wrong_with_case(case, discretization)


def wrong_with_refusal(refused: CaseError) -> str | None:
    """Every problem must have its place."""
    return next(filter(None, map(_wrong_with_problem, refused.problems)), None)


def _wrong_with_problem(problem: Problem) -> str | None:
    placed = problem.line or problem.key or problem.file.startswith("--set ")
    told = problem.file and problem.message and (placed or any(part in problem.message for part in EVERYWHERE))
    return None if told and str(problem).replace("\n", "").isprintable() else f"says {str(problem)!r}"


def _wrong_with_case(case: Case, discretization: Discretization) -> str | None:
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
    if max(discretization.memory_bytes, discretization.grid_bytes) < SMALL:
        points = build_model(case).points
        if not (np.isfinite(points.x).all() and np.isfinite(points.sigma).all() and (points.m > 0.0).all()):
            return "positions, stresses or masses are no numbers"
    return _wrong_with_copy(case)


def _wrong_with_copy(case: Case) -> str | None:
    """A case must come back from its own file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.resolved.toml"
        path.write_text(resolved_toml(case), encoding="utf-8")
        copy = load_case(path)
    return None if case_hash(copy) == case_hash(case) else "its resolved file is another case"
