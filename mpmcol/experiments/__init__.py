"""Published experiments on column collapse, and scores against them.

To add a data set, write a file beside this one and add one line to EXPERIMENTS.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from mpmcol.errors import UsageError
from mpmcol.experiments.base import Experiment, Law, Piece, Profile, ProfileScore, Score, column_kind
from mpmcol.experiments.records import (
    balmforth_kerswell_2005,
    bougouin_lacaze_2018,
    bui_2008,
    dunatunga_kamrin_2015,
    kumar_dem,
    lagree_2011,
    lajeunesse_2004,
    lajeunesse_2005,
    lube_2004,
    lube_2005,
    lube_2005_single_break,
    lube_2007,
    paper_axisymmetric,
    paper_plane,
)
from mpmcol.experiments.scores import score_laws, score_profile
from mpmcol.selection import suggestion

__all__ = [
    "EXPERIMENTS",
    "Experiment",
    "Law",
    "Piece",
    "Profile",
    "ProfileScore",
    "Score",
    "column_kind",
    "expected_runout",
    "find_experiment",
    "profile_score",
    "profile_scores",
    "score",
]

_FILES = (
    paper_plane,
    lube_2007,
    lube_2005,
    lube_2005_single_break,
    lajeunesse_2005,
    balmforth_kerswell_2005,
    bougouin_lacaze_2018,
    bui_2008,
    lagree_2011,
    dunatunga_kamrin_2015,
    kumar_dem,
    paper_axisymmetric,
    lube_2004,
    lajeunesse_2004,
)
EXPERIMENTS: dict[str, Experiment] = {file.EXPERIMENT.name: file.EXPERIMENT for file in _FILES}

# The farthest-running laboratory law of each kind; neither has a gap and both only grow. A box, which spreads to
# more sides than a plane column, runs no farther.
_FARTHEST = {
    "plane": bougouin_lacaze_2018.EXPERIMENT.laws[0],
    "axisymmetric": lajeunesse_2004.EXPERIMENT.laws[0],
    "box": bougouin_lacaze_2018.EXPERIMENT.laws[0],
}
_NO_BOX = Experiment("none", "no published collapse of a box", "box", "two-sided", "laboratory", "", ())


def find_experiment(name: str, model: str, section: str = "cylinder") -> Experiment:
    """The experiment of that name; "paper" is the paper's own for the model, and one without laws for a box.

    Raises:
        UsageError: there is no such experiment, or it is on another kind of column.
    """
    kind = column_kind(model, section)
    if name == "paper" and kind == "box":
        return _NO_BOX
    experiment = EXPERIMENTS.get(f"paper-{kind}" if name == "paper" else name)
    if experiment is None:
        raise UsageError(f"no experiment is called {name!r}; {suggestion(name, ['paper', *EXPERIMENTS])}")
    if experiment.model != kind:
        raise UsageError(f"experiment {name!r} is {experiment.model}, the column is {kind}")
    return experiment


def score(measured: Any, a: float, model: str, section: str = "cylinder") -> list[Score]:
    """Errors against every published law for columns of this kind (see `column_kind`) at aspect ratio a.

    Args:
        measured: a `Measurement`, or a mapping of quantities ("zeta", "beta", "stop_time") to a number or to
            a mapping of front definitions to numbers, or to the mean, min and max of a 3D result.
        a: h_i / r_i.
        model: "plane", "axisymmetric", "quarter" or "full".
        section: of a 3D column, "cylinder" or "box".

    Where a law has no value at a, the score says so in its comment and has no error: nothing is extrapolated.
    A law that several entries share is scored once, under the first (the paper's) name.
    """
    return score_laws(EXPERIMENTS, measured, a, column_kind(model, section))


def profile_score(profile_x: ArrayLike, profile_y: ArrayLike, experiment: Experiment) -> ProfileScore | None:
    """A deposit profile (m, by increasing x, ending at zero) against the digitised surface of an experiment.

    A surface in metres is compared as it is, so the column must have its size (`experiment.fits`); a
    universal shape is scaled to the deposit's own length and height. None if the experiment has no surface.
    """
    return score_profile(profile_x, profile_y, experiment)


def profile_scores(
    profile_x: ArrayLike, profile_y: ArrayLike, model: str, r_i: float, h_i: float, section: str = "cylinder"
) -> list[ProfileScore]:
    """A deposit profile against every digitised surface that fits the column (m), each once."""
    once = {  # under the first name that has it
        experiment.profiles: experiment
        for experiment in reversed(EXPERIMENTS.values())
        if experiment.model == column_kind(model, section) and experiment.fits(r_i, h_i)
    }
    found = [profile_score(profile_x, profile_y, experiment) for experiment in reversed(once.values())]
    return [entry for entry in found if entry is not None]


def expected_runout(model: str, a: float, section: str = "cylinder") -> float:
    """A generous zeta for sizing the domain, for every a > 0.

    It is the farthest-running laboratory law for the column, with its power laws extended at both ends.
    """
    law = _FARTHEST[column_kind(model, section)]
    return next(piece for piece in reversed(law.pieces) if a >= piece.lo)(a)
