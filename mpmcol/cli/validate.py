"""mpmcol validate: the experiments that are shipped, passed or failed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.option_types import JOBS, THREADS

if TYPE_CHECKING:
    from mpmcol.studies.validation import Validation

RECORD_SCHEMA = 1
FAILED = 4  # exit code


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--quick", is_flag=True, help="Coarse grids, each column once: a minute or two instead of half an hour.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder; validation, or validation-quick, by default.")
@click.option("--jobs", type=JOBS, help="Runs at a time; chosen from their sizes by default.")
@click.option("--threads", type=THREADS, help="Threads of each run; chosen from their sizes by default.")
@click.option("--quiet", is_flag=True, help="Print nothing but the checks.")
@click.option("--json", "to_json", is_flag=True, help="Print checks and files as one line on stdout.")
def validate(
    names: tuple[str, ...],
    quick: bool,
    out: Path | None,
    jobs: int | None,
    threads: int | None,
    quiet: bool,
    to_json: bool,
) -> None:
    """Check runout, height, surface, failure line and duration against published experiments.

    NAME is a check or a group of them (rods, channel, cylinder); all by default. Each measures one number, which must
    lie in a band that comes from the experiment, and runs negative controls, whose number must lie outside. Bands are
    the same with --quick, so that some may fail there. The same command again completes what is missing.

    Exit code 4 if a check fails.
    """
    from mpmcol.cli.sweep_display import Display
    from mpmcol.studies.validation import validate as carry_out
    from mpmcol.sweep.engine import exit_code
    from mpmcol.sweep.plan import as_json

    folder = out or Path("validation-quick" if quick else "validation")
    with Display(folder / "runs", quiet) as display:
        found = carry_out(names, quick, folder, jobs, threads, display)
    click.echo(as_json(_record(found, quick)) if to_json else "\n".join(_lines(found)))
    if not quiet and not to_json:
        click.echo(f"in {folder}: {', '.join(path.name for path in found.files)}")
    click.get_current_context().exit(exit_code(found.outcomes) or (0 if found.passed else FAILED))


def _lines(found: Validation) -> Iterator[str]:
    from mpmcol.studies.validation.report import band_of, controls_of, shown, summary_of

    width = max(len(judgement.check.name) for judgement in found.judgements)
    for judgement in found.judgements:
        check = judgement.check
        yield (
            f"{check.name:{width}}  {shown(judgement.value):>6}  band {band_of(judgement):16} {judgement.verdict:14} "
            f"{check.number}{', ' * bool(check.unit)}{check.unit}{'' if judgement.at_rest else '; not at rest'}"
        )
        yield f"{'':{width}}  controls: {'; '.join(controls_of(judgement))}"
    yield summary_of(found.judgements)


def _record(found: Validation, quick: bool) -> dict[str, Any]:
    from mpmcol.studies.validation.report import table_rows

    rows = [row for judgement in found.judgements for row in table_rows(judgement, quick)]
    return {
        "schema": RECORD_SCHEMA, "passed": found.passed, "checks": rows,
        "others": [vars(other) for other in found.others], "files": [str(path) for path in found.files],
    }  # fmt: skip
