"""sweep.json: which points a sweep in a folder has, for whoever looks on or comes later."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mpmcol.errors import OutputError, UsageError
from mpmcol.io.atomic import atomic_write, make_folder
from mpmcol.io.values import to_json, toml_word

PLAN_FILE = "sweep.json"
PLAN_SCHEMA = 1


@dataclass(frozen=True)
class PlanEntry:
    """A point as the plan keeps it."""

    folder: str  # inside the sweep's
    inputs: Mapping[str, Any]
    work: float  # material points times steps, estimated
    end: float  # s since release at which the collapse usually ends


@dataclass(frozen=True)
class Plan:
    """What a sweep is: the case's title, its points, and how many run at a time."""

    title: str
    version: str
    jobs: int
    threads: int
    points: tuple[PlanEntry, ...]


def as_json(value: Any) -> str:
    """JSON of a plan or a report on one line; inputs that are not finite become the TOML words inf and nan."""
    return to_json(value, toml_word)


def write_plan(out: Path, plan: Plan) -> None:
    """Write sweep.json, unless it says the same already."""
    text = as_json({"schema": PLAN_SCHEMA, **asdict(plan)}).encode() + b"\n"
    path = out / PLAN_FILE
    if not path.exists() or path.read_bytes() != text:
        atomic_write(path, text)


def read_plan(out: Path) -> Plan:
    """Read sweep.json; OutputError if it cannot be."""
    path = out / PLAN_FILE
    try:
        content = json.loads(path.read_bytes())
        if content.pop("schema") != PLAN_SCHEMA:
            raise ValueError("it is of another version of mpmcol")
        content["points"] = tuple(PlanEntry(**point) for point in content["points"])
        return Plan(**content)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise OutputError(f"{path} cannot be read ({error}); run the sweep again") from None


def prepare_out(out: Path) -> Path:
    """Make the sweep's folder; UsageError if it holds something else than a sweep."""
    found = {path.name for path in out.iterdir() if path.name[0] != "."} if out.is_dir() else set()
    if found and PLAN_FILE not in found:
        raise UsageError(f"{out} is not empty and holds no sweep; use --out for another folder")
    return make_folder(out)
