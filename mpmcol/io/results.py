"""The folder of a run: what is in it, how it is written, and how it is read again."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import math
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import Case, case_hash, load_case
from mpmcol.errors import OutputError, UsageError
from mpmcol.io.atomic import (
    CASE_FILE,
    CHECKPOINT_FILES,
    DIGEST_FILE,
    GIVEN_CASE_FILE,
    HISTORY_FILE,
    INDEX_FILES,
    LOCK,
    LOG_FILE,
    RESULT_FILE,
    atomic_write,
    remove,
)
from mpmcol.io.checksums import digest_of, write_digests
from mpmcol.io.snapshot import Snapshot, list_snapshots, read_snapshot
from mpmcol.measure import ColumnShape, Measurement, measure
from mpmcol.setup.discretization import column_shape, discretize

RESULT_SCHEMA = 1
# the case last, so that a folder half emptied is still known for a run's
OWN_FILES = (
    RESULT_FILE, DIGEST_FILE, HISTORY_FILE, *INDEX_FILES, "snapshots", "profile.png", "front.png", "energy.png",
    "profile.svg", "front.svg", "energy.svg", "collapse.gif", "topview.png", "snapshot-*.png", *CHECKPOINT_FILES,
    CASE_FILE,
)  # fmt: skip
HISTORY = (
    "stage", "step", "time", "dt", "kinetic", "potential", "elastic", "plastic", "damping", "walls", "transfer",
    "residual", "front_max", "front_connected", "front_height", "height", "J_min", "J_max", "open_points",
    "grid_kinetic", "unbalanced",
)  # fmt: skip


class Results:
    """A run's folder, read on demand.

    Raises OutputError if the folder holds no run or a file in it is damaged.
    """

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)
        if not (self.folder / CASE_FILE).is_file():
            raise OutputError(f"{self.folder}: no {CASE_FILE} in it; expected the folder of a run (`mpmcol run`)")

    @cached_property
    def case(self) -> Case:
        """The case with all defaults filled in."""
        return load_case(self.folder / CASE_FILE)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The content of result.json."""
        path = self.folder / RESULT_FILE
        try:
            content = json.loads(path.read_text())
        except FileNotFoundError:
            raise OutputError(f"{path} is missing: the run has not ended; run the case again") from None
        except (OSError, ValueError) as error:
            raise OutputError(f"{path} cannot be read ({error}); run the case again with --fresh") from None
        if not isinstance(content, dict):
            raise OutputError(f"{path} does not hold a result; run the case again with --fresh")
        return content

    @property
    def status(self) -> str:
        """How the run ended: "done", "failed", "stopped", or "unfinished" where it did not."""
        return str(self.summary.get("status")) if (self.folder / RESULT_FILE).exists() else "unfinished"

    @property
    def came_to_rest(self) -> bool:
        """Whether the last state is a deposit at rest."""
        return self.status == "done" and bool(self.summary.get("at_rest"))

    @cached_property
    def history(self) -> dict[str, np.ndarray]:
        """Columns of history.csv; all but `stage` as numbers."""
        return read_history(self.folder / HISTORY_FILE)

    @property
    def snapshots(self) -> list[Path]:
        """Snapshot files in the order in which they were taken."""
        return list_snapshots(self.folder)

    def snapshot(self, index: int = -1) -> Snapshot:
        """One snapshot, the last by default; UsageError if there is none of that number."""
        paths = self.snapshots
        try:
            return read_snapshot(paths[index])
        except IndexError:
            raise UsageError(f"{self.folder}: no snapshot {index}; there are {len(paths)}, counted from 0") from None

    @cached_property
    def shape(self) -> ColumnShape:
        """What the deposit is measured against."""
        return column_shape(self.case, discretize(self.case))

    def measure(self, index: int = -1) -> Measurement:
        """Fronts, height and profile of one snapshot."""
        return measure_snapshot(self.snapshot(index), self.shape)


def measure_snapshot(snapshot: Snapshot, shape: ColumnShape) -> Measurement:
    """Measure the column's points of a snapshot."""
    column = snapshot.column & np.isfinite(snapshot.arrays["position"]).all(axis=1)
    arrays = {name: snapshot.arrays[name][column].astype(np.float64) for name in ("position", "mass", "displacement")}
    return measure(arrays["position"], arrays["mass"], arrays["displacement"], shape)


def prepare_folder(folder: Path, case: Case, fresh: bool, say: Callable[[str], None]) -> None:
    """Make room for a run of a case: a finished one is kept unless `fresh`, one that diverged is replaced, and told of.

    Raises UsageError for a finished run or a folder that holds something else, OutputError if it cannot be emptied.
    """
    if (folder / RESULT_FILE).exists() and not fresh:
        if _is_finished(folder):
            raise UsageError(f"{folder} holds a finished run; use --fresh to replace it, or --out for another folder")
        if Results(folder).summary.get("case_hash") != case_hash(case):
            say(f"note: a run of another case in {folder}, which had not come to its end, is replaced")
    found = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    if found - {LOCK, GIVEN_CASE_FILE, LOG_FILE} and CASE_FILE not in found:
        raise UsageError(f"{folder} is not empty and holds no run; use --out for another folder")
    for pattern in OWN_FILES:
        for path in folder.glob(pattern):
            remove(path)


def reopen_folder(folder: Path) -> None:
    """Let an unfinished run be gone on with: what told how it had ended is removed. Raises OutputError."""
    for name in (RESULT_FILE, DIGEST_FILE):
        remove(folder / name)


def _is_finished(folder: Path) -> bool:
    if not (folder / CASE_FILE).exists():
        return True
    status = Results(folder).summary.get("status")
    if status not in ("done", "failed", "stopped"):
        raise OutputError(f"{folder / RESULT_FILE} is damaged: its status is {status!r}; --fresh replaces the run")
    return bool(status == "done")


def read_history(path: Path) -> dict[str, np.ndarray]:
    """Columns of a history.csv; all but `stage` as numbers. Raises OutputError."""
    try:
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        return {
            name: np.array([row[name] if name == "stage" else float(row[name]) for row in rows]) for name in HISTORY
        }
    except (OSError, KeyError, TypeError, ValueError, csv.Error):
        raise OutputError(f"{path} is missing or damaged; run the case again with --fresh") from None


def write_history(folder: Path, rows: list[dict[str, Any]]) -> None:
    """Write history.csv whole."""
    text = io.StringIO()
    writer = csv.DictWriter(text, HISTORY, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    atomic_write(folder / HISTORY_FILE, text.getvalue().encode())


def write_result(folder: Path, result: Mapping[str, Any], snapshots: Mapping[str, str] | None = None) -> None:
    """Write result.json, and just before it the digests of all files of the run, its own too.

    Numbers that are not finite, which JSON cannot hold, become null. snapshots: their digests as they were when they
    were written, by name. Raises OutputError, also if one of these is gone.
    """
    content = (json.dumps(_finite(result), indent=1, allow_nan=False) + "\n").encode()
    for name in snapshots or ():
        if not (folder / name).is_file():
            raise OutputError(f"{folder / name} was removed while the run was going; run the case again with --fresh")
    there = [name for name in (GIVEN_CASE_FILE, CASE_FILE, HISTORY_FILE, *INDEX_FILES) if (folder / name).exists()]
    digests = {name: digest_of(folder / name) for name in there} | dict(snapshots or {})
    write_digests(folder, digests | {RESULT_FILE: hashlib.sha256(content).hexdigest()})
    atomic_write(folder / RESULT_FILE, content)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _finite(entry) for name, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
