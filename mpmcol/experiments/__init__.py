"""Published experiments on column collapse, and scores of results against them.

To add an experiment, write a module in `records` that satisfies `ExperimentRecord` and add it to `_RECORDS`.
"""

from __future__ import annotations

from typing import Any, Protocol

from numpy.typing import ArrayLike

from mpmcol.errors import UsageError, suggestion
from mpmcol.experiments.base import (
    OUTLINE,
    Conditions,
    Experiment,
    Law,
    Piece,
    Profile,
    ProfileScore,
    Score,
    column_kind,
    mark,
    without_laws,
)
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
)
from mpmcol.experiments.scores import score_laws, score_profile

__all__ = [
    "EXPERIMENTS",
    "OUTLINE",
    "Conditions",
    "Experiment",
    "ExperimentRecord",
    "Law",
    "Piece",
    "Profile",
    "ProfileScore",
    "Score",
    "column_kind",
    "expected_runout",
    "find_experiment",
    "mark",
    "profile_score",
    "profile_scores",
    "score",
    "without_laws",
]


class ExperimentRecord(Protocol):
    """What the module of an experiment defines."""

    EXPERIMENT: Experiment


_RECORDS: tuple[ExperimentRecord, ...] = (
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
    lube_2004,
    lajeunesse_2004,
)
EXPERIMENTS: dict[str, Experiment] = {record.EXPERIMENT.name: record.EXPERIMENT for record in _RECORDS}

# The laboratory law with the longest runout for each kind of column; both are monotonic and have no gap. A box spreads
# in more directions than a plane column, so that its runout is not longer.
_LONGEST_RUNOUT = {
    "plane": bougouin_lacaze_2018.EXPERIMENT.laws[0],
    "axisymmetric": lajeunesse_2004.EXPERIMENT.laws[0],
    "box": bougouin_lacaze_2018.EXPERIMENT.laws[0],
}


_OF_THE_PAPER = {"plane": lube_2007.EXPERIMENT, "axisymmetric": lube_2004.EXPERIMENT}  # Coetzee & Purvance 2026
_NO_EXPERIMENT = {
    "box": without_laws("no published collapse of a box"),
    OUTLINE: without_laws("no published collapse of a column that is no rectangle"),
}


def find_experiment(name: str, model: str, section: str = "cylinder") -> Experiment:
    """Experiment of a name; "paper" is that of the paper for the model, or one without laws for a box or an outline.

    Raises:
        UsageError: there is no such experiment, or it is for another kind of column.
    """
    kind = column_kind(model, section)
    if name == "paper":
        return (_OF_THE_PAPER | _NO_EXPERIMENT)[kind]
    experiment = EXPERIMENTS.get(name)
    if experiment is None:
        raise UsageError(f"there is no experiment {name!r}; {suggestion(name, ['paper', *EXPERIMENTS])}")
    if experiment.model != kind:
        raise UsageError(f"experiment {name!r} is for a column of kind {experiment.model!r}; this column is {kind!r}")
    return experiment


def score(
    measured: Any, a: float, model: str, section: str = "cylinder", conditions: Conditions | None = None
) -> list[Score]:
    """Errors against every published law for columns of this kind (see `column_kind`) at aspect ratio a.

    Args:
        measured: a `Measurement`, or a mapping of quantities ("zeta", "beta", "stop_time") to a number or to
            a mapping of front definitions to numbers, or to the mean, min and max of a 3D result.
        a: aspect ratio h_i / r_i.
        model: "plane", "axisymmetric", "quarter" or "full".
        section: horizontal section of a 3D column, "cylinder" or "box"; "outline" of a column that is no rectangle.
        conditions: of the column and its release; without them, they are not compared.

    Laws are not extrapolated: where a law has no value at a, or the conditions do not resemble those of the experiment,
    the score has no error and its comment gives the reason.
    """
    return score_laws(EXPERIMENTS, measured, a, column_kind(model, section), conditions)


def profile_score(profile_x: ArrayLike, profile_y: ArrayLike, experiment: Experiment) -> ProfileScore | None:
    """Compare a deposit profile (m, by increasing x, ending at zero) with the digitised surface of an experiment.

    A surface in metres is compared as it is, so that the column must have its size (`experiment.fits`). A
    dimensionless shape is scaled to the length and height of the deposit. None if the experiment has no surface.
    """
    return score_profile(profile_x, profile_y, experiment)


def profile_scores(
    profile_x: ArrayLike,
    profile_y: ArrayLike,
    model: str,
    r_i: float,
    h_i: float,
    section: str = "cylinder",
    conditions: Conditions | None = None,
) -> list[ProfileScore]:
    """Compare a deposit profile (m) with each digitised surface of the experiments that apply, as in `score`."""
    kind = column_kind(model, section)
    applying = [
        one
        for one in EXPERIMENTS.values()
        if one.model == kind and one.fits(r_i, h_i) and one.applies(h_i / r_i, conditions)
    ]
    once = {one.profiles: one for one in reversed(applying)}  # the same surface for several experiments
    found = [profile_score(profile_x, profile_y, experiment) for experiment in reversed(once.values())]
    return [entry for entry in found if entry is not None]


def expected_runout(model: str, a: float, section: str = "cylinder") -> float:
    """Upper estimate of zeta for sizing the domain, for every a > 0.

    The laboratory law with the longest runout for this kind of column, extrapolated at both ends.
    """
    law = _LONGEST_RUNOUT[column_kind(model, section)]
    return next(piece for piece in reversed(law.pieces) if a >= piece.lo)(a)
