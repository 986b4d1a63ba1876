"""mpmcol pareto: cost against error of every choice, on one chart."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcol.cli.option_types import JOBS


@click.command()
@click.argument("study", default="default")
@click.option("--out", type=click.Path(path_type=Path), help="Folder; pareto/NAME of the study by default.")
@click.option("--jobs", type=JOBS, help="Runs at a time; chosen from their sizes by default.")
@click.option("--report-only", is_flag=True, help="Run nothing: tables and charts from the runs that have ended.")
@click.option("--quiet", is_flag=True, help="Print nothing but errors.")
def pareto(study: str, out: Path | None, jobs: int | None, report_only: bool, quiet: bool) -> None:
    """Run STUDY, a TOML file or a shipped one (default, choices, quick), and chart error over cost of its settings.

    Errors are told apart: of discretisation, against a converged value with an uncertainty of its own, and of the
    model, against the experiment with its scatter. The same command again completes what is missing.
    """
    from mpmcol.cli.sweep_display import Display
    from mpmcol.studies.pareto import RUNS, carry_out_study
    from mpmcol.studies.pareto.study import load_study
    from mpmcol.studies.pareto.text import closing_lines
    from mpmcol.sweep.engine import exit_code

    loaded = load_study(study)
    folder = out or Path("pareto") / Path(study).stem
    with Display(folder / RUNS, quiet) as display:
        studied = carry_out_study(loaded, folder, jobs, display, report_only)
    if not quiet:
        click.echo("\n".join(closing_lines(loaded, studied.scored)))
        click.echo(f"in {folder}: {', '.join(path.name for path in studied.files)}")
    # that settings fail is what a study may show; runs that broke are told
    broken = [outcome for outcome in studied.outcomes if outcome.status != "failed"]
    click.get_current_context().exit(0 if report_only else exit_code(broken))
