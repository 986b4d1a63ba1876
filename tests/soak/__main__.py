"""`python -m tests.soak [NAME ...]`: carry out the trials of promises."""

from __future__ import annotations

import time
from math import inf
from pathlib import Path

import click

from mpmcol.bench.report import describe_machine
from tests.soak.runner.promise import Promise, find_promises
from tests.soak.runner.records import Record, Records
from tests.soak.runner.workers import Task, carry_out_all


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--count", type=click.IntRange(1), help="Number of trials of each promise; default: its full count.")
@click.option("--seed", default=0, show_default=True, help="Seed of the first trial.")
@click.option("--hours", type=click.FloatRange(0.0), help="Start no trial after this time.")
@click.option("--jobs", default=1, show_default=True, type=click.IntRange(1), help="Number of trials at a time.")
@click.option("--repeat", is_flag=True, help="Include seeds already tried with the present code.")
@click.option("--results", default="build/soak", show_default=True, type=click.Path(path_type=Path), help="Results.")
@click.option("--table", type=click.Path(path_type=Path), help="Write the table of all results to this file.")
def soak(
    names: tuple[str, ...],
    count: int | None,
    seed: int,
    hours: float | None,
    jobs: int,
    repeat: bool,
    results: Path,
    table: Path | None,
) -> None:
    """Carry out the trials of the promises NAME, by default of all.

    A failed trial does not stop the others. Seeds already tried with the present version of the code are left out, so
    the same command continues after an interruption. The folders of failed trials are kept with the results.
    """
    promises = find_promises()
    if unknown := set(names) - set(promises):
        raise click.UsageError(f"unknown: {', '.join(sorted(unknown))}; expected one of {', '.join(promises)}")
    chosen, records = {name: promises[name] for name in names or promises}, Records(results)
    tried = {} if repeat else {name: records.tried(promise) for name, promise in chosen.items()}
    deadline = time.monotonic() + 3600.0 * (inf if hours is None else hours)
    carry_out(chosen, plan(chosen, seed, count, tried), jobs, deadline, records)
    text = records.table(promises.values())
    click.echo(text, nl=False)
    if table:
        table.write_text(text)
    raise SystemExit(any(records.failed(promise) for promise in chosen.values()))


def plan(promises: dict[str, Promise], seed: int, count: int | None, tried: dict[str, set[int]]) -> list[Task]:
    """The trials, in an order in which all promises are completed at about the same time."""
    shares: list[tuple[float, Task]] = []
    for name, promise in promises.items():
        trials = count or promise.count
        left = set(range(seed, seed + trials)) - tried.get(name, set())
        shares += [((one - seed + 1) / trials, (name, one)) for one in left]
    return [task for _, task in sorted(shares)]


def carry_out(promises: dict[str, Promise], tasks: list[Task], jobs: int, deadline: float, records: Records) -> None:
    """Carry out tasks, record the results, and print failures as they occur."""
    about = describe_machine()
    machine = f"{about['cpu']} ({about['llvm_cpu']}), {about['cores']} cores"
    with click.progressbar(length=len(tasks), label="trials", show_pos=True) as bar:
        for (name, seed), failure, seconds in carry_out_all(tasks, jobs, records.folder, deadline):
            records.add(name, Record(seed, failure, round(seconds, 3), promises[name].version, machine))
            if failure is not None:
                click.echo(f"\n{name}, seed {seed}: {failure}", err=True)
            bar.update(1)


if __name__ == "__main__":
    soak()
