"""mpmcol stability: scenes in which methods fail, beside those that stand."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from mpmcol.stability import Stability
    from mpmcol.stability.scene import SceneOutcome

RECORD_SCHEMA = 1
FAILED = 4  # exit code


@click.command()
@click.argument("names", nargs=-1, metavar="[SCENE]...")
@click.option("--list", "to_list", is_flag=True, help="Name the scenes and what they show; nothing is played.")
@click.option("--out", type=click.Path(path_type=Path), default=Path("stability"), help="Folder; stability by default.")
@click.option("--quiet", is_flag=True, help="Print nothing but the verdicts.")
@click.option("--json", "to_json", is_flag=True, help="Print outcomes and files as one line on stdout.")
def stability(names: tuple[str, ...], to_list: bool, out: Path, quiet: bool, to_json: bool) -> None:
    """Play small scenes in which a method fails and another one stands, and measure what tells them apart.

    SCENE is a scene or a group of them (time-step, wall, axis, position-rule...); all by default. Both outcomes are
    asserted: a method that should fail and does not is a defect, too.

    Exit code 4 if a method did what it must not.
    """
    from mpmcol.stability import examine
    from mpmcol.stability.scenes import choose
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


def _lines(outcome: SceneOutcome, quiet: bool) -> Iterator[str]:
    from mpmcol.stability.report import shown, trial_lines

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
    from mpmcol.stability.report import gaps

    well = sum(outcome.verdict == "as expected" for outcome in found.outcomes)
    yield f"{well} of {len(found.outcomes)} scenes as expected"
    if scenes := gaps(found.outcomes):
        yield f"the default fails in: {', '.join(scene.name for scene in scenes)}"
    yield f"in {out}: {', '.join(path.name for path in found.files)}"


def _record(found: Stability) -> dict[str, Any]:
    from mpmcol.stability.report import table_rows

    return {
        "schema": RECORD_SCHEMA, "passed": found.passed,
        "rows": [row for outcome in found.outcomes for row in table_rows(outcome)],
        "seconds": {outcome.scene.name: round(outcome.seconds, 3) for outcome in found.outcomes},
        "files": [str(path) for path in found.files],
    }  # fmt: skip
