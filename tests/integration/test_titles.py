"""A title that has an aspect ratio has that of the column everywhere, whatever the case file has."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mpmcol.case import load_case
from mpmcol.case.title import title_of
from mpmcol.io.results import Results
from mpmcol.sweep.axes import parse_axes
from mpmcol.sweep.runner import make_plan
from mpmcol.sweep.runs import plan_runs
from mpmcol.sweep.scheduling import Allocation
from tests.support.cli import invoke, set_options

SETTINGS = (
    "geometry.aspect=1.7", "grid.spacing=0.0194", "output.snapshots=2", "stages.collapse.max_time_factor=0.3"
)  # fmt: skip
TITLE = "Quickstart: a cylinder of sand, a = 1.7"

pytestmark = pytest.mark.usefixtures("in_empty_folder")


def test_the_aspect_ratio_in_the_title_is_that_of_the_column() -> None:
    options = set_options(SETTINGS)
    assert "a = 2.75" in load_case("quickstart").title and title_of(load_case("quickstart", SETTINGS)) == TITLE
    assert invoke("run", "quickstart", *options, "--out", "r").exit_code == 0
    status = json.loads(invoke("status", "r", "--json").stdout)
    assert status["version"] == Results("r").summary["versions"]["mpmcol"]
    texts = {
        "result.json": Results("r").summary["title"],
        "run.log": Path("r/run.log").read_text(),
        "check": invoke("check", "quickstart", *options).output,
        "status": invoke("status", "r").output,
        "repr": repr(Results("r")),
    }
    for place, text in texts.items():
        assert TITLE in text and "2.75" not in text, place


def test_a_resolved_case_has_the_aspect_ratio_of_its_column_in_its_title() -> None:
    assert load_case("quickstart", ["geometry.aspect=1"]).title == "Quickstart: a cylinder of sand, a = 1"
    assert load_case("quickstart", ["geometry.height=0.26675"]).title == "Quickstart: a cylinder of sand, a = 2.75"
    heap = load_case("quickstart", ["geometry.outline=[[0, 0], [0.1, 0], [0, 0.2]]"])
    assert heap.title == "Quickstart: a cylinder of sand"
    assert load_case("quickstart", ["geometry.aspect=1", "title=mine"]).title == "mine"


def test_a_sweep_over_the_aspect_ratio_has_none_in_its_title() -> None:
    runs = plan_runs("quickstart", parse_axes("1,2", [])[0], Path("s"))
    assert make_plan(runs, Allocation(1, 1)).title == "Quickstart: a cylinder of sand"
