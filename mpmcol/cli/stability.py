"""mpmcol stability: scenes in which methods fail, beside those that stand."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.option_types import JOBS

if TYPE_CHECKING:
    from mpmcol.failure_modes import Stability
    from mpmcol.failure_modes.scenario import SceneOutcome
    from mpmcol.studies.method_map import Drawn

RECORD_SCHEMA = 1
FAILED = 4  # exit code


@click.command()
@click.argument("names", nargs=-1, metavar="[SCENE]... | --map [MAP]")
@click.option("--list", "to_list", is_flag=True, help="Name the scenes and what they show; nothing is played.")
@click.option(
    "--map", "to_map", is_flag=True, help="Draw a map instead: a TOML file or a shipped one (default, quick)."
)
@click.option("--out", type=click.Path(path_type=Path), help="Folder; stability or stability/map-NAME by default.")
@click.option("--jobs", type=JOBS, help="Runs of a map at a time; chosen from their sizes by default.")
@click.option("--report-only", is_flag=True, help="Run nothing: the map from the runs that have ended.")
@click.option("--quiet", is_flag=True, help="Print nothing but the verdicts; of a map nothing.")
@click.option("--json", "to_json", is_flag=True, help="Print outcomes and files as one line on stdout.")
def stability(
    names: tuple[str, ...], to_list: bool, to_map: bool, out: Path | None, jobs: int | None, report_only: bool,
    quiet: bool, to_json: bool,
) -> None:  # fmt: skip
    """Play small scenes in which a method fails and another one stands, and measure what tells them apart.

    SCENE is a scene or a group of them (time-step, wall, axis, position-rule...); all by default. Both outcomes are
    asserted: a method that should fail and does not is a defect, too. Exit code 4 if a method did what it must not.

    With --map many short collapses over choices of method are run, and a chart and tables show where each stands,
    degrades or fails. The same command again completes what is missing.
    """
    if to_map:
        if to_list or len(names) > 1:
            raise click.UsageError("--map takes one map and no --list")
        click.get_current_context().exit(_map(names[0] if names else "default", out, jobs, report_only, quiet, to_json))
    if jobs is not None or report_only:
        raise click.UsageError("--jobs and --report-only go with --map")
    out = out or Path("stability")
    from mpmcol.failure_modes import examine
    from mpmcol.failure_modes.scenarios import choose
    from mpmcol.sweep.plan import as_json

    if to_list:
        scenes = choose(names)
        width = max(len(scene.name) for scene in scenes)
        for scene in scenes:
            click.echo(f"{scene.name:{width}}  {scene.mechanism}{' (slow)' if scene.slow else ''}")
        return
    found = examine(names, out, lambda outcome: None if to_json else click.echo("\n".join(_lines(outcome, quiet))))
    if to_json:
        click.echo(as_json(_record(found)))
    elif not quiet:
        click.echo("\n".join(_closing(found, out)))
    click.get_current_context().exit(0 if found.passed else FAILED)


def _map(name: str, out: Path | None, jobs: int | None, report_only: bool, quiet: bool, to_json: bool) -> int:
    """The exit code: that methods fail is what a map is for, but runs that broke are told."""
    from mpmcol.cli.sweep_display import Display
    from mpmcol.studies.method_map import RUNS, draw_map
    from mpmcol.studies.method_map.definition import load_map
    from mpmcol.studies.method_map.text import closing_lines
    from mpmcol.sweep.engine import exit_code
    from mpmcol.sweep.plan import as_json

    folder = out or Path("stability") / f"map-{Path(name).stem}"
    map_ = load_map(name)
    with Display(folder / RUNS, quiet or to_json) as display:
        drawn = draw_map(map_, folder, jobs, display, report_only)
    if to_json:
        click.echo(as_json(_map_record(drawn)))
    elif not quiet:
        click.echo("\n".join(closing_lines(drawn.judged)))
        click.echo(f"in {folder}: {', '.join(path.name for path in drawn.files)}")
    return exit_code([outcome for outcome in drawn.outcomes if outcome.status != "failed"])


def _map_record(drawn: Drawn) -> dict[str, Any]:
    from mpmcol.studies.method_map.report import table_rows

    return {
        "schema": RECORD_SCHEMA, "rows": list(table_rows(drawn.judged)), "files": [str(path) for path in drawn.files],
    }  # fmt: skip


def _lines(outcome: SceneOutcome, quiet: bool) -> Iterator[str]:
    from mpmcol.failure_modes.report import shown, trial_lines

    scene = outcome.scene
    yield f"{scene.name}: {outcome.verdict}"
    if quiet:
        return
    yield f"  {scene.sign}; bound {shown(scene.bound, scene.unit)}"
    lines = list(trial_lines(outcome))
    width = max(len(method) for method, _, _ in lines)
    for method, number, result in lines:
        yield f"    {method:{width}}  {number:>9}  {result}"


def _closing(found: Stability, out: Path) -> Iterator[str]:
    from mpmcol.failure_modes.report import gaps

    well = sum(outcome.verdict == "as expected" for outcome in found.outcomes)
    yield f"{well} of {len(found.outcomes)} scenes as expected"
    if scenes := gaps(found.outcomes):
        yield f"the default fails in: {', '.join(scene.name for scene in scenes)}"
    yield f"in {out}: {', '.join(path.name for path in found.files)}"


def _record(found: Stability) -> dict[str, Any]:
    from mpmcol.failure_modes.report import table_rows

    return {
        "schema": RECORD_SCHEMA, "passed": found.passed,
        "rows": [row for outcome in found.outcomes for row in table_rows(outcome)],
        "seconds": {outcome.scene.name: round(outcome.seconds, 3) for outcome in found.outcomes},
        "files": [str(path) for path in found.files],
    }  # fmt: skip
