"""mpmcol status: how far a sweep or a run is."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.duration import duration

if TYPE_CHECKING:
    from mpmcol.sweep.plan import Plan
    from mpmcol.sweep.progress import Part

STATUS_SCHEMA = 1
WORDS = {
    "unfinished": "unfinished: its process was killed",
    "stopped": "stopped   by a signal",
    "damaged": "damaged: its result.json cannot be read",
}


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--json", "to_json", is_flag=True, help="Print one line of JSON.")
def status(folder: Path, to_json: bool) -> None:
    """Say what of the sweep in DIR is done, running, failed or missing, and how long it will still take.

    DIR may also be the folder of a single run.
    """
    from mpmcol.sweep.plan import as_json
    from mpmcol.sweep.progress import Progress, plan_of

    plan, root = plan_of(folder)
    parts = Progress(root, plan).parts()
    if to_json:
        click.echo(as_json(_record(folder, plan, parts)))
    else:
        click.echo("\n".join(_lines(folder, plan, parts)))


def _record(folder: Path, plan: Plan, parts: list[Part]) -> dict[str, Any]:
    from mpmcol.sweep.progress import counts, time_left

    points = [
        {"folder": part.point.folder, "inputs": part.point.inputs, "state": part.state.name, "share": part.share,
         "seconds": part.seconds, "message": part.state.failure}
        for part in parts
    ]  # fmt: skip
    return {
        "schema": STATUS_SCHEMA,
        "folder": str(folder),
        "version": plan.version,
        "counts": counts(parts),
        "seconds_left": time_left(parts, plan.jobs),
        "points": points,
    }


def _lines(folder: Path, plan: Plan, parts: list[Part]) -> Iterator[str]:
    from mpmcol.provenance import code_version
    from mpmcol.sweep.progress import counts, time_left

    told = ", ".join(f"{count} {name}" for name, count in counts(parts).items())
    yield f"{folder}: {plan.title or 'untitled'}, {told}"
    width = max(len(part.point.folder) for part in parts)
    for part in parts:
        yield f"  {part.point.folder:{width}}  {_state(part)}".rstrip()
    states, left = {part.state.name for part in parts}, time_left(parts, plan.jobs)
    if "running" in states and left is not None:
        yield f"about {duration(left)} left"
    elif "running" not in states and states - {"done", "failed"}:
        again = "" if left is None else f" and takes about {duration(left)}"
        yield f"nothing is running; the same command again completes it{again}"
    if plan.version not in ("", code_version()):
        yield f"note: made by mpmcol {plan.version}, this is {code_version()}, with which a sweep begins anew"


def _state(part: Part) -> str:
    state = part.state
    if state.name == "running":
        return f"running   {part.share:.0%} in {duration(part.seconds)}"
    if state.name == "failed":
        return f"failed    {state.failure}"
    if state.name == "done":
        return f"done      {duration(part.seconds)}"
    return WORDS.get(state.name, state.name)
