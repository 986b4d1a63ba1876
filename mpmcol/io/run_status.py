"""Status of the run in a folder, read from its files without compiler and without loading the case."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

from mpmcol.io.columns import without_unit
from mpmcol.io.lock import is_locked
from mpmcol.io.names import CASE_FILE, HISTORY_FILE, RESULT_FILE, RESUMED_AT

BEFORE_RELEASE = "equilibrate"
RESULT_SCHEMA = 1  # of result.json
ENDINGS = ("done", "failed", "stopped")  # values of `status` in result.json

Name = Literal["done", "failed", "running", "stopped", "unfinished", "damaged", "missing"]


@dataclass(frozen=True)
class RunStatus:
    """Status of a run, with the content of its result.json where there is one.

    name: "done"; "failed": it diverged; "running"; "stopped": by a signal or the wall-clock limit; "unfinished": its
    process was killed; "damaged": its result cannot be read, for the reason in `problem`; "missing": it was not
    started.
    """

    name: Name
    result: dict[str, Any] | None = None
    problem: str = ""

    @property
    def has_ended(self) -> bool:
        """Whether repeating the run would change nothing: it is done, or it diverged and would diverge again."""
        return self.name in ("done", "failed")

    @property
    def failure(self) -> str:
        """Cause and remedy of a failure; "" if the run did not fail."""
        if self.name != "failed" or self.result is None:
            return ""
        failure = self.result.get("failure", {})
        return "; ".join(failure[name] for name in ("cause", "remedy") if name in failure) or "it diverged"

    @property
    def seconds(self) -> float:
        """Wall-clock time of the run without compilation, s."""
        return run_seconds(self.result or {})


def run_seconds(result: Mapping[str, Any]) -> float:
    """Wall-clock time of a run without compilation, s, from its result.json."""
    return float(sum(value for name, value in result.get("wall_s", {}).items() if name != "compile"))


def read_status(folder: Path) -> RunStatus:
    """Status of the run in a folder, which need not exist."""
    locked = is_locked(folder)  # first, because a run writes its result before it releases the lock
    result, problem = read_result(folder / RESULT_FILE)
    if result and result["status"] == "done":
        return RunStatus("done", result)
    if locked:
        return RunStatus("running")
    if problem:
        return RunStatus("damaged", problem=problem)
    if result is None:
        return RunStatus("unfinished" if (folder / CASE_FILE).exists() else "missing")
    return RunStatus("failed" if result["status"] == "failed" else "stopped", result)


def read_result(path: Path) -> tuple[dict[str, Any] | None, str]:
    """The content of result.json and "", None and its problem if it is damaged, or None and "" if it is missing."""
    try:
        content = json.loads(path.read_bytes())
    except FileNotFoundError:
        return None, ""
    except OSError as error:
        return None, f"it cannot be read: {error.strerror}"
    except (ValueError, RecursionError):
        return None, "it cannot be read: it is not JSON"
    problem = result_problem(content)
    return (None, problem) if problem else (content, "")


def result_problem(content: Any) -> str:
    """Why the content of a result.json is not a result of this version; "" if it is one."""
    if not isinstance(content, dict):
        return "it is not a result"
    if missing := [key for key in ("schema", "status") if content.get(key) is None]:
        return f"it lacks {' and '.join(missing)}"
    if content["schema"] != RESULT_SCHEMA:
        return f"its schema is {content['schema']!r}, expected {RESULT_SCHEMA}: written by another version of mpmcol"
    if content["status"] not in ENDINGS:
        return f"its status is {content['status']!r}, expected one of {', '.join(ENDINGS)}"
    return ""


class Moment(NamedTuple):
    """A row of the history of a run; time: s since release, or since the start of a run that was not released."""

    stage: str
    step: int
    time: float


def last_moment(folder: Path) -> Moment | None:
    """The last row of a run's history; None if there is none."""
    try:
        rows = (folder / HISTORY_FILE).read_text("utf-8").splitlines()
        last = dict(zip(map(without_unit, rows[0].split(",")), rows[-1].split(","), strict=True))
        return Moment(last["stage"], int(last["step"]), float(last["time"]))
    except (OSError, ValueError, IndexError, KeyError):
        return None


def time_reached(folder: Path) -> float | None:
    """Time since release in the last row of a run's history, s; None before the release."""
    last = last_moment(folder)
    return None if last is None or last.stage == BEFORE_RELEASE else last.time


def resumed_at(folder: Path) -> float:
    """Time since release at which the run in a folder was resumed last, s; 0 if it was not, or before the release."""
    try:
        found = re.search(rf"^# {RESUMED_AT} = (.+)$", (folder / CASE_FILE).read_text("utf-8"), re.MULTILINE)
        return float(found[1]) if found else 0.0
    except (OSError, ValueError):
        return 0.0


def running_for(folder: Path) -> float:
    """Wall-clock time since the run in a folder started or was resumed, s; 0 if it has not."""
    try:
        return max(time.time() - (folder / CASE_FILE).stat().st_mtime, 0.0)
    except OSError:
        return 0.0
