"""How far the run in a folder is, read from its files; needs no compiler and no case."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from mpmcol.io.atomic import CASE_FILE, HISTORY_FILE, RESULT_FILE, is_locked

BEFORE_RELEASE = "equilibrate"

Name = Literal["done", "failed", "running", "stopped", "unfinished", "damaged", "missing"]


@dataclass(frozen=True)
class State:
    """How far a run is, with the content of its result.json where there is one.

    "failed" it diverged, "stopped" by a signal, "unfinished" it was killed, "damaged" its result cannot be read,
    "missing" nothing was begun.
    """

    name: Name
    result: dict[str, Any] | None = None

    @property
    def has_ended(self) -> bool:
        """Whether running it again would change nothing: it is done, or it diverged, which it would do again."""
        return self.name in ("done", "failed")

    @property
    def failure(self) -> str:
        """Why it diverged and what to do; "" if it did not."""
        if self.name != "failed" or self.result is None:
            return ""
        failure = self.result.get("failure", {})
        return "; ".join(failure[name] for name in ("cause", "remedy") if name in failure) or "it diverged"

    @property
    def seconds(self) -> float:
        """What the run took, without compilation."""
        wall = self.result.get("wall_s", {}) if self.result else {}
        return float(sum(value for name, value in wall.items() if name != "compile"))


def read_state(folder: Path) -> State:
    """The state of the run in a folder, which need not exist."""
    locked = is_locked(folder)  # first: a run writes its result before it lets go
    result = _read_result(folder / RESULT_FILE)
    if isinstance(result, dict) and result.get("status") == "done":
        return State("done", result)
    if locked:
        return State("running")
    if result is None:
        return State("unfinished" if (folder / CASE_FILE).exists() else "missing")
    if not isinstance(result, dict) or result.get("status") not in ("failed", "stopped"):
        return State("damaged")
    return State("failed" if result["status"] == "failed" else "stopped", result)


def _read_result(path: Path) -> Any:
    """The content of result.json, None if it is not there, False if it cannot be read."""
    try:
        return json.loads(path.read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, ValueError):
        return False


def reached(folder: Path) -> float | None:
    """Time since release, s, of the last row of a run's history; None before the release."""
    try:
        rows = (folder / HISTORY_FILE).read_text().splitlines()
        names, last = rows[0].split(","), rows[-1].split(",")
        return float(last[names.index("time")]) if last[names.index("stage")] != BEFORE_RELEASE else None
    except (OSError, ValueError, IndexError):
        return None


def running_for(folder: Path) -> float:
    """Seconds since the run in a folder began; 0 if it has not."""
    try:
        return max(time.time() - (folder / CASE_FILE).stat().st_mtime, 0.0)
    except OSError:
        return 0.0
