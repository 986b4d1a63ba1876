"""Report of a study of cost against error: pareto.csv, pareto.md, and a chart for each case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import hypot
from pathlib import Path

from mpmcol.experiments import Experiment, find_experiment, mark
from mpmcol.io.atomic import atomic_write
from mpmcol.studies.convergence import ConvergedValue
from mpmcol.studies.markdown import document, images, table
from mpmcol.studies.pareto.reference import PROFILE, QUANTITIES, ConvergedReference, extrapolate
from mpmcol.studies.pareto.score import BETA, COSTS, ZETA, ScoredConfiguration
from mpmcol.studies.pareto.selection import (
    CRITERIA,
    GOALS,
    Effect,
    cheapest,
    effects,
    error_bounds,
    of_case,
    pareto_front,
)
from mpmcol.studies.pareto.study import StudyDefinition
from mpmcol.studies.runs import CompletedRun
from mpmcol.sweep.table import Row, csv_text

CSV_FILE, TEXT_FILE = "pareto.csv", "pareto.md"
ERRORS = ("bias", "scatter", "p90")  # of `RelativeError`

References = Mapping[str, ConvergedReference]  # by case
Scored = Sequence[ScoredConfiguration]


def write_report(study: StudyDefinition, references: References, scored: Scored, heading: str, out: Path) -> list[Path]:
    """Write table, text and charts into the folder `out`; return the files."""
    from mpmcol.studies.pareto.chart import case_chart  # here: a run is judged by the study without charts

    experiments = {case: experiment_of(one) for one in scored if one.runs and (case := one.configuration.case)}
    charts = []
    for case, reference in references.items():
        path = out / chart_name(case)
        own = of_case(scored, case)
        charts += case_chart(path, case, own, reference, experiments[case], study.baseline, list(study.variants))
    atomic_write(out / CSV_FILE, csv_text(list(table_rows(study, references, scored))).encode())
    atomic_write(out / TEXT_FILE, markdown(study, references, scored, experiments, charts, heading).encode())
    return [out / CSV_FILE, out / TEXT_FILE, *charts]


def chart_name(case: str) -> str:
    """Return the file name of the chart of a case."""
    return f"pareto-{''.join(letter if letter.isalnum() or letter in '.-' else '-' for letter in case)}.png"


def table_rows(study: StudyDefinition, references: References, scored: Scored) -> Iterator[Row]:
    """Yield a row for each configuration: cost, errors, error bounds, membership of Pareto fronts, failures."""
    pairs = [(case, quantity) for case in study.cases for quantity in CRITERIA]
    bounds = {
        (id(bound.scored), quantity): bound.error
        for case, quantity in pairs
        for bound in error_bounds(of_case(scored, case), quantity)
    }
    fronts = {pair: [bound.scored for bound in pareto_front(of_case(scored, pair[0]), pair[1])] for pair in pairs}
    for one in scored:
        configuration, case = one.configuration, study.cases[one.configuration.case]
        row: Row = {
            "case": configuration.case, "extends": case.extends, "a": case.aspect, "variant": configuration.variant,
            "cells": configuration.cells, "runs": len(one.runs), "failed": len(one.failures),
        }  # fmt: skip
        row |= {name: one.cost[name] if one.runs else None for name in COSTS}
        for quantity in (*QUANTITIES, PROFILE):
            error = one.errors.get(quantity)
            row |= {f"{quantity} {name}": error and getattr(error, name) for name in ERRORS}
        reference = references.get(configuration.case)
        row |= {f"{quantity} reference": reference and reference.values[quantity].value for quantity in (ZETA, BETA)}
        for quantity in CRITERIA:
            row[f"{quantity} bound"] = bounds.get((id(one), quantity))
            row[f"{quantity} reference uncertainty"] = reference and reference.uncertainty(quantity)
            row[f"{quantity} pareto-optimal"] = one in fronts[configuration.case, quantity]
        yield row | {"message": one.causes}


def experiment_of(scored: ScoredConfiguration) -> Experiment:
    """Return the experiment that the case of a configuration names."""
    case = scored.runs[0].results.case
    return find_experiment(case.score.experiment, case.geometry.model, case.geometry.column_section)


def markdown(
    study: StudyDefinition,
    references: References,
    scored: Scored,
    experiments: Mapping[str, Experiment],
    charts: Sequence[Path],
    heading: str,
) -> str:
    """Format grid-converged values, cheapest configurations, effects of single choices, failures and charts."""
    return document(
        [f"# {study.title}"],
        [f"{heading}, one thread per run."],
        ["## Grid-converged values"],
        _references(study, references, experiments),
        ["## Limits of the other variants"],
        [
            "Each is extrapolated alone. Differences are from the grid-converged value; in brackets over the standard",
            "error of the difference.",
        ],
        limits_table(study, references, scored),
        ["## Cheapest configuration for an error"],
        [
            "Errors are relative to the grid-converged values; 90 % of runs do not exceed them, at this spacing and at",
            "all finer ones. Costs are core-seconds of one run. Variants at fewer than three spacings are left out.",
        ],
        _cheapest(study, scored),
        [f'## Effect of single choices, relative to "{study.baseline}"'],
        table(
            ("case", "choice", "r_i/h", "core-seconds", "points x steps", "zeta (front_height)", "beta"),
            map(_effect, effects(study, scored)),
        ),
        ["## Failed runs"],
        _failures(scored),
        images(charts),
    )


def closing_lines(study: StudyDefinition, scored: Scored) -> Iterator[str]:
    """Yield the cheapest configurations as lines for a terminal."""
    for case in study.cases:
        yield f"{case}: cheapest configuration for an error"
        for quantity in CRITERIA:
            for goal in GOALS:
                if one := cheapest(of_case(scored, case), quantity, goal):
                    cost = f"{one.cost['core_seconds']:8.2f} core-seconds"
                    yield f"  {quantity:18} {goal:4.0%}  {cost}  {one.configuration.label}"


def _references(study: StudyDefinition, references: References, experiments: Mapping[str, Experiment]) -> Iterator[str]:
    """Yield the table of grid-converged values, of the refinements that give them, and of the experiments."""

    def cells(case: str, quantity: str) -> tuple[str, ...]:
        reference = references[case]
        converged = reference.values[quantity]
        parts = (converged, *(part[quantity] for part in reference.refinements))
        values = (f"{part.value:.4g} +- {part.error:.2g}" for part in parts)
        compared = _compared(converged.value, experiments[case], quantity.partition(".")[0], study.cases[case].aspect)
        return (case, quantity, *values, f"{converged.order:.1f}", *compared)

    return table(
        ("case", "quantity", "converged", *study.reference, "order", "experiment", "difference", "its scatter"),
        (cells(case, quantity) for case in references for quantity in QUANTITIES),
    )


def limits_table(study: StudyDefinition, references: References, scored: Scored) -> Iterator[str]:
    """Yield the table of the extrapolated values of the variants that are not part of the reference."""
    levels: dict[tuple[str, str], dict[float, Sequence[CompletedRun]]] = {}
    for one in scored:
        case, variant = one.configuration.case, one.configuration.variant
        if case in references and variant not in study.reference and one.runs:
            levels.setdefault((case, variant), {})[one.configuration.cells] = one.runs
    rows = []
    for (case, variant), own in levels.items():
        found, converged = extrapolate(own), references[case].values
        if found:
            zeta, beta = (_limit(found[quantity], converged[quantity]) for quantity in (ZETA, BETA))
            rows.append((case, variant, f"{max(own):g}", *zeta, *beta))
    return table(("case", "variant", "r_i/h up to", "zeta (front_height)", "difference", "beta", "difference"), rows)


def _limit(own: ConvergedValue, converged: ConvergedValue) -> tuple[str, str]:
    difference, error = own.value - converged.value, hypot(own.error, converged.error)
    over_error = f" ({difference / error:+.1f})" if error > 0.0 else ""  # all runs are equal
    return f"{own.value:.4g} +- {own.error:.2g}", f"{difference / converged.value:+.1%}{over_error}"


def _compared(value: float, experiment: Experiment, quantity: str, a: float) -> tuple[str, str, str]:
    """Value of the experiment, relative difference to it, and its relative scatter."""
    law, expected = experiment.law(quantity), experiment.expected(quantity, a)
    if law is None or expected is None:
        return ("none", "", "")
    return (f"{expected[0]:.4g}{mark(law.verified)}", f"{value / expected[0] - 1.0:+.1%}", f"{law.scatter:.0%}")


def _cheapest(study: StudyDefinition, scored: Scored) -> Iterator[str]:
    def cell(one: ScoredConfiguration | None) -> str:
        return f"{one.configuration.label}: {one.cost['core_seconds']:.2g} s" if one else "none"

    return table(
        ("case", "quantity", *(f"{goal:.0%}" for goal in GOALS)),
        (
            (case, quantity, *(cell(cheapest(of_case(scored, case), quantity, goal)) for goal in GOALS))
            for case in study.cases
            for quantity in CRITERIA
        ),
    )


def _effect(effect: Effect) -> tuple[str, ...]:
    changes = (f"{change:+.1%} +- {error:.1%}" for change, error in (effect.change[name] for name in (ZETA, BETA)))
    ratios = f"x {effect.cost_ratio:.2f}", f"x {effect.steps_ratio:.2f}"
    return (effect.case, effect.variant, f"{effect.cells:g}", *ratios, *changes)


def _failures(scored: Scored) -> Iterator[str]:
    failed = [one for one in scored if one.failures]
    if not failed:
        return iter(("None.",))
    rows = (
        (
            one.configuration.case, one.configuration.label, f"{len(one.failures)} of {len(one.configuration.runs)}",
            one.causes,
        )
        for one in failed
    )  # fmt: skip
    return table(("case", "configuration", "failed runs", "cause"), rows)
