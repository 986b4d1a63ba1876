"""Statistics of a sample: moments, quantiles, the interval of the median, and probabilities with their intervals.

The intervals hold for independent samples; those of a Latin hypercube are more evenly spread, so that the intervals
are on the safe side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

QUANTILES = {"p5": 0.05, "p25": 0.25, "median": 0.5, "p75": 0.75, "p95": 0.95}
MEDIAN_CONFIDENCE, PASS_CONFIDENCE = 0.90, 0.95
ROUND_OFF = 1e-12  # relative


@dataclass(frozen=True)
class Statistics:
    """Statistics of one quantity.

    quantiles: by the names of QUANTILES. median_interval: at least 90 % confidence; None with fewer than five values.
    """

    count: int
    mean: float
    standard_deviation: float
    quantiles: dict[str, float]
    median_interval: tuple[float, float] | None


@dataclass(frozen=True)
class Probability:
    """Share of a sample that meets a condition, with its Wilson interval of 95 %."""

    count: int
    met: int
    value: float
    lo: float
    hi: float


def statistics_of(values: np.ndarray) -> Statistics:
    """Statistics of at least two values, (n,).

    Quantiles are those of Hyndman & Fan 1996 (doi:10.1080/00031305.1996.10473566), type 8, which are approximately
    median-unbiased for any distribution.
    """
    found = np.quantile(values, list(QUANTILES.values()), method="median_unbiased")
    ranks = median_ranks(len(values), MEDIAN_CONFIDENCE)
    ordered = np.sort(values)
    return Statistics(
        count=len(values),
        mean=float(values.mean()),
        standard_deviation=float(values.std(ddof=1)),
        quantiles=dict(zip(QUANTILES, map(float, found), strict=True)),
        median_interval=None if ranks is None else (float(ordered[ranks[0] - 1]), float(ordered[ranks[1] - 1])),
    )


def differ(values: np.ndarray) -> bool:
    """Whether values differ by more than round-off."""
    return bool(np.ptp(values) > ROUND_OFF * np.abs(values).max())


def median_ranks(count: int, confidence: float) -> tuple[int, int] | None:
    """Ranks r and n + 1 - r of the order statistics between which the median is with at least this confidence.

    The number of values below the median has the binomial distribution with p = 1/2: r is the largest rank with
    P(fewer than r values) <= (1 - confidence) / 2. Ranks are from 1; None if there are too few values.
    """
    from scipy.stats import binom  # here, since it takes long to import

    below = binom.cdf(np.arange(count), count, 0.5)  # probability of at most 0, 1, ... values
    rank = int(np.count_nonzero(below <= 0.5 * (1.0 - confidence)))
    return (rank, count + 1 - rank) if rank else None


def probability_of(met: np.ndarray) -> Probability:
    """Share of true values, (n,), with the score interval of Wilson 1927 (doi:10.1080/01621459.1927.10502953)."""
    from scipy.stats import binomtest  # here, since it takes long to import

    found = int(np.count_nonzero(met))
    interval = binomtest(found, len(met)).proportion_ci(PASS_CONFIDENCE, method="wilson")
    return Probability(len(met), found, found / len(met), float(interval.low), float(interval.high))
