"""mpmcol plan: what would make a case cheaper without leaving an accuracy."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from shlex import quote

import click

from mpmcol.cli.accuracy import ACCURACY


@click.command()
@click.argument("case")
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Replace a value, e.g. geometry.aspect=5.")
@click.option(
    "--accuracy", type=ACCURACY, default="5%", show_default=True, help="Error that runout and height may have."
)
@click.option("--apply", "target", type=click.Path(path_type=Path), help="Write the case as proposed to this file.")
def plan(case: str, overrides: tuple[str, ...], accuracy: float, target: Path | None) -> None:
    """List what would make CASE cheaper, and propose the cheapest setting that keeps to an accuracy.

    Savings are estimated from points and steps; effects were measured on columns like this one by `mpmcol pareto`.
    """
    from mpmcol.case import load_case, resolved_toml
    from mpmcol.io.atomic import atomic_write
    from mpmcol.studies.pareto.recommend import recommend
    from mpmcol.studies.pareto.savings import propose

    click.echo(f"{'change, alone':44s}{'time':>8s}{'zeta':>8s}{'beta':>8s}")
    for proposal in propose(case, overrides, accuracy):
        click.echo(f"{proposal.name:44s}{f'x {proposal.cost_ratio:.2g}':>8s}{_effects(proposal.effect)}")
    advice = recommend(case, overrides, accuracy)
    click.echo(f"\ncheapest within {100.0 * accuracy:.3g}%: {advice}")
    if target:
        atomic_write(target, resolved_toml(load_case(case, [*overrides, *advice.overrides])).encode())
        click.echo(f"written to {target}; next: mpmcol run {target}")
    else:
        values = "".join(f" --set {quote(text)}" for text in overrides)
        click.echo(f"next: mpmcol run {quote(case)}{values} --accuracy {100.0 * accuracy:.3g}%, or --apply NEW.toml")


def _effects(effect: Mapping[str, float] | None) -> str:
    return "  see below" if effect is None else "".join(f"{change:>+8.1%}" for change in effect.values())
