"""Consistency of the content of a run's files, in themselves and with one another."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from mpmcol.case import case_hash, load_case
from mpmcol.errors import CaseError, OutputError
from mpmcol.io.names import CASE_FILE, INDEX_FILES
from mpmcol.io.results import read_history
from mpmcol.io.run_status import read_result
from mpmcol.io.snapshot import DAMAGE, Snapshot, list_snapshots, read_snapshot

Result = dict[str, Any] | None  # the content of result.json, None if there is none


def result_problem(path: Path, result: Result) -> str:
    """Problem of result.json; "" if there is none."""
    if result is None:
        return read_result(path)[1]
    missing = {"zeta", "beta", "points", "steps", "versions", "case_hash"} - set(result)
    return f"it lacks {', '.join(sorted(missing))}" if missing else ""


def case_problem(path: Path, result: Result) -> str:
    """Problem of a stored case; "" if there is none."""
    try:
        case = load_case(path)
    except CaseError as error:
        return f"it is not a valid case: {error.problems[0] if error.problems else error}"
    if path.name == CASE_FILE and result is not None and case_hash(case) != result.get("case_hash"):
        return "the result is of another case"
    return ""


def history_problem(path: Path, result: Result) -> str:
    """Problem of history.csv; "" if there is none."""
    try:
        history = read_history(path)
    except OutputError:
        return "columns or rows are missing or truncated"
    steps = history["step"]
    if (np.diff(steps) < 0).any() or (np.diff(history["time"][history["stage"] == "collapse"]) < 0).any():
        return "its times do not increase"
    failed = result is not None and result.get("status") == "failed"
    if not failed and not all(np.isfinite(column).all() for name, column in history.items() if name != "stage"):
        return "it holds values that are not finite"
    return ""


def snapshot_problems(folder: Path, known: Iterable[str], result: Result) -> dict[str, str]:
    """Problems of snapshots by file name; those in `known` are damaged and not read."""
    problems, before, skipped = {}, -np.inf, set(known)
    points = result.get("points") if result else None
    for path in list_snapshots(folder):
        name = path.relative_to(folder).as_posix()
        if name in skipped:
            continue
        try:
            snapshot = read_snapshot(path)
            problem = _snapshot_problem(snapshot, points, before)
        except OutputError as error:
            problem = str(error).removeprefix(f"{path}: ").partition("; ")[0]
        except KeyError as error:
            problem = f"it lacks {error}"
        if problem:
            problems[name] = problem
        else:
            points, before = len(snapshot.arrays["id"]), snapshot.time
    return problems


def _snapshot_problem(snapshot: Snapshot, points: int | None, before: float) -> str:
    ids, arrays = snapshot.arrays["id"], snapshot.arrays
    if points is not None and len(ids) != points:
        return f"it holds {len(ids)} material points, expected {points}"
    if not np.array_equal(ids, np.arange(len(ids))):
        return "missing or duplicate particle ids"
    if snapshot.time < before:
        return f"its time, {snapshot.time:g} s, precedes that of the previous snapshot, {before:g} s"
    not_finite = [name for name, values in arrays.items() if not np.isfinite(values).all()]
    if not_finite and snapshot.stage != "failed":
        return f"values of {', '.join(not_finite)} are not finite"
    return ""


def index_problem(folder: Path, is_complete: bool) -> str:
    """Problem of run.vtkhdf and run.vtkhdf.series, which must list all snapshots of a completed run; "" if none."""
    names = [path.relative_to(folder).as_posix() for path in list_snapshots(folder)]
    index, series = (folder / name for name in INDEX_FILES)
    if not (is_complete or (index.exists() and series.exists())):
        return ""  # the run was killed before they were written
    try:
        steps = json.loads(series.read_bytes())["files"]
        listed = [step["name"] for step in steps]
        with h5py.File(index, "r", locking=False) as file:
            times = file["VTKHDF/Steps/Values"][()].tolist()
    except DAMAGE as error:
        return f"it, or {series.name}, cannot be read ({error})"
    if not set(listed) <= set(names) or (is_complete and listed != names):
        return f"{series.name} lists other snapshots than the folder holds"
    if is_complete and times != [step["time"] for step in steps]:
        return f"its times differ from those in {series.name}"
    return ""
