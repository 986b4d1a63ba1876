"""mpmcol paper: the figures of the paper, computed."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcol.cli.option_types import JOBS, THREADS

NAMES = ("fig5", "fig6", "fig7", "fig8", "fig9", "factors")


@click.command()
@click.argument("figures", nargs=-1, metavar="[fig5|fig6|fig7|fig8|fig9|factors|all]...")
@click.option("--quick", is_flag=True, help="Coarse grids and fewer columns: some minutes instead of hours.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder; paper, or paper-quick, by default.")
@click.option("--jobs", type=JOBS, help="Runs at a time; chosen from their sizes by default.")
@click.option("--threads", type=THREADS, help="Threads of each run; chosen from their sizes by default.")
@click.option("--quiet", is_flag=True, help="Print nothing but the verdicts.")
def paper(
    figures: tuple[str, ...], quick: bool, out: Path | None, jobs: int | None, threads: int | None, quiet: bool
) -> None:
    """Compute the figures of Coetzee & Purvance 2026 (all by default) and judge every number that they state.

    For each figure a table (CSV), charts, and a verdict a number: ours, the paper's, and whether it is met. `factors`
    is what each assumption is worth, in per cent of runout and height. The same command again completes what is
    missing.
    """
    unknown = [name for name in figures if name not in (*NAMES, "all")]
    if unknown:
        raise click.BadParameter(f"{unknown[0]!r}: expected {', '.join(NAMES)} or all", param_hint="figures")
    from mpmcol.cli.sweep_display import Display
    from mpmcol.studies.paper import FIGURES, reproduce
    from mpmcol.sweep.engine import exit_code

    chosen = [name for name in NAMES if name in figures] if figures and "all" not in figures else list(NAMES)
    folder = out or Path("paper-quick" if quick else "paper")
    with Display(folder / "runs", quiet) as display:
        outcomes, reports, files = reproduce(chosen, quick, folder, jobs, threads, display)
    for name, report in reports.items():
        click.echo(FIGURES[name].TITLE)
        for verdict in report.verdicts:
            click.echo(f"  {verdict}")
    if not quiet:
        click.echo(f"in {folder}: {', '.join(path.name for path in files)}")
    # without opening strain runs diverge, as `factors` shows
    broken = [one for one in outcomes if one.status != "failed" or one.run.case.method.opening_strain]
    click.get_current_context().exit(exit_code(broken))
