"""`mpmcol run --accuracy` and `--certify`: configurations chosen by their error, and error bars."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.sweep_plan import print_forecast
from mpmcol.io.values import to_json as as_json

if TYPE_CHECKING:
    from mpmcol.io.results import Results
    from mpmcol.studies.pareto.certify import ErrorBar
    from mpmcol.studies.pareto.recommend import Recommendation


def recommend(case: str, overrides: Sequence[str], accuracy: float, *, corrected: bool, silent: bool) -> Recommendation:
    """The cheapest configuration for a case within an accuracy; prints which one and why on stderr unless `silent`."""
    from mpmcol.studies.pareto.recommend import recommend as find_cheapest
    from mpmcol.studies.pareto.recommend import require_free

    advice = find_cheapest(case, overrides, accuracy, corrected)
    require_free(advice, overrides)
    if not silent:
        of_what = ", corrected for the error of the grid" * corrected
        click.echo(f"cheapest within {100.0 * accuracy:.3g}%{of_what}: {advice}", err=True)
    return advice


def state_accuracy(
    results: Results, advice: Recommendation, accuracy: float, bars: Sequence[ErrorBar] = (), corrected: bool = False
) -> tuple[dict[str, Any], list[str]]:
    """The statement of accuracy of a run for JSON and in words; it is also written into the folder of the run."""
    from mpmcol.studies.statement import make_statement
    from mpmcol.studies.statement_text import statement_lines, write_statement

    record = make_statement(results, advice, accuracy, bars, corrected)
    write_statement(results.folder, record)
    return record, statement_lines(record)


def certify(
    case: str,
    overrides: Sequence[str],
    advice: Recommendation,
    accuracy: float,
    out: Path,
    *,
    jobs: int | None,
    threads: int | None,
    fresh: bool,
    dry_run: bool,
    to_json: bool,
    quiet: bool,
) -> None:
    """Run a case as recommended on several grids, print runout and height with error bars, and exit."""
    from mpmcol.cli.run_summary import summary_table
    from mpmcol.cli.sweep_display import SweepDisplay
    from mpmcol.io.atomic import atomic_write
    from mpmcol.io.names import ERROR_BARS_FILE, REPEATS_FOLDER
    from mpmcol.io.results import Results
    from mpmcol.studies.pareto.certify import certify as run_and_estimate
    from mpmcol.studies.pareto.certify import planned_runs
    from mpmcol.sweep.engine import exit_code

    if dry_run:
        runs = planned_runs(case, overrides, advice, out, with_finer=True)
        print_forecast(runs, jobs, threads, fresh=fresh, to_json=to_json, quiet=quiet)
        if not to_json:
            click.echo("runs on the finest grid are made if an error bar of the others is wider than the accuracy")
        click.get_current_context().exit()
    with SweepDisplay(out / REPEATS_FOLDER, quiet) as display:
        outcomes, bars = run_and_estimate(
            case, overrides, advice, accuracy, out, jobs=jobs, threads=threads, fresh=fresh, observer=display
        )
    results = Results(out)
    records = {bar.quantity: _record(bar, results) for bar in bars}
    atomic_write(out / ERROR_BARS_FILE, (as_json(records, indent=1) + "\n").encode())
    statement, lines = state_accuracy(results, advice, accuracy, bars)
    if to_json:
        click.echo(as_json(results.summary | {"error_bars": records, "accuracy": statement}))
    elif not quiet:
        click.echo(summary_table(results, lines))
        click.echo("\ndiscretisation errors, without the error of the model:")
        advised = narrower_bars(case, overrides, accuracy)
        click.echo("\n".join(line for bar in bars for line in _lines(bar, records[bar.quantity], accuracy, advised)))
        click.echo(f"results in {out}, all runs in {out / REPEATS_FOLDER}")
    click.get_current_context().exit(exit_code(outcomes))


def _record(bar: ErrorBar, results: Results) -> dict[str, Any]:
    """The bar for JSON, with the value that the experiment of the case leads to expect."""
    from mpmcol.studies.judgement import experiment_or_reason

    experiment, _ = experiment_or_reason(results.case)
    law = None
    if experiment and (expected := experiment.expected(bar.quantity.partition(".")[0], results.shape.a)):
        value, scatter = expected
        law = {"experiment": experiment.citation, "expected": value, "scatter": scatter / value}
    runs = {f"{cells:g}": result for cells, result in bar.runs.items()}
    return asdict(bar) | {"runs": runs, "error": bar.error, "cause": bar.cause, "law": law}


def narrower_bars(case: str, overrides: Sequence[str], accuracy: float) -> str:
    """How to get bars narrower than those of a run with an accuracy: half of it, if the study permits that."""
    from mpmcol.errors import UsageError
    from mpmcol.studies.pareto.recommend import recommend as find_cheapest

    try:
        find_cheapest(case, overrides, 0.5 * accuracy)
    except UsageError:
        return "the study has no configuration with half the error; set a smaller grid.spacing"
    return f"a finer grid makes it narrower: --accuracy {50.0 * accuracy:.2g}%"


def _lines(bar: ErrorBar, record: dict[str, Any], accuracy: float, advised: str) -> Iterator[str]:
    from mpmcol.studies.judgement import verdict

    yield str(bar)
    if law := record["law"]:
        difference = bar.value / law["expected"] - 1.0
        yield (
            f"  {difference:+.1%} against {law['experiment']} ({law['expected']:.3f}, scatter {law['scatter']:.0%}), "
            f"{verdict(difference, law['scatter'], bar.relative)}"
        )
    if bar.relative > accuracy:
        yield f"  wider than the {accuracy:.1%} asked for because of {bar.cause}; {advised}"
