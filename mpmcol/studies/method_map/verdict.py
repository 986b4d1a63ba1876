"""The rule of the map: when a run stands, when it degrades, when it has failed.

A run *fails* that did not end well: the solver stopped it, or its process broke. It *degrades* by a sign that is above
its limit, and *stands* otherwise. The signs are

* `zeta`, `beta`: error of runout (front_height) and height, relative to the mean of the scene's own method on a finer
  grid; `profile`: the area between the deposit and that of the finer grid, over its area;
* `ahead`: how far the farthest point is ahead of the front, over the front: grains that were shot off;
* `volume`: how far the volume ratio J has been from 1 anywhere, at any time;
* `slowing`: the share by which the time step has shrunk.

The limit of a sign comes from the scene's own method (the case as it is, at the map's spacing), in some runs whose time
steps are a little apart: half as much again as their mean, and 4 of their standard deviations, widened for one further
run. It is never less than a floor: what experiments scatter by (a tenth in runout, a twentieth in height and shape), or
what no run that is well does. So a choice degrades if it adds more than half of the error that the grid makes anyway,
and no run degrades by scatter alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from mpmcol.errors import OutputError
from mpmcol.io.run_status import read_status
from mpmcol.measure import Array, Measurement
from mpmcol.measure.profile_distance import area_between, mean_height, stations
from mpmcol.studies.method_map.grid_points import Place
from mpmcol.studies.runs import Finished
from mpmcol.sweep.engine import Outcome

SHARE = 1.5  # of the mean of the own method
MULTIPLE = 4.0  # of its standard deviation
FLOORS = {"zeta": 0.1, "beta": 0.05, "profile": 0.05, "ahead": 0.25, "volume": 0.1, "slowing": 0.25}

Name = Literal["stands", "degrades", "fails", "open"]  # open: not run yet


class Seen(NamedTuple):
    """What the rule looks at in a run that has ended well."""

    deposit: Measurement
    volume: float  # largest |J - 1|
    slowing: float  # 1 - least over largest time step


@dataclass(frozen=True)
class Reference:
    """What runs of a scene are measured and judged by."""

    zeta: float
    beta: float
    x: Array  # m
    height: Array  # m, at x
    limits: Mapping[str, float]  # by sign
    means: Mapping[str, float]  # of the scene's own method, by sign
    deviations: Mapping[str, float]
    runs: int  # of the scene's own method


@dataclass(frozen=True)
class Verdict:
    """How a run did: its signs, and those above their limits, the worst first."""

    name: Name
    signs: Mapping[str, float]
    beyond: Sequence[str] = ()
    cause: str = ""  # why it failed


@dataclass(frozen=True)
class Judged:
    """A place of the map, its run if there is one, and the verdict."""

    place: Place
    outcome: Outcome | None
    run: Finished | None
    verdict: Verdict

    @property
    def is_gap(self) -> bool:
        """Whether what a case does by default does not stand here."""
        return self.place.is_default and self.verdict.name in ("degrades", "fails")


def look(run: Finished) -> Seen:
    """Read what the rule needs of a run."""
    results = run.results
    low, high = results.summary["worst_J"]
    dt = results.history["dt"]
    return Seen(results.measure(-1), max(high - 1.0, 1.0 - low), 1.0 - float(dt.min() / dt.max()))


def make_reference(scene: str, own: Sequence[Finished], finer: Sequence[Finished], runs: Path) -> Reference:
    """What a scene's runs are judged by; OutputError if less than two at its spacing or no finer one ended well."""
    if len(own) < 2 or not finer:
        raise OutputError(
            f"scene {scene}: {len(own)} runs of its own method and {len(finer)} finer ones ended well, expected at "
            f"least 2 and 1, since all others are judged by them; mpmcol status {runs} says why"
        )
    return reference_of([look(run) for run in own], [run.results.measure(-1) for run in finer])


def reference_of(own: Sequence[Seen], finer: Sequence[Measurement]) -> Reference:
    """Means of the finer deposits, and limits from the signs of the scene's own method against them."""
    x = stations([*finer, *(seen.deposit for seen in own)])
    zeta, beta = (float(np.mean(values)) for values in zip(*map(_scalars, finer), strict=True))
    bare = Reference(zeta, beta, x, mean_height(finer, x), {}, {}, {}, len(own))
    found = [signs_of(seen, bare) for seen in own]
    means = {sign: float(np.mean([one[sign] for one in found])) for sign in FLOORS}
    deviations = {sign: float(np.std([one[sign] for one in found], ddof=1)) for sign in FLOORS}
    width = MULTIPLE * sqrt(1.0 + 1.0 / len(own))
    limits = {sign: max(SHARE * means[sign] + width * deviations[sign], floor) for sign, floor in FLOORS.items()}
    return Reference(zeta, beta, x, bare.height, limits, means, deviations, len(own))


def signs_of(seen: Seen, reference: Reference) -> dict[str, float]:
    """The signs of a run, the larger the worse."""
    deposit = seen.deposit
    zeta, beta = _scalars(deposit)
    return {
        "zeta": abs(zeta / reference.zeta - 1.0),
        "beta": abs(beta / reference.beta - 1.0),
        "profile": area_between(mean_height([deposit], reference.x), reference.height),
        "ahead": deposit.front["front_max"] / deposit.front["front_height"] - 1.0,
        "volume": seen.volume,
        "slowing": seen.slowing,
    }


def weigh(signs: Mapping[str, float], limits: Mapping[str, float]) -> Verdict:
    """The verdict on a run that ended well; a sign that is no number is beyond every limit."""
    beyond = [sign for sign, limit in limits.items() if not signs[sign] <= limit]
    beyond.sort(key=lambda sign: signs[sign] / limits[sign], reverse=True)
    return Verdict("degrades" if beyond else "stands", signs, beyond)


def judge(place: Place, outcome: Outcome | None, run: Finished | None, reference: Reference) -> Judged:
    """Judge a place by its run, which is missing if it did not end well, and by its outcome if it has ended at all."""
    if run is not None:
        verdict = weigh(signs_of(look(run), reference), reference.limits)
    elif outcome is not None:
        verdict = Verdict("fails", {}, (), _cause(outcome))
    else:
        verdict = Verdict("open", {})
    return Judged(place, outcome, run, verdict)


def _cause(outcome: Outcome) -> str:
    """The cause that the run itself names, or how it ended."""
    result = read_status(outcome.run.folder).result or {}
    return str(result.get("failure", {}).get("cause") or outcome.result.message)


def _scalars(deposit: Measurement) -> tuple[float, float]:
    return deposit.zeta["front_height"], deposit.beta
