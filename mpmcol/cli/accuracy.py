"""`mpmcol run --accuracy` and `--certify`: configurations chosen by their error, and error bars from two spacings."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from mpmcol.studies.pareto.recommend import Recommendation


def recommend(case: str, overrides: Sequence[str], accuracy: float, silent: bool) -> Recommendation:
    """The cheapest configuration for a case within an accuracy; prints which one and why unless `silent`."""
    from mpmcol.studies.pareto.recommend import recommend as find_cheapest

    advice = find_cheapest(case, overrides, accuracy)
    if not silent:
        click.echo(f"cheapest within {100.0 * accuracy:.3g}%: {advice}")
    return advice


def certify(
    case: str,
    overrides: Sequence[str],
    advice: Recommendation,
    out: Path,
    *,
    threads: int | None,
    to_json: bool,
    quiet: bool,
) -> None:
    """Run a case as recommended at two spacings, print runout and height with error bars, and exit."""
    from mpmcol.cli.sweep_display import SweepDisplay
    from mpmcol.studies.pareto.certify import certify as run_and_estimate
    from mpmcol.sweep.engine import exit_code

    with SweepDisplay(out, quiet or to_json) as display:
        outcomes, quantities = run_and_estimate(case, overrides, advice, out, threads=threads, observer=display)
    if to_json:
        click.echo(json.dumps({one.quantity: vars(one) for one in quantities}))
    elif not quiet:
        click.echo("\n".join(map(str, quantities)))
        click.echo(f"discretisation errors, without the error of the model; runs in {out}")
    click.get_current_context().exit(exit_code(outcomes))
