"""What scenes become: stability.csv, stability.md and charts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import cycle
from pathlib import Path

from mpmcol.failure_modes.scenario import Scene, SceneOutcome, Trial
from mpmcol.io.atomic import atomic_write
from mpmcol.provenance import code_version
from mpmcol.sweep.table import Row, csv_text

CSV_FILE, TEXT_FILE = "stability.csv", "stability.md"
DASHES = ("-", "--", "-.", ":")
STOOD = {True: "stood", False: "failed"}


def write_report(outcomes: Sequence[SceneOutcome], out: Path) -> list[Path]:
    """Write tables and charts into `out`; returns the files."""
    charts = {outcome.scene.name: path for outcome in outcomes if (path := _draw(outcome, out))}
    rows = [row for outcome in outcomes for row in table_rows(outcome)]
    atomic_write(out / CSV_FILE, csv_text(rows).encode())
    atomic_write(out / TEXT_FILE, markdown(outcomes, charts).encode())
    return [out / CSV_FILE, out / TEXT_FILE, *charts.values()]


def table_rows(outcome: SceneOutcome) -> Iterator[Row]:
    """A row for each method and for each number that theory knows."""
    scene = outcome.scene
    about = {"scene": scene.name, "unit": scene.unit}
    for trial in outcome.trials:
        yield about | {
            "method": trial.trial.method, "default": trial.trial.default, "number": scene.sign,
            "value": trial.reading.sign, "bound": scene.bound, "theory": None, "expected": STOOD[trial.trial.stands],
            "outcome": STOOD[trial.stood], "verdict": trial.verdict, "source": scene.source,
            "note": trial.reading.note,
        }  # fmt: skip
    for known in outcome.theory:
        yield about | {
            "method": "", "default": "", "number": known.theory.number, "value": known.value, "bound": None,
            "theory": known.theory.value, "expected": f"within {100.0 * known.theory.tolerance:g} %",
            "outcome": f"{100.0 * known.error:+.2g} %", "verdict": known.verdict, "source": known.theory.source,
            "note": "",
        }  # fmt: skip


def shown(value: float, unit: str = "") -> str:
    """A number for a person."""
    return f"{value:.3g} {unit}".strip()


def trial_lines(outcome: SceneOutcome) -> Iterator[tuple[str, str, str]]:
    """Method, number, and outcome of each trial and each theory, for a person."""
    unit = outcome.scene.unit
    for trial in outcome.trials:
        result = STOOD[trial.stood] + ("" if trial.verdict == "as expected" else f": {trial.verdict.upper()}")
        yield method_of(trial.trial), shown(trial.reading.sign, unit), result
    for known in outcome.theory:
        result = f"{100.0 * known.error:+.2g} % off {shown(known.theory.value)}"
        bad = "" if known.verdict == "as expected" else f": {known.verdict.upper()}"
        yield f"{known.theory.number}, against theory", shown(known.value), result + bad


def method_of(trial: Trial) -> str:
    """The method, marked where it is what a case has by default."""
    return trial.method + (" (default)" if trial.default else "")


def gaps(outcomes: Sequence[SceneOutcome]) -> list[Scene]:
    """The scenes in which what a case does by default is known to fail."""
    return [outcome.scene for outcome in outcomes if outcome.scene.is_gap]


def markdown(outcomes: Sequence[SceneOutcome], charts: dict[str, Path]) -> str:
    """Every scene with its numbers, bound, source and remedy, for a reader."""
    well = sum(outcome.verdict == "as expected" for outcome in outcomes)
    lines = [
        "# Where methods fail", "",
        f"mpmcol {code_version()}. {well} of {len(outcomes)} scenes went as expected: what must fail failed, what must "
        "stand stood. A method fails whose number is above the bound; inf: the solver stopped.", "",
    ]  # fmt: skip
    if found := gaps(outcomes):
        lines += ["Scenes in which the default fails:", ""]
        lines += [f"* [{scene.name}](#{scene.name}): {scene.mechanism} Remedy: {scene.remedy}." for scene in found]
        lines += [""]
    for outcome in outcomes:
        lines += _section(outcome, charts.get(outcome.scene.name))
    return "\n".join(lines).rstrip() + "\n"


def _section(outcome: SceneOutcome, chart: Path | None) -> list[str]:
    scene = outcome.scene
    rows = [f"| {' | '.join(cells)} |" for cells in trial_lines(outcome)]
    notes = [f"* {trial.trial.method}: {trial.reading.note}" for trial in outcome.trials if trial.reading.note]
    return [
        f"## {scene.name}", "", scene.mechanism, "",
        f"| method | {scene.sign} | outcome |", "|---" * 3 + "|", *rows, "", *notes, *[""] * bool(notes),
        f"Bound: {shown(scene.bound, scene.unit)} ({scene.source}). Remedy: {scene.remedy}.", "",
        *([f"![{scene.name}]({chart.name})", ""] if chart else []),
    ]  # fmt: skip


def _draw(outcome: SceneOutcome, out: Path) -> Path | None:
    """A line for each method, where the scene has a chart."""
    scene, drawn = outcome.scene, [trial for trial in outcome.trials if trial.reading.curve is not None]
    if scene.axes is None or not drawn:
        return None
    from matplotlib.figure import Figure

    from mpmcol.plotting.charts import save_figure

    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    axes = figure.subplots()
    for trial, dash in zip(drawn, cycle(DASHES), strict=False):
        colour = "black" if trial.trial.stands else "#b2182b"
        assert trial.reading.curve is not None
        axes.plot(*trial.reading.curve, linestyle=dash, color=colour, label=method_of(trial.trial))
    axes.set(xlabel=scene.axes[0], ylabel=scene.axes[1], title=scene.name)
    axes.grid(color="0.9")
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize="small")
    path = out / f"{scene.name}.png"
    save_figure(figure, path, svg=False)
    return path
