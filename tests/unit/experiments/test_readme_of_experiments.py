"""The table in mpmcol/experiments/README.md agrees with the records."""

from __future__ import annotations

from pathlib import Path

import pytest

from mpmcol import experiments
from mpmcol.experiments import EXPERIMENTS, Experiment

README = Path(experiments.__file__).parent / "README.md"


def row(experiment: Experiment) -> str:
    """The row of a record: name, author, column, material, what is given, DOI."""
    parts = [*experiment.laws, *experiment.profiles]
    given = {True: [part_name(part) for part in parts if part.verified]}
    given[False] = [part_name(part) for part in parts if not part.verified]
    column = f"{experiment.model}, {experiment.release}" if experiment.model == "plane" else experiment.model
    cells = (f"`{experiment.name}`", experiment.title, experiment.kind, column, experiment.material)
    return "| " + " | ".join([*cells, ", ".join(given[True]), ", ".join(given[False]), experiment.doi or "none"]) + " |"


def part_name(part: experiments.Law | experiments.Profile) -> str:
    return part.quantity if isinstance(part, experiments.Law) else part.name


@pytest.mark.parametrize("experiment", EXPERIMENTS.values(), ids=EXPERIMENTS)
def test_every_record_has_its_row(experiment: Experiment) -> None:
    assert row(experiment) in README.read_text().splitlines()


def test_there_is_no_row_without_a_record() -> None:
    rows = [line for line in README.read_text().splitlines() if line.startswith("| `") and line.count(" | ") == 7]
    assert len(rows) == len(EXPERIMENTS)
