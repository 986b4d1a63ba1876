"""`mpmcol paper`: reproduction of the figures of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import fresh_option, jobs_option, json_option, out_option, threads_option

if TYPE_CHECKING:
    from mpmcol.studies.frame import StudyResult
    from mpmcol.studies.paper.report import FigureResult

RECORD_SCHEMA = 1


@click.command()
@click.argument("figures", nargs=-1, metavar="[FIGURE]...")
@click.option("--quick", is_flag=True, help="Coarse grids and fewer columns: minutes instead of hours.")
@click.option("--filtered", is_flag=True, help="With the stress filter, which the paper does not have.")
@out_option("paper; paper-quick, paper-filtered with these options")
@fresh_option
@jobs_option
@threads_option
@json_option("comparisons and names of files")
@click.option("--quiet", is_flag=True, help="Print the comparisons only.")
def paper(
    figures: tuple[str, ...],
    quick: bool,
    filtered: bool,
    out: Path | None,
    fresh: bool,
    jobs: int | None,
    threads: int | None,
    to_json: bool,
    quiet: bool,
) -> None:
    """Reproduce the figures of the paper and compare their numbers.

    The paper is Coetzee & Purvance 2026, doi:10.20944/preprints202605.0398.v1. FIGURE is fig5, fig6, fig7, fig8, fig9,
    factors (effect of each assumption on runout and height) or all (default). Each figure gives a table (CSV), charts,
    and a list of comparisons: computed, stated by the paper, met or missed. Repeating the command completes missing
    runs.
    """
    from mpmcol.cli.sweep_display import SweepDisplay
    from mpmcol.studies.frame import RUNS, carry_out_study
    from mpmcol.studies.paper import FIGURES, PaperStudy
    from mpmcol.sweep.engine import exit_code
    from mpmcol.sweep.plan import as_json

    unknown = [name for name in figures if name not in (*FIGURES, "all")]
    if unknown:
        raise click.BadParameter(f"{unknown[0]!r}: expected {', '.join(FIGURES)} or all", param_hint="figures")
    names = [name for name in FIGURES if name in figures or "all" in figures or not figures]
    folder = out or Path("paper" + "-quick" * quick + "-filtered" * filtered)
    with SweepDisplay(folder / RUNS, quiet) as display:
        study = PaperStudy(names, quick, filtered)
        result = carry_out_study(study, folder, jobs=jobs, threads=threads, fresh=fresh, observer=display)
    if to_json:
        click.echo(as_json(_record(result)))
    else:
        for name, figure in result.evaluation.items():
            click.echo(FIGURES[name].TITLE)
            for comparison in figure.comparisons:
                click.echo(f"  {comparison}")
        if not quiet:
            click.echo(f"in {folder}: {', '.join(path.name for path in result.files)}")
    # runs without opening strain may diverge, which `factors` reports
    counted = [one for one in result.outcomes if one.status != "failed" or one.run.case.method.opening_strain]
    click.get_current_context().exit(exit_code(counted))


def _record(result: StudyResult[Mapping[str, FigureResult]]) -> dict[str, Any]:
    comparisons = [
        {"figure": name, **asdict(comparison), "is_met": comparison.is_met}
        for name, figure in result.evaluation.items()
        for comparison in figure.comparisons
    ]
    return {"schema": RECORD_SCHEMA, "comparisons": comparisons, "files": [str(path) for path in result.files]}
