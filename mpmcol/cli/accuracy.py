"""Runs that are asked for by their accuracy."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from mpmcol.studies.pareto.recommend import Recommendation


class Accuracy(click.ParamType):
    """A relative error: "5%" or 0.05."""

    name = "error"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Share of one."""
        from mpmcol.units import to_unit

        if isinstance(value, float):
            return value
        try:
            share = to_unit(value, "")
        except ValueError:
            share = float("nan")
        if not 0.0 < share < 1.0:
            self.fail(f"{value!r}: expected an error such as 5% or 0.05", param, ctx)
        return share


ACCURACY = Accuracy()


def advised(case: str, overrides: Sequence[str], accuracy: float, silent: bool) -> Recommendation:
    """The cheapest setting for a case that keeps to an accuracy; tells which and why."""
    from mpmcol.studies.pareto.recommend import recommend

    advice = recommend(case, overrides, accuracy)
    if not silent:
        click.echo(f"cheapest within {100.0 * accuracy:.3g}%: {advice}")
    return advice


def certified(
    case: str,
    overrides: Sequence[str],
    advice: Recommendation,
    out: Path,
    threads: int | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Run a case as advised at two spacings, print runout and height with error bars, and end the command."""
    from mpmcol.cli.sweep_display import Display
    from mpmcol.studies.pareto.certify import certify
    from mpmcol.sweep.engine import exit_code

    with Display(out, quiet or as_json) as display:
        outcomes, quantities = certify(case, overrides, advice, out, threads=threads, observer=display)
    if as_json:
        click.echo(json.dumps({one.quantity: vars(one) for one in quantities}))
    elif not quiet:
        click.echo("\n".join(map(str, quantities)))
        click.echo(f"errors are of discretisation; runs in {out}")
    click.get_current_context().exit(exit_code(outcomes))
