"""`mpmcol stability`: catalogue of failure modes, and maps of methods."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import (
    CHECK_FAILED,
    fresh_option,
    jobs_option,
    json_option,
    out_option,
)

if TYPE_CHECKING:
    from mpmcol.failure_modes import CatalogueOutcome, Observer
    from mpmcol.failure_modes.scenario import ScenarioOutcome
    from mpmcol.studies.frame import StudyResult
    from mpmcol.studies.method_map import MethodMap

RECORD_SCHEMA = 2


@click.command()
@click.argument("names", nargs=-1, metavar="[SCENARIO]... | --map [MAP]")
@click.option("--list", "to_list", is_flag=True, help="List the scenarios and their mechanisms; run nothing.")
@click.option("--map", "to_map", is_flag=True, help="Compute a map of method options instead of the scenarios.")
@out_option("stability, with --map stability/map-NAME")
@fresh_option
@jobs_option
@click.option(
    "--report-only", is_flag=True, help="With --map: run nothing; write tables and chart from the finished runs."
)
@click.option("--quiet", is_flag=True, help="Print the verdicts only; with --map, errors only.")
@json_option("outcomes and names of files")
def stability(
    names: tuple[str, ...], to_list: bool, to_map: bool, out: Path | None, fresh: bool, jobs: int | None,
    report_only: bool, quiet: bool, to_json: bool,
) -> None:  # fmt: skip
    """Run benchmarks of failure modes, or map where methods fail.

    Each scenario has methods that are expected to fail and methods that are expected to pass, and reports the metric
    that distinguishes them. SCENARIO is the name of a scenario or of a group (time-step, wall, axis, ...); all by
    default. The exit code is 4 if an outcome is unexpected, also if a method passes that should fail.

    With --map, short collapses with many combinations of method options are run; a chart and tables show where they
    pass, degrade or fail. MAP is a TOML file or a shipped map (default, quick). Repeating the command completes missing
    runs.
    """
    if to_map:
        if to_list or len(names) > 1:
            raise click.UsageError("--map requires at most one MAP and excludes --list")
        code = _run_map(
            names[0] if names else "default", out,
            fresh=fresh, jobs=jobs, report_only=report_only, quiet=quiet, to_json=to_json,
        )  # fmt: skip
        click.get_current_context().exit(code)
    if fresh or jobs is not None or report_only:
        raise click.UsageError("--fresh, --jobs and --report-only require --map")
    out = out or Path("stability")
    from mpmcol.failure_modes import run_catalogue
    from mpmcol.failure_modes.scenarios import select_scenarios
    from mpmcol.sweep.plan import as_json

    if to_list:
        scenarios = select_scenarios(names)
        width = max(len(scenario.name) for scenario in scenarios)
        for scenario in scenarios:
            click.echo(f"{scenario.name:{width}}  {scenario.mechanism}{' (slow)' if scenario.slow else ''}")
        return
    found = run_catalogue(names, out, _observer(quiet, to_json))
    if to_json:
        click.echo(as_json(_record(found)))
    elif not quiet:
        click.echo("\n".join(_closing(found, out)))
    click.get_current_context().exit(0 if found.passed else CHECK_FAILED)


def _run_map(
    name: str, out: Path | None, *, fresh: bool, jobs: int | None, report_only: bool, quiet: bool, to_json: bool
) -> int:
    """Run a map and return the exit code; a diverging run is a result of the map, other failures are not."""
    from mpmcol.cli.sweep_display import SweepDisplay
    from mpmcol.studies.frame import RUNS, carry_out_study
    from mpmcol.studies.method_map import MapStudy
    from mpmcol.studies.method_map.definition import load_map
    from mpmcol.studies.method_map.text import closing_lines
    from mpmcol.sweep.engine import exit_code
    from mpmcol.sweep.plan import as_json

    folder = out or Path("stability") / f"map-{Path(name).stem}"
    study = MapStudy(load_map(name))
    with SweepDisplay(folder / RUNS, quiet) as display:
        result = carry_out_study(
            study, folder, jobs=jobs, threads=1, fresh=fresh, observer=display, report_only=report_only
        )
    if to_json:
        click.echo(as_json(_map_record(result)))
    elif not quiet:
        click.echo("\n".join(closing_lines(result.evaluation.assessed)))
        click.echo(f"in {folder}: {', '.join(path.name for path in result.files)}")
    return exit_code([outcome for outcome in result.outcomes if outcome.status != "failed"])


def _map_record(result: StudyResult[MethodMap]) -> dict[str, Any]:
    from mpmcol.studies.method_map.report import table_rows

    rows = list(table_rows(result.evaluation.assessed))
    return {"schema": RECORD_SCHEMA, "rows": rows, "files": [str(path) for path in result.files]}


def _observer(quiet: bool, to_json: bool) -> Observer:
    """Print each outcome; on stderr if JSON is printed at the end."""
    return lambda outcome: click.echo("\n".join(_lines(outcome, quiet)), err=to_json)


def _lines(outcome: ScenarioOutcome, quiet: bool) -> Iterator[str]:
    from mpmcol.failure_modes.report import outcome_lines, with_unit

    scenario = outcome.scenario
    yield f"{scenario.name}: {outcome.verdict}"
    if quiet:
        return
    yield f"  {scenario.metric}; bound {with_unit(scenario.bound, scenario.unit)}"
    lines = list(outcome_lines(outcome))
    width = max(len(method) for method, _, _ in lines)
    for method, value, result in lines:
        yield f"    {method:{width}}  {value:>9}  {result}"


def _closing(found: CatalogueOutcome, out: Path) -> Iterator[str]:
    from mpmcol.failure_modes.report import failing_defaults

    as_expected = sum(outcome.verdict == "as expected" for outcome in found.outcomes)
    yield f"{as_expected} of {len(found.outcomes)} scenarios as expected"
    if scenarios := failing_defaults(found.outcomes):
        yield f"a default fails in: {', '.join(scenario.name for scenario in scenarios)}"
    yield f"in {out}: {', '.join(path.name for path in found.files)}"


def _record(found: CatalogueOutcome) -> dict[str, Any]:
    from mpmcol.failure_modes.report import table_rows

    return {
        "schema": RECORD_SCHEMA, "passed": found.passed,
        "rows": [row for outcome in found.outcomes for row in table_rows(outcome)],
        "seconds": {outcome.scenario.name: round(outcome.seconds, 3) for outcome in found.outcomes},
        "files": [str(path) for path in found.files],
    }  # fmt: skip
