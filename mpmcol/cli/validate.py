"""`mpmcol validate`: comparison with published experiments."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import CHECK_FAILED, fresh_option, jobs_option, json_option, out_option, threads_option

if TYPE_CHECKING:
    from mpmcol.studies.frame import StudyResult
    from mpmcol.studies.validation import Validation

RECORD_SCHEMA = 1


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--quick", is_flag=True, help="Coarse grids, each column once: minutes instead of half an hour.")
@out_option("validation, with --quick validation-quick")
@fresh_option
@jobs_option
@threads_option
@click.option("--quiet", is_flag=True, help="Print the checks only.")
@json_option("checks and names of files")
def validate(
    names: tuple[str, ...],
    quick: bool,
    out: Path | None,
    fresh: bool,
    jobs: int | None,
    threads: int | None,
    quiet: bool,
    to_json: bool,
) -> None:
    """Validate the simulation against published experiments.

    NAME is a check or a group of checks (rods, channel, cylinder); all by default. A check measures one quantity
    (runout, height, surface, failure line or stop time), which must be inside a band taken from the experiment, and
    runs negative controls, whose values must be outside. The bands are the same with --quick, so that some checks may
    fail on its coarse grids. Checks with unverified bands are shown for information. Repeating the command completes
    missing runs. The exit code is 4 if a check fails.
    """
    from mpmcol.cli.sweep_display import SweepDisplay
    from mpmcol.studies.frame import RUNS, carry_out_study
    from mpmcol.studies.validation import ValidationStudy, select_checks
    from mpmcol.sweep.engine import exit_code
    from mpmcol.sweep.plan import as_json

    folder = out or Path("validation-quick" if quick else "validation")
    study = ValidationStudy(select_checks(names), quick)
    with SweepDisplay(folder / RUNS, quiet) as display:
        result = carry_out_study(study, folder, jobs=jobs, threads=threads, fresh=fresh, observer=display)
    click.echo(as_json(_record(result, quick)) if to_json else "\n".join(_lines(result.evaluation)))
    if not quiet and not to_json:
        click.echo(f"in {folder}: {', '.join(path.name for path in result.files)}")
    click.get_current_context().exit(exit_code(result.outcomes) or (0 if result.evaluation.passed else CHECK_FAILED))


def _lines(validation: Validation) -> Iterator[str]:
    from mpmcol.studies.validation.report import format_band, format_controls, format_value, summary

    width = max(len(result.check.name) for result in validation.results)
    for result in validation.results:
        check = result.check
        yield (
            f"{check.name:{width}}  {format_value(result.value):>6}  band {format_band(result):16} "
            f"{result.verdict:12} {check.quantity}{', ' * bool(check.unit)}{check.unit}"
            f"{'' if result.at_rest else '; not at rest'}"
        )
        yield f"{'':{width}}  negative controls: {'; '.join(format_controls(result))}"
    yield summary(validation.results)


def _record(result: StudyResult[Validation], quick: bool) -> dict[str, Any]:
    from mpmcol.studies.validation.report import table_rows

    validation = result.evaluation
    return {
        "schema": RECORD_SCHEMA, "passed": validation.passed,
        "checks": [row for one in validation.results for row in table_rows(one, quick)],
        "others": [vars(other) for other in validation.others], "files": [str(path) for path in result.files],
    }  # fmt: skip
