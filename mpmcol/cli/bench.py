"""`mpmcol bench`: speed of the kernels on this machine."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mpmcol.cli.options import PATH, json_option, positive_integer
from mpmcol.io.atomic import require_folder_path

if TYPE_CHECKING:
    from mpmcol.bench.report import Report
    from mpmcol.bench.scaling_report import ScalingReport

SIZES = (20_000, 100_000, 500_000, 2_000_000)
SCALING_SIZES = (20_000, 200_000)
QUICK_SIZES = (2_000,)
MOST_PER_AXIS = 4  # in two dimensions; one less in three
REPORT_FILE, SCALING_FILE = "bench.json", "scaling.json"


def parse_counts(context: click.Context, parameter: click.Parameter, text: str | None) -> tuple[int, ...] | None:
    """Positive integers, separated by commas."""
    if text is None:
        return None
    counts = tuple(map(positive_integer, text.split(",")))
    if not all(counts):
        raise click.BadParameter(f"{text[:50]!r}: expected integers > 0, for example 20000,100000")
    return counts


def _check_per_axis(per_axis: Sequence[int], model: str | None) -> None:
    """Refuse more points per cell than cases may have."""
    most = MOST_PER_AXIS if model in ("plane", "axisymmetric") else MOST_PER_AXIS - 1
    if max(per_axis, default=0) > most:
        where = "" if model else " with all three models; give --model plane for more"
        raise click.BadParameter(f"{max(per_axis)}: expected at most {most}{where}", param_hint="--per-axis")


@click.command()
@click.option(
    "--points", metavar="N,...", callback=parse_counts,
    help="Numbers of material points  [default: 20000,100000,500000,2000000; with --scaling 20000,200000]",
)  # fmt: skip
@click.option(
    "--threads", metavar="N,...", callback=parse_counts,
    help="Numbers of threads  [default: 1 and all cores; with --scaling 1, 2, 4, ..., 64 and all cores]",
)  # fmt: skip
@click.option(
    "--per-axis", metavar="N,...", callback=parse_counts,
    help="Points per cell and axis; 2 is 4 points a cell in plane and axisymmetric models, 8 in 3D  [default: 2]",
)  # fmt: skip
@click.option("--model", type=click.Choice(["plane", "axisymmetric", "quarter"]), help="Model  [default: all three]")
@click.option("--scaling", is_flag=True, help="Measure strong and weak scaling with the number of threads instead.")
@click.option("--quick", is_flag=True, help="Few points and steps: a test of the command, not of the speed.")
@click.option("--out", metavar="DIR", type=PATH, help=f"Folder for {REPORT_FILE} or {SCALING_FILE}  [default: none]")
@click.option("--against", metavar="FILE", type=PATH, help="Compare with an earlier report, written by --out.")
@json_option("the report")
def bench(
    points: tuple[int, ...] | None,
    threads: tuple[int, ...] | None,
    per_axis: tuple[int, ...] | None,
    model: str | None,
    scaling: bool,
    quick: bool,
    out: Path | None,
    against: Path | None,
    to_json: bool,
) -> None:
    """Measure the speed of the kernels on this machine.

    Prints nanoseconds per material point and step of each kernel, beside plain loops of the same operations. With
    --against, the exit code is 1 if a kernel has become more than 1.5 times slower, beyond the scatter.

    With --scaling, prints the time of the step with each number of threads, and the speed-up that a model of the tiles
    allows, also for more threads than this machine has cores.
    """
    if out:
        require_folder_path(out)
    if scaling:
        if against:
            raise click.UsageError("--against compares times of the kernels, not of --scaling; give one of them")
        if per_axis:
            raise click.UsageError("--scaling measures 2 points per cell and axis; remove --per-axis")
        _print_scaling(points, threads, model, quick, out, to_json)
        return
    _check_per_axis(per_axis or (), model)
    from mpmcol.bench.cases import MODELS
    from mpmcol.bench.measure import FULL, QUICK, measure_case
    from mpmcol.bench.report import load_report, make_report, table_lines
    from mpmcol.mpm.threads import set_threads
    from mpmcol.setup.memory import BYTES_PER_POINT, require_memory

    most = max(points or (0,))
    require_memory(2 * most * BYTES_PER_POINT[3], f"{most:,} points, twice,", "give fewer --points")
    old = load_report(against) if against else None
    cases = []
    sizes, counts = points or (QUICK_SIZES if quick else SIZES), threads or sorted({1, set_threads(None)})
    for chosen, size, each, count in product((model,) if model else MODELS, sizes, per_axis or (2,), counts):
        cases.append(measure_case(chosen, size, each, count, QUICK if quick else FULL))
        click.echo("\n".join(table_lines(cases[-1])), err=to_json)
    report = make_report(cases)
    _finish(report, out and out / REPORT_FILE, to_json)
    if old:
        _compare(old, report, to_json)


def _print_scaling(
    points: tuple[int, ...] | None,
    threads: tuple[int, ...] | None,
    model: str | None,
    quick: bool,
    out: Path | None,
    to_json: bool,
) -> None:
    from mpmcol.bench.cases import MODELS
    from mpmcol.bench.scaling import KINDS, SCALING_FULL, SCALING_QUICK, choose_threads, measure_scaling
    from mpmcol.bench.scaling_report import make_scaling_report, scaling_lines
    from mpmcol.mpm.threads import set_threads
    from mpmcol.setup.memory import BYTES_PER_POINT, require_memory

    counts = choose_threads(threads, set_threads(None))
    most = sum(counts.measured) * max(points or (0,))
    require_memory(most * BYTES_PER_POINT[3], f"{most:,} points", "give fewer --points or --threads")
    cases = []
    for chosen in (model,) if model else MODELS:
        for size in points or (QUICK_SIZES if quick else SCALING_SIZES):
            for kind in KINDS:
                cases.append(measure_scaling(chosen, kind, size, counts, SCALING_QUICK if quick else SCALING_FULL))
                click.echo("\n".join(scaling_lines(cases[-1])), err=to_json)
    _finish(make_scaling_report(cases), out and out / SCALING_FILE, to_json)


def _finish(report: Report | ScalingReport, path: Path | None, to_json: bool) -> None:
    """Print the machine, write the report and print it."""
    from mpmcol.io.atomic import atomic_write, make_folder

    click.echo(", ".join(f"{name} {value}" for name, value in report.machine.items()), err=to_json)
    if path:
        make_folder(path.parent)
        atomic_write(path, report.to_json().encode())
    if to_json:
        click.echo(json.dumps(json.loads(report.to_json())))


def _compare(old: Report, new: Report, to_json: bool) -> None:
    from mpmcol.bench.report import SLOWDOWN, compare
    from mpmcol.errors import MpmcolError

    if old.machine != new.machine:
        click.echo(f"note: the report of {old.date} was measured on another machine: {old.machine}", err=True)
    slower = compare(old, new)
    if slower:
        raise MpmcolError("\n".join(map(str, slower)))
    click.echo(f"No kernel is {SLOWDOWN} times slower than on {old.date}.", err=to_json)
