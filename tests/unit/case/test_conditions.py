"""Cases are compared only with experiments made in similar conditions: one rule for scores, charts and judgement."""

from __future__ import annotations

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from mpmcol.case import (
    Case,
    applicable_experiments,
    compared_experiment,
    conditions_of,
    experiment_of,
    load_case,
)
from mpmcol.experiments import EXPERIMENTS, profile_scores, score
from mpmcol.plotting import charts, comparison
from mpmcol.plotting.comparison import chart_comparison
from mpmcol.plotting.run_charts import chart_run
from tests.support.figures import recorded_figures
from tests.support.synthetic_run import SyntheticRun

FLOOR = ("geometry.base=rigid", "method.wall_impulse=true")
BED = ("geometry.base=granular", "geometry.base_thickness=0.03", "method.wall_impulse=true")
RANDOM_FIELD = (
    "material={ law = 'mohr-coulomb-random', density = 2650, youngs_modulus = 10e6, poissons_ratio = 0.2, "
    "friction_deg = 33, friction_variation = 0.15, correlation_length = 0.05 }"
)
REFUSED = {  # what no published experiment had -> a part of the reason
    ("material.friction_deg=8",): "here it is 8 deg",
    ("material.cohesion=500",): "for grains without cohesion",
    ("geometry.slope_deg=10",): "here it slopes by 10 deg",
    (*FLOOR, "friction.floor=0"): "slides over it, friction 0",
    (*FLOOR, "friction.floor=0.5"): "slides over it, friction 0.5",
    (*BED,): "here the flow can erode it",
    (*BED, "base_material.friction_deg=5"): "here the flow can erode it",
    (*FLOOR, "friction.side_walls=0.6", "friction.channel_width=0.02"): "here side walls 20 mm apart have friction",
    ("stages.gate_speed=0.05",): "for a sudden release; here the gate moves at 0.053 sqrt(g h_i)",
    ("stages.gate=false",): "here it stands free",
    (*FLOOR, "walls=[{ from = 0.2 }]"): "here walls stand in its way",
    (RANDOM_FIELD,): "for uniform material; here the friction varies by 15 %",
    ("layers=[{ to = 0.05, material = { friction_deg = 30 } }]",): "here it has layers",
}
ALLOWED = [
    (),
    (*FLOOR, "friction.floor=0.6"),  # more than sin(33 deg): the sand does not slide
    (*FLOOR, "friction.back_wall=0.3"),
    (*FLOOR, "friction.side_walls=0.6", "friction.channel_width=0.2"),
    (*FLOOR, "friction.side_walls=0", "friction.channel_width=0.02"),  # smooth side walls
    ("stages.gate_speed=0.5",),
]


def drawn(figures: list[Figure]) -> list[str]:
    """Labels of all lines and bars, and the texts of the headings."""
    artists = [handle for figure in figures for axes in figure.axes for handle in (*axes.lines, *axes.containers)]
    labels = [str(artist.get_label()) for artist in artists]
    return [*labels, *(text.get_text() for figure in figures for axes in figure.axes for text in axes.texts)]


class Column(SyntheticRun):
    """A synthetic run with another case."""

    def __init__(self, folder: Path, case: Case) -> None:
        super().__init__(folder)
        self.own_case = case

    @property
    def case(self) -> Case:
        return self.own_case


@pytest.mark.parametrize(("overrides", "reason"), REFUSED.items(), ids=REFUSED.values())
def test_what_no_experiment_had_is_neither_scored_nor_drawn(
    overrides: tuple[str, ...], reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = load_case("coarse-channel", overrides)
    conditions = conditions_of(case)
    assert applicable_experiments(case) == []
    assert experiment_of(case).laws == () and reason in experiment_of(case).title
    assert compared_experiment(case).laws == () and reason in compared_experiment(case).title
    assert {one.error for one in score({"zeta": 1.5, "beta": 0.9}, 1.0, "plane", conditions=conditions)} == {None}
    assert profile_scores([0.0, 0.2], [0.09, 0.0], "plane", 0.09, 0.09, conditions=conditions) == []
    figures = [recorded_figures(monkeypatch, module, saved=False) for module in (charts, comparison)]
    run = Column(tmp_path / "one", case)
    chart_run(run, out=tmp_path)  # type: ignore[arg-type]
    chart_comparison([run, Column(tmp_path / "two", case)], out=tmp_path)  # type: ignore[list-item]
    for shown, charts_with_experiment in zip(figures, (2, 2), strict=True):
        texts = drawn(shown)
        assert not any("scatter" in text or "surface" in text for text in texts)
        assert sum(reason in text.replace("\n", " ") for text in texts) == charts_with_experiment


@pytest.mark.parametrize("overrides", ALLOWED)
def test_what_the_experiment_had_is_compared(overrides: tuple[str, ...]) -> None:
    case = load_case("coarse-channel", overrides)
    assert experiment_of(case) is compared_experiment(case) is EXPERIMENTS["lube-2007"]
    assert profile_scores([0.0, 0.2], [0.09, 0.0], "plane", 0.09, 0.09, conditions=conditions_of(case))


def test_a_surface_is_scored_under_the_name_of_its_authors_and_in_the_range_of_its_laws() -> None:
    (found,) = profile_scores([0.0, 0.2], [0.09, 0.0], "plane", 0.09, 0.09)
    assert found.experiment == "lube-2005"
    assert profile_scores([0.0, 0.2], [0.09, 0.0], "plane", 0.09, 0.009) == []


def test_side_walls_as_narrow_as_those_of_another_channel() -> None:
    walls = (*FLOOR, "friction.side_walls=0.6", "friction.channel_width=0.12")
    assert compared_experiment(load_case("coarse-channel", walls)).citation == "Lube et al. 2005"
