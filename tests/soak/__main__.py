"""python -m tests.soak [NAME ...]: try promises many times over; see tests/soak/__init__.py."""

from __future__ import annotations

import time
from math import inf
from pathlib import Path

import click

from mpmcol.bench.report import describe_machine
from tests.soak.figures import Figure, find_figures
from tests.soak.records import Record, Records
from tests.soak.workers import Task, carry_out_all


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--count", type=click.IntRange(1), help="Trials of each; its full count by default.")
@click.option("--seed", default=0, show_default=True, help="Of the first trial.")
@click.option("--hours", type=click.FloatRange(0.0), help="Begin no trial after this time.")
@click.option("--jobs", default=1, show_default=True, type=click.IntRange(1), help="Trials at a time.")
@click.option("--again", is_flag=True, help="Also seeds that were tried with this code before.")
@click.option("--keep", default="build/soak", show_default=True, type=click.Path(path_type=Path), help="Results.")
@click.option("--table", type=click.Path(path_type=Path), help="Write the table over all results here.")
def soak(
    names: tuple[str, ...],
    count: int | None,
    seed: int,
    hours: float | None,
    jobs: int,
    again: bool,
    keep: Path,
    table: Path | None,
) -> None:
    """Try the promises NAME, all by default, with one seed after another, and go on after failures.

    The same command again goes on where it was: a seed is tried once with each version of the code. The folders of
    trials that failed are kept with the results.
    """
    figures = find_figures()
    if unknown := set(names) - set(figures):
        raise click.UsageError(f"no such promise: {', '.join(sorted(unknown))}; there are {', '.join(figures)}")
    chosen, records = {name: figures[name] for name in names or figures}, Records(keep)
    tasks = plan(chosen, seed, count, {} if again else {name: records.tried(figures[name]) for name in chosen})
    carry_out(chosen, tasks, jobs, time.monotonic() + 3600.0 * (inf if hours is None else hours), records)
    text = records.table(figures.values())
    click.echo(text, nl=False)
    if table:
        table.write_text(text)
    raise SystemExit(any(records.failed(figure) for figure in chosen.values()))


def plan(figures: dict[str, Figure], seed: int, count: int | None, tried: dict[str, set[int]]) -> list[Task]:
    """The trials in an order in which all figures are through at about the same time."""
    shares: list[tuple[float, Task]] = []
    for name, figure in figures.items():
        trials = count or figure.count
        left = set(range(seed, seed + trials)) - tried.get(name, set())
        shares += [((one - seed + 1) / trials, (name, one)) for one in left]
    return [task for _, task in sorted(shares)]


def carry_out(figures: dict[str, Figure], tasks: list[Task], jobs: int, deadline: float, records: Records) -> None:
    """Try them, keep what comes of them, and tell failures as they come."""
    about = describe_machine()
    machine = f"{about['cpu']} ({about['llvm_cpu']}), {about['cores']} cores"
    with click.progressbar(length=len(tasks), label="trials", show_pos=True) as bar:
        for (name, seed), wrong, seconds in carry_out_all(tasks, jobs, records.folder, deadline):
            records.add(name, Record(seed, wrong, round(seconds, 3), figures[name].version, machine))
            if wrong is not None:
                click.echo(f"\n{name}, seed {seed}: {wrong}", err=True)
            bar.update(1)


if __name__ == "__main__":
    soak()
