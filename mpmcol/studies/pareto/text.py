"""pareto.md: a study for a reader."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from mpmcol.experiments import Experiment
from mpmcol.studies.pareto.reference import QUANTITIES, Reference
from mpmcol.studies.pareto.score import BETA, ZETA, Scored
from mpmcol.studies.pareto.selection import CHOSEN_BY, GOALS, Effect, cheapest, effects, of_scene
from mpmcol.studies.pareto.study import Study


def markdown(
    study: Study,
    references: Mapping[str, Reference],
    scored: Sequence[Scored],
    experiments: Mapping[str, Experiment],
    charts: Sequence[Path],
    about: Mapping[str, Any],
) -> str:
    """References, the cheapest settings, what each choice is worth, failures, charts."""
    lines = [f"# {study.title}", "", f"mpmcol {about['mpmcol']}; {about['cpu']}, one thread a run.", ""]
    lines += [*_references(study, references, experiments), "", *_cheapest(study, scored), ""]
    lines += [*_effects(study, scored), "", *_failures(scored), ""]
    lines += [f"![{chart.stem}]({chart.name})" for chart in charts]
    return "\n".join(lines).rstrip() + "\n"


def closing_lines(study: Study, scored: Sequence[Scored]) -> Iterator[str]:
    """The cheapest settings, for a terminal."""
    for scene in study.scenes:
        yield f"{scene}: the cheapest of the settings that keep to an error"
        for quantity in CHOSEN_BY:
            for goal in GOALS:
                if one := cheapest(of_scene(scored, scene), quantity, goal):
                    yield f"  {quantity:18} {goal:4.0%}  {one.cost['core_seconds']:8.2f} core-seconds  {name_of(one)}"


def name_of(one: Scored) -> str:
    """A setting for a person."""
    return f"{one.setting.family}, r_i/h = {one.setting.cells:g}"


def _references(
    study: Study, references: Mapping[str, Reference], experiments: Mapping[str, Experiment]
) -> Iterator[str]:
    """Converged values and their uncertainty, the two refinements that they are from, and the experiment's."""
    first, second = study.reference
    yield "## Converged values"
    yield ""
    yield f"| scene | quantity | limit | {first} | {second} | order | experiment | limit over it | its scatter |"
    yield "|---" * 9 + "|"
    for scene, reference in references.items():
        for quantity in QUANTITIES:
            limit, (one, other) = reference.limits[quantity], (part[quantity] for part in reference.refinements)
            law = experiments[scene].expected(quantity.partition(".")[0], study.scenes[scene].aspect)
            compared = (
                f"{law[0]:.4g} | {limit.value / law[0] - 1.0:+.1%} | {law[1] / law[0]:.0%}" if law else "none | | "
            )
            values = " | ".join(f"{part.value:.4g} +- {part.error:.2g}" for part in (limit, one, other))
            yield f"| {scene} | {quantity} | {values} | {limit.order:.1f} | {compared} |"


def _cheapest(study: Study, scored: Sequence[Scored]) -> Iterator[str]:
    yield "## The cheapest setting for an error"
    yield ""
    yield "Errors are those that nine of ten runs keep within, here and at all finer spacings; costs are core-seconds"
    yield "of one run. Families at fewer than three spacings are left out."
    yield ""
    yield f"| scene | quantity | {' | '.join(f'{goal:.0%}' for goal in GOALS)} |"
    yield "|---" * (2 + len(GOALS)) + "|"
    for scene in study.scenes:
        for quantity in CHOSEN_BY:
            found = [cheapest(of_scene(scored, scene), quantity, goal) for goal in GOALS]
            cells = [f"{name_of(one)}: {one.cost['core_seconds']:.2g} s" if one else "none" for one in found]
            yield f"| {scene} | {quantity} | {' | '.join(cells)} |"


def _effects(study: Study, scored: Sequence[Scored]) -> Iterator[str]:
    yield f"## What each choice costs and is worth alone, against {study.base}"
    yield ""
    yield "| scene | choice | r_i/h | core-seconds | point-steps | zeta (front_height) | beta |"
    yield "|---" * 7 + "|"
    for effect in effects(study, scored):
        yield (
            f"| {effect.scene} | {effect.family} | {effect.cells:g} | x {effect.cost_ratio:.2f} "
            f"| x {effect.steps_ratio:.2f} | {_changed(effect, ZETA)} | {_changed(effect, BETA)} |"
        )


def _changed(effect: Effect, quantity: str) -> str:
    change, error = effect.change[quantity]
    return f"{change:+.1%} +- {error:.1%}"


def _failures(scored: Sequence[Scored]) -> Iterator[str]:
    failed = [one for one in scored if one.failures]
    yield "## Runs that failed"
    yield ""
    yield "None." if not failed else "| scene | setting | runs that failed | cause |"
    if failed:
        yield "|---" * 4 + "|"
    for one in failed:
        count, causes = len(one.setting.members), one.causes
        yield f"| {one.setting.scene} | {name_of(one)} | {len(one.failures)} of {count} | {causes} |"
