"""Colours, lines and markers of all charts: each published data set, each front and each energy has one style.

Lines differ by their dashes as well, so that charts are readable without colour.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from matplotlib import colormaps
from matplotlib.colors import ListedColormap

from mpmcol.experiments import EXPERIMENTS, Experiment, Profile


@dataclass(frozen=True)
class ExperimentStyle:
    """Style of a published data set: one colour for its first author, lines and markers differ by year."""

    colour: str
    line: Any = "-"
    marker: str = "D"


_RED, _BLUE = "#b2182b", "#2166ac"
EXPERIMENT_STYLES: dict[str, ExperimentStyle] = {  # by citation
    "Lube et al. 2007": ExperimentStyle(_RED, "-", "D"),
    "Lube et al. 2005": ExperimentStyle(_RED, "--", "x"),
    "Lube et al. 2005 with a single break": ExperimentStyle(_RED, ":", "x"),
    "Lube et al. 2004": ExperimentStyle(_RED, (0, (8, 2)), "s"),
    "Lajeunesse et al. 2005": ExperimentStyle(_BLUE, "--", "^"),
    "Lajeunesse et al. 2004": ExperimentStyle(_BLUE, "-.", "v"),
    "Balmforth & Kerswell 2005": ExperimentStyle("#1b7837", "-.", "p"),
    "Bougouin & Lacaze 2018": ExperimentStyle("#762a83", (0, (4, 1, 1, 1)), "h"),
    "Bui et al. 2008": ExperimentStyle("#b35806", (0, (3, 1)), "P"),
    "Lagree et al. 2011": ExperimentStyle("#01665e", (0, (6, 1, 1, 1, 1, 1)), "<"),
    "Dunatunga & Kamrin 2015": ExperimentStyle("#c51b7d", (0, (1, 1)), ">"),
    "Kumar (thesis)": ExperimentStyle("#80701a", (0, (2, 2)), "*"),
}
POINTS_COLOUR = "#0072b2"  # measurements of the user
POINT_MARKERS = "o^sDvP*"
RUN_COLOURS = ("black", "#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#0072b2", "#d55e00")
RUN_LINES: tuple[Any, ...] = ("-", "--", "-.", (0, (1, 1)), (0, (6, 2, 1, 2, 1, 2)), (0, (8, 3)), (0, (3, 1, 1, 1)))
TIME_COLOURS = ListedColormap(colormaps["viridis_r"](range(30, 256)), "times")  # early: light, last: dark
DEPOSIT_STYLE: dict[str, Any] = {"color": "black", "linewidth": 2.0}
HOLLOW: dict[str, Any] = {"fillstyle": "none", "clip_on": False}
GATE_STYLE: dict[str, Any] = {"color": "0.25", "linewidth": 0.8}
WALL_STYLE: dict[str, Any] = {"facecolor": "0.75", "edgecolor": "0.25", "linewidth": 0.8}
BED_STYLE: dict[str, Any] = {"facecolor": "0.9", "linewidth": 0, "zorder": -2}
SURFACE_STYLE: dict[str, Any] = {"color": "#a6611a", "linestyle": "--", "linewidth": 1.8}  # of deposit and bed
FRONT_STYLES: dict[str, dict[str, Any]] = {
    "front_max": {"linestyle": (0, (1, 1)), "color": "0.6", "linewidth": 2.5, "marker": "v"},
    "front_connected": {"linestyle": "--", "color": "0.35", "marker": "s"},
    "front_height": {"linestyle": "-", "color": "black", "marker": "o"},
}
FRONT_LABELS = {
    "front_max": "front_max (farthest point)",
    "front_connected": "front_connected (farthest point without a gap)",
    "front_height": "front_height (end of the deposit)",
}
ENERGY_STYLES: dict[str, dict[str, Any]] = {  # columns of the history
    "kinetic": {"label": "kinetic energy", "linestyle": "-", "color": "#e69f00", "linewidth": 2.2},
    "plastic": {"label": "plastic work", "linestyle": "--", "color": "#d55e00"},
    "damping": {"label": "dissipated by damping", "linestyle": "-.", "color": "#0072b2"},
    "filter": {"label": "dissipated by the stress filter", "linestyle": (0, (3, 1, 1, 1)), "color": "#cc79a7"},
    "elastic": {"label": "elastic energy", "linestyle": (0, (1, 1)), "color": "0.5"},
    "transfer": {"label": "dissipated by transfer", "linestyle": (0, (6, 2, 1, 2, 1, 2)), "color": "#009e73"},
    "walls": {"label": "dissipated at walls", "linestyle": (0, (8, 3)), "color": "0.3"},
    "wall_friction": {"label": "friction on walls", "linestyle": (0, (4, 1, 1, 1)), "color": "#56b4e9"},
}
ENERGY_NAMES = {name: str(style["label"]).removeprefix("dissipated ") for name, style in ENERGY_STYLES.items()}


def experiment_style(experiment: Experiment) -> ExperimentStyle:
    """The style of a data set in every chart, by its citation."""
    return EXPERIMENT_STYLES.get(experiment.citation, ExperimentStyle("0.4"))


def author_of(profile: Profile) -> Experiment:
    """The data set in which a digitised profile was published."""
    return EXPERIMENTS[profile.experiment]
