"""`mpmcol pareto`: cost against error of many configurations."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcol.cli.options import fresh_option, jobs_option, json_option, out_option, quiet_option

RECORD_SCHEMA = 1


@click.command()
@click.argument("study", default="default")
@out_option("pareto/NAME of the study")
@fresh_option
@jobs_option
@click.option("--report-only", is_flag=True, help="Run nothing; write tables and charts from the finished runs.")
@json_option("table and names of files")
@quiet_option
def pareto(
    study: str,
    out: Path | None,
    fresh: bool,
    jobs: int | None,
    report_only: bool,
    to_json: bool,
    quiet: bool,
) -> None:
    """Run a study of cost against error, and chart it.

    STUDY is a TOML file or a shipped study (default, choices, quick). The chart shows the error of each configuration
    over its cost in core-seconds. Discretisation errors are relative to grid-converged values with stated
    uncertainties; model errors are relative to the experiment with its scatter. Repeating the command completes missing
    runs.
    """
    from mpmcol.cli.sweep_display import SweepDisplay
    from mpmcol.studies.frame import RUNS, carry_out_study
    from mpmcol.studies.pareto import ParetoStudy
    from mpmcol.studies.pareto.report import closing_lines, table_rows
    from mpmcol.studies.pareto.study import load_study
    from mpmcol.sweep.engine import exit_code
    from mpmcol.sweep.plan import as_json

    definition = load_study(study)
    folder = out or Path("pareto") / Path(study).stem
    with SweepDisplay(folder / RUNS, quiet) as display:
        result = carry_out_study(
            ParetoStudy(definition), folder,
            jobs=jobs, threads=1, fresh=fresh, observer=display, report_only=report_only,
        )  # fmt: skip
    if to_json:
        rows = list(table_rows(definition, result.evaluation.references, result.evaluation.scored))
        files = [str(path) for path in result.files]
        click.echo(as_json({"schema": RECORD_SCHEMA, "rows": rows, "files": files}))
    elif not quiet:
        click.echo("\n".join(closing_lines(definition, result.evaluation.scored)))
        click.echo(f"in {folder}: {', '.join(path.name for path in result.files)}")
    # a diverging configuration is a result of the study; other failures are not
    counted = [outcome for outcome in result.outcomes if outcome.status != "failed"]
    click.get_current_context().exit(0 if report_only else exit_code(counted))
