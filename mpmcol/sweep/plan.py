"""sweep.json, the plan of a sweep: its runs, and how many are executed at a time."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.atomic import atomic_write, make_folder, read_bytes
from mpmcol.io.values import to_json, toml_notation

PLAN_FILE = "sweep.json"
PLAN_SCHEMA = 3


@dataclass(frozen=True)
class PlanEntry:
    """A run in the plan."""

    folder: str  # name of its folder in the sweep's folder
    inputs: Mapping[str, Any]
    cost: float  # `PlannedRun.cost`
    end: float  # estimated end of the collapse, s since release


@dataclass(frozen=True)
class Plan:
    """A sweep: title of its case, version of the code, concurrent runs, threads per run, and its runs."""

    title: str
    version: str
    jobs: int
    threads: int
    runs: tuple[PlanEntry, ...]


def as_json(value: Any) -> str:
    """One line of JSON; numbers that are not finite, such as an infinite input, become the TOML words inf and nan."""
    return to_json(value, toml_notation)


def write_plan(out: Path, plan: Plan) -> None:
    """Write sweep.json, unless the same content is there already."""
    text = as_json({"schema": PLAN_SCHEMA, **asdict(plan)}).encode() + b"\n"
    path = out / PLAN_FILE
    if not path.exists() or read_bytes(path) != text:
        atomic_write(path, text)


def read_plan(out: Path) -> Plan:
    """Read sweep.json; OutputError if that fails."""
    path = out / PLAN_FILE
    try:
        content = json.loads(path.read_bytes())
        if content.pop("schema") != PLAN_SCHEMA:
            raise ValueError("written by another version of mpmcol")
        content["runs"] = tuple(PlanEntry(**run) for run in content["runs"])
        plan = Plan(**content)
        if not plan.runs or min(min(run.cost, run.end) for run in plan.runs) <= 0.0 or min(plan.jobs, plan.threads) < 1:
            raise ValueError("no runs, or a cost or a duration that is not positive")
        return plan
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise OutputError(f"{path} cannot be read ({error}); repeat the sweep command") from None


def prepare_out(out: Path) -> Path:
    """Create the sweep's folder; UsageError if it contains something other than a sweep."""
    found = {path.name for path in out.iterdir() if path.name[0] != "."} if out.is_dir() else set()
    if found and PLAN_FILE not in found:
        raise UsageError(f"{out}: the folder is not empty and contains no sweep; give another folder with --out")
    return make_folder(out)
