"""The sample: a Latin hypercube in the uncertain inputs and in the Courant number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import ceil, log10

import numpy as np

from mpmcol.studies.uncertainty.distributions import Distribution
from mpmcol.studies.uncertainty.inputs import UncertainInput

CFL_RANGE = 0.06  # relative: the Courant numbers of the runs are between 0.94 and 1.0 of that of the case
DIGITS = 6  # of sampled values, so that they are short in names of folders
MOST_DIGITS = 15
SEEDS = 1_000_000  # seeds of realizations are smaller
RESOLUTION = 4  # digits of the deviation that a value has at least


@dataclass(frozen=True)
class Sample:
    """Sampled values as texts for `--set`: of each input and each seed, by key, and of the Courant number."""

    values: dict[str, tuple[str, ...]]
    cfl: tuple[str, ...]
    seeds: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def numbers(self, key: str) -> np.ndarray:
        """The values of an input, (runs,)."""
        return np.array([float(text) for text in self.values[key]])


def draw_sample(
    inputs: Sequence[UncertainInput], cfl: float, count: int, seed: int, seeds: Sequence[str] = ()
) -> Sample:
    """Draw a Latin hypercube: each input and the Courant number have one value in each of `count` equally probable
    intervals (McKay, Beckman & Conover 1979, doi:10.1080/00401706.1979.10489755).

    Collapse is sensitive to round-off (`mpmcol.studies.runs.repeated_cfl`): with a time step of its own, each run has
    the scatter of a single result, which is then part of the sample and independent of the inputs.

    Args:
        cfl: Courant number of the case, the largest that a run gets.
        count: number of runs.
        seed: of the random numbers; equal arguments give equal values.
        seeds: keys of the seeds of random fields, of which all values differ.
    """
    from scipy.stats.qmc import LatinHypercube  # here, since it takes long to import

    shares = LatinHypercube(len(inputs) + 1, rng=np.random.default_rng(seed)).random(count)
    values = {
        one.key: _texts(one.distribution.frozen.ppf(share), _digits(one.distribution))
        for one, share in zip(inputs, shares.T[:-1], strict=True)
    }
    rng = np.random.default_rng((seed, 1))  # another sequence than that of the hypercube
    drawn = {key: tuple(map(str, rng.choice(SEEDS, count, replace=False))) for key in seeds}
    return Sample(values, _texts(cfl * (1.0 - CFL_RANGE * shares[:, -1]), DIGITS), drawn)


def _digits(distribution: Distribution) -> int:
    """Significant digits that resolve the deviation where it is small beside the mean."""
    ratio = abs(distribution.mean) / distribution.standard_deviation
    return min(max(DIGITS, RESOLUTION + ceil(log10(max(ratio, 1.0)))), MOST_DIGITS)


def _texts(values: np.ndarray, digits: int) -> tuple[str, ...]:
    return tuple(f"{value:.{digits}g}" for value in values)
