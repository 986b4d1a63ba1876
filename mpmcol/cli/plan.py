"""`mpmcol plan`: changes that make a case cheaper at a given accuracy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from shlex import quote

import click

from mpmcol.cli.options import PATH, accuracy_option, aspect_option, json_option, overrides_option, with_aspect

RECORD_SCHEMA = 1


@click.command()
@click.argument("case")
@aspect_option
@overrides_option
@accuracy_option("5%")
@click.option("--apply", "target", metavar="FILE", type=PATH, help="Write the case as recommended to this TOML file.")
@json_option("changes and recommendation")
def plan(
    case: str, aspect: str | None, overrides: tuple[str, ...], accuracy: float, target: Path | None, to_json: bool
) -> None:
    """List changes that make a case cheaper at a given accuracy.

    CASE is a TOML file or the name of a shipped case (mpmcol cases). Each change is listed with its saving and with its
    effect on runout (zeta) and height (beta); then the cheapest configuration within the accuracy is recommended.
    Savings are estimated from points and steps; effects were measured on similar columns by mpmcol pareto.
    """
    from mpmcol.case import load_case, resolved_toml
    from mpmcol.errors import UsageError
    from mpmcol.io.atomic import atomic_write
    from mpmcol.studies.pareto.recommend import recommend
    from mpmcol.studies.pareto.savings import propose
    from mpmcol.sweep.plan import as_json

    if target and target.exists():
        raise UsageError(f"{target} exists and is not replaced; choose another name for --apply")
    overrides = with_aspect(overrides, aspect)
    proposals = list(propose(case, overrides, accuracy))
    advice = recommend(case, overrides, accuracy)
    if target:
        atomic_write(target, resolved_toml(load_case(case, [*overrides, *advice.overrides])).encode())
    if to_json:
        changes = [asdict(proposal) for proposal in proposals]
        recommended = asdict(advice) | {
            "intervals": {name: asdict(interval) for name, interval in advice.intervals.items()},
            "differences": [str(one) for one in advice.differences],
        }
        del recommended["column"]  # that of the case
        click.echo(as_json({"schema": RECORD_SCHEMA, "changes": changes, "recommended": recommended}))
        return
    if proposals:
        click.echo(f"{'single change':44s}{'time':>8s}{'zeta':>8s}{'beta':>8s}")
    else:
        click.echo("no single change saves time")
    for proposal in proposals:
        click.echo(f"{proposal.name:44s}{f'x {proposal.cost_ratio:.2g}':>8s}{_effects(proposal.effect)}")
    click.echo(f"\ncheapest within {100.0 * accuracy:.3g}%: {advice}")
    if target:
        click.echo(f"written to {target}; next: mpmcol run {quote(str(target))}")
    else:
        values = "".join(f" --set {quote(text)}" for text in overrides)
        click.echo(f"next: mpmcol run {quote(case)}{values} --accuracy {100.0 * accuracy:.3g}%, or --apply NEW.toml")


def _effects(effect: Mapping[str, float] | None) -> str:
    return "  see below" if effect is None else "".join(f"{change:>+8.1%}" for change in effect.values())
