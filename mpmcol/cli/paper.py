"""mpmcol paper: reproduction of the figures of the paper."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcol.cli.option_types import JOBS, THREADS


@click.command()
@click.argument("figures", nargs=-1, metavar="[FIGURE]...")
@click.option("--quick", is_flag=True, help="Coarse grids and fewer columns: minutes instead of hours.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder (default: paper, or paper-quick).")
@click.option("--jobs", type=JOBS, help="Simultaneous runs (default: chosen from their sizes).")
@click.option("--threads", type=THREADS, help="Threads of each run (default: chosen from their sizes).")
@click.option("--quiet", is_flag=True, help="Print only the comparisons.")
def paper(
    figures: tuple[str, ...], quick: bool, out: Path | None, jobs: int | None, threads: int | None, quiet: bool
) -> None:
    """Reproduce figures of Coetzee & Purvance 2026 and compare every number that the paper states.

    FIGURE is fig5, fig6, fig7, fig8, fig9, factors (effect of each assumption on runout and height) or all (default).
    Each figure gives a table (CSV), charts, and a list of comparisons: computed, stated by the paper, met or missed.
    Repeating the command completes missing runs.
    """
    from mpmcol.cli.sweep_display import Display
    from mpmcol.studies.frame import RUNS, carry_out_study
    from mpmcol.studies.paper import FIGURES, PaperStudy
    from mpmcol.sweep.engine import exit_code

    unknown = [name for name in figures if name not in (*FIGURES, "all")]
    if unknown:
        raise click.BadParameter(f"{unknown[0]!r}: expected {', '.join(FIGURES)} or all", param_hint="figures")
    names = [name for name in FIGURES if name in figures or "all" in figures or not figures]
    folder = out or Path("paper-quick" if quick else "paper")
    with Display(folder / RUNS, quiet) as display:
        result = carry_out_study(PaperStudy(names, quick), folder, jobs=jobs, threads=threads, observer=display)
    for name, figure in result.evaluation.items():
        click.echo(FIGURES[name].TITLE)
        for comparison in figure.comparisons:
            click.echo(f"  {comparison}")
    if not quiet:
        click.echo(f"in {folder}: {', '.join(path.name for path in result.files)}")
    # runs without opening strain may diverge, which `factors` reports
    counted = [one for one in result.outcomes if one.status != "failed" or one.run.case.method.opening_strain]
    click.get_current_context().exit(exit_code(counted))
