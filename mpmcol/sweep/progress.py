"""How far a sweep is and how long it will still take, from the files of its runs alone."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from mpmcol.errors import OutputError
from mpmcol.io.names import CASE_FILE, GIVEN_CASE_FILE
from mpmcol.io.run_status import RunStatus, read_status, running_for, time_reached
from mpmcol.sweep.plan import PLAN_FILE, Plan, PlanEntry, read_plan

MOST_SHARE = 0.95  # a run that takes longer than usual is never told as over


@dataclass(frozen=True)
class Part:
    """A point on its way."""

    point: PlanEntry
    state: RunStatus
    share: float  # of its work that is done
    seconds: float  # that it took so far

    @property
    def left(self) -> float:
        """Work that is left."""
        return self.point.work * (1.0 - self.share)


@dataclass
class Progress:
    """Looks at the runs of a plan; those that have ended are looked at once."""

    out: Path
    plan: Plan
    _ended: dict[str, Part] = field(default_factory=dict)

    def parts(self) -> list[Part]:
        """Every point as it is now."""
        return [self._ended.get(point.folder) or self._look(point) for point in self.plan.points]

    def _look(self, point: PlanEntry) -> Part:
        folder = self.out / point.folder
        state = read_status(folder)
        if state.has_ended:
            self._ended[point.folder] = Part(point, state, 1.0, state.seconds)
            return self._ended[point.folder]
        if state.name != "running":
            return Part(point, state, 0.0, 0.0)
        time = max(time_reached(folder) or 0.0, 0.0)
        return Part(point, state, min(time / point.end, MOST_SHARE), running_for(folder))


def plan_of(folder: Path) -> tuple[Plan, Path]:
    """The plan of a sweep, or of a single run as if it were one, and the folder that it is in.

    Raises OutputError if the folder holds neither.
    """
    case = next((folder / name for name in (CASE_FILE, GIVEN_CASE_FILE) if (folder / name).exists()), None)
    if (folder / PLAN_FILE).exists():
        return read_plan(folder), folder
    if case is None:
        raise OutputError(f"{folder}: neither the folder of a sweep ({PLAN_FILE}) nor of a run ({CASE_FILE})")
    from mpmcol.case import load_case
    from mpmcol.sweep.runs import PlannedRun

    point = PlannedRun({}, load_case(case), folder.resolve())
    run = PlanEntry(point.folder.name, {}, point.work, point.end)
    return Plan(point.case.title, "", 1, 1, (run,)), point.folder.parent


def share_done(parts: list[Part]) -> float:
    """Share of all work that is done."""
    return 1.0 - sum(part.left for part in parts) / sum(part.point.work for part in parts)


def time_left(parts: list[Part], jobs: int) -> float | None:
    """Seconds until all is done at the pace of the points so far; None while nothing tells it.

    The work that is left is shared evenly, but a point is never shared.
    """
    seen = [part for part in parts if part.seconds > 0.0 and part.share > 0.0 and part.state.name != "failed"]
    done = sum(part.point.work * part.share for part in seen)
    if not done:
        return None
    left = [part.left for part in parts]
    return max(sum(left) / jobs, max(left)) * sum(part.seconds for part in seen) / done


def counts(parts: list[Part]) -> dict[str, int]:
    """Points in each state."""
    return dict(Counter(part.state.name for part in parts))
