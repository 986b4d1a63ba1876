"""What a study becomes: pareto.csv, pareto.md, environment.json, and a chart for each scene."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from mpmcol.experiments import Experiment, find_experiment
from mpmcol.io.atomic import atomic_write
from mpmcol.provenance import environment
from mpmcol.studies.pareto.chart import scene_chart
from mpmcol.studies.pareto.reference import QUANTITIES, Reference
from mpmcol.studies.pareto.score import COSTS, PROFILE, Scored
from mpmcol.studies.pareto.selection import CHOSEN_BY, kept_errors, of_scene, pareto_front
from mpmcol.studies.pareto.study import Study
from mpmcol.studies.pareto.text import markdown
from mpmcol.sweep.table import csv_text

CSV_FILE, TEXT_FILE, ENVIRONMENT_FILE = "pareto.csv", "pareto.md", "environment.json"


def write_report(study: Study, references: Mapping[str, Reference], scored: Sequence[Scored], out: Path) -> list[Path]:
    """Write all tables and charts into `out`; returns the files."""
    experiments = {scene: experiment_of(one) for one in scored if one.runs and (scene := one.setting.scene)}
    charts = [
        path
        for scene, reference in references.items()
        for path in _draw(study, scene, reference, scored, experiments[scene], out)
    ]
    about = environment()
    text = markdown(study, references, scored, experiments, charts, about)
    atomic_write(out / CSV_FILE, csv_text(list(table_rows(study, references, scored))).encode())
    atomic_write(out / TEXT_FILE, text.encode())
    atomic_write(out / ENVIRONMENT_FILE, (json.dumps(about, indent=1) + "\n").encode())
    return [out / CSV_FILE, out / TEXT_FILE, out / ENVIRONMENT_FILE, *charts]


def table_rows(study: Study, references: Mapping[str, Reference], scored: Sequence[Scored]) -> Iterator[dict[str, Any]]:
    """A row for each setting: what it is, what it costs, its errors, whether others beat it, and why runs failed."""
    kept = {
        (id(kept.one), quantity): kept.error
        for scene in study.scenes
        for quantity in CHOSEN_BY
        for kept in kept_errors(of_scene(scored, scene), quantity)
    }
    fronts = {
        (scene, quantity): [kept.one for kept in pareto_front(of_scene(scored, scene), quantity)]
        for scene in study.scenes
        for quantity in CHOSEN_BY
    }
    for one in scored:
        setting, scene = one.setting, study.scenes[one.setting.scene]
        row: dict[str, Any] = {
            "scene": setting.scene, "case": scene.case, "a": scene.aspect, "family": setting.family,
            "cells": setting.cells, "runs": len(one.runs), "failed": len(one.failures),
        }  # fmt: skip
        row |= {name: one.cost[name] if one.runs else None for name in COSTS}
        for quantity in (*QUANTITIES, PROFILE):
            error = one.errors.get(quantity)
            row |= {f"{quantity} {what}": error and getattr(error, what) for what in ("bias", "scatter", "usual")}
        reference = references.get(setting.scene)
        for quantity in CHOSEN_BY:
            row[f"{quantity} kept"] = kept.get((id(one), quantity))
            row[f"{quantity} reference +-"] = reference and reference.uncertainty(quantity)
            row[f"{quantity} unbeaten"] = one in fronts[setting.scene, quantity]
        yield row | {"message": one.causes}


def experiment_of(scored: Scored) -> Experiment:
    """The experiment that the case of a setting names."""
    case = scored.runs[0].results.case
    return find_experiment(case.score.experiment, case.geometry.model, case.geometry.section)


def _draw(
    study: Study, scene: str, reference: Reference, scored: Sequence[Scored], experiment: Experiment, out: Path
) -> list[Path]:
    own = of_scene(scored, scene)
    name = "".join(letter if letter.isalnum() or letter in ".-" else "-" for letter in scene)
    return scene_chart(out / f"pareto-{name}.png", scene, own, reference, experiment, study.base)
