"""Report of scenarios: stability.csv, stability.md and charts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import cycle
from pathlib import Path
from typing import Any

from mpmcol.failure_modes.scenario import Scenario, ScenarioOutcome, TheoryOutcome, Trial, TrialOutcome
from mpmcol.io.atomic import atomic_write
from mpmcol.provenance import code_version
from mpmcol.sweep.table import Row, csv_text

CSV_FILE, TEXT_FILE = "stability.csv", "stability.md"
# Of the first, second, ... method of each kind; thin lines over thick ones remain visible where they coincide.
LINE_STYLES: tuple[dict[str, Any], ...] = (
    {"linestyle": "-", "linewidth": 2.6},
    {"linestyle": "--", "linewidth": 1.5},
    {"linestyle": ":", "linewidth": 1.5},
)
COLOURS = {False: ("#b2182b", "#f4a582", "#d6604d"), True: ("black", "0.65", "0.45")}  # failing, passing methods
PASSED = {True: "passed", False: "failed"}


def write_report(outcomes: Sequence[ScenarioOutcome], out: Path) -> list[Path]:
    """Write tables and charts into `out`; returns the files."""
    charts = {outcome.scenario.name: path for outcome in outcomes if (path := _draw_chart(outcome, out))}
    rows = [row for outcome in outcomes for row in table_rows(outcome)]
    atomic_write(out / CSV_FILE, csv_text(rows).encode())
    atomic_write(out / TEXT_FILE, markdown(outcomes, charts).encode())
    return [out / CSV_FILE, out / TEXT_FILE, *charts.values()]


def table_rows(outcome: ScenarioOutcome) -> Iterator[Row]:
    """One row for each method and for each quantity with a known value."""
    scenario = outcome.scenario
    for trial in outcome.trials:
        yield {
            "scenario": scenario.name, "unit": scenario.unit, "method": trial.trial.method,
            "default": trial.trial.default, "metric": scenario.metric, "value": trial.observation.metric,
            "bound": scenario.bound, "theory": None, "expected": PASSED[trial.trial.should_pass],
            "outcome": PASSED[trial.passed], "verdict": trial.verdict, "source": scenario.source,
            "note": trial.observation.note,
        }  # fmt: skip
    for known in outcome.theory:
        yield {
            "scenario": scenario.name, "unit": scenario.unit, "method": "", "default": "",
            "metric": known.theory.quantity, "value": known.value, "bound": None, "theory": known.theory.value,
            "expected": f"within {100.0 * known.theory.tolerance:g} %", "outcome": f"{100.0 * known.error:+.2g} %",
            "verdict": known.verdict, "source": known.theory.source, "note": "",
        }  # fmt: skip


def with_unit(value: float, unit: str = "") -> str:
    """A value with three significant digits and its unit."""
    return f"{value:.3g} {unit}".strip()


def outcome_lines(outcome: ScenarioOutcome) -> Iterator[tuple[str, str, str]]:
    """Method, value and outcome of each trial and of each quantity with a known value, as text."""
    unit = outcome.scenario.unit
    for trial in outcome.trials:
        yield method_name(trial.trial), with_unit(trial.observation.metric, unit), PASSED[trial.passed] + _alert(trial)
    for known in outcome.theory:
        result = f"{100.0 * known.error:+.2g} % from theory ({with_unit(known.theory.value)})"
        yield known.theory.quantity, with_unit(known.value), result + _alert(known)


def _alert(outcome: TrialOutcome | TheoryOutcome) -> str:
    return "" if outcome.verdict == "as expected" else f": {outcome.verdict.upper()}"


def method_name(trial: Trial) -> str:
    """The method, marked if it is a default of a case."""
    return trial.method + (" (default)" if trial.default else "")


def failing_defaults(outcomes: Sequence[ScenarioOutcome]) -> list[Scenario]:
    """The scenarios in which a default of a case is expected to fail."""
    return [outcome.scenario for outcome in outcomes if outcome.scenario.default_fails]


def markdown(outcomes: Sequence[ScenarioOutcome], charts: dict[str, Path]) -> str:
    """Report of all scenarios with values, bounds, sources and remedies."""
    as_expected = sum(outcome.verdict == "as expected" for outcome in outcomes)
    lines = [
        "# Failure modes", "",
        f"mpmcol {code_version()}. {as_expected} of {len(outcomes)} scenarios as expected: methods expected to fail "
        "failed, methods expected to pass passed. A method fails if its metric exceeds the bound; inf means that the "
        "solver stopped. Sources and derivations: mpmcol/failure_modes/README.md.", "",
    ]  # fmt: skip
    if found := failing_defaults(outcomes):
        lines += ["Scenarios in which a default fails:", ""]
        lines += [f"* [{one.name}](#{one.name}): {one.mechanism} Remedy: {one.remedy}." for one in found]
        lines += [""]
    for outcome in outcomes:
        lines += _section(outcome, charts.get(outcome.scenario.name))
    return "\n".join(lines).rstrip() + "\n"


def _section(outcome: ScenarioOutcome, chart: Path | None) -> list[str]:
    scenario = outcome.scenario
    rows = [f"| {' | '.join(cells)} |" for cells in outcome_lines(outcome)]
    notes = [f"* {one.trial.method}: {one.observation.note}" for one in outcome.trials if one.observation.note]
    sources = [f"* Theory, {one.theory.quantity}: {one.theory.source}." for one in outcome.theory]
    remarks = [*notes, *sources]
    return [
        f"## {scenario.name}", "", scenario.mechanism, "",
        f"| method | {scenario.metric} | outcome |", "|---" * 3 + "|", *rows, "", *remarks, *[""] * bool(remarks),
        f"Bound: {with_unit(scenario.bound, scenario.unit)} ({scenario.source}). Remedy: {scenario.remedy}.", "",
        *([f"![{scenario.name}]({chart.name})", ""] if chart else []),
    ]  # fmt: skip


def _draw_chart(outcome: ScenarioOutcome, out: Path) -> Path | None:
    """Chart with one line for each method; None if the scenario has no curves."""
    scenario, drawn = outcome.scenario, [one for one in outcome.trials if one.observation.curve is not None]
    if scenario.axes is None or not drawn:
        return None
    from matplotlib.figure import Figure

    from mpmcol.plotting.charts import save_figure

    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    axes = figure.subplots()
    for should_pass, colours in COLOURS.items():
        same_kind = [one for one in drawn if one.trial.should_pass is should_pass]
        for one, colour, style in zip(same_kind, cycle(colours), cycle(LINE_STYLES), strict=False):
            assert one.observation.curve is not None
            label = f"{method_name(one.trial)}: {PASSED[one.passed]}"
            axes.plot(*one.observation.curve, color=colour, label=label, **style)
    axes.set(xlabel=scenario.axes[0], ylabel=scenario.axes[1], title=scenario.name)
    axes.grid(color="0.9")
    figure.legend(loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    path = out / f"{scenario.name}.png"
    save_figure(figure, path, svg=False)
    return path
