"""What many figures say together: their middle and spread, and whether a difference is more than noise.

A part's value is the mean over its seeds; whatever is said of a contender is said of its parts' values, so
that a part counts once however often it was fitted.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64
from scipy.stats import rankdata

from weingarten.bench.metric import Metric
from weingarten.bench.results import Result
from weingarten.scan.sampling import generator

RESAMPLES = 10_000
PERCENTILES = (2.5, 97.5)
SEED = 0

Values = Float64[np.ndarray, " n"]


@dataclass(frozen=True)
class Summary:
    """Of a contender's parts. deviation: standard deviation between parts, None of a single one.

    seeds: standard deviation between seeds of the mean over the parts that have every seed; None of a single
    one. worst: by the metric. parts: how many have a value.
    """

    mean: float
    deviation: float | None
    median: float
    worst: float
    seeds: float | None
    parts: int


@dataclass(frozen=True)
class Difference:
    """A contender against another on the same parts and seeds: mean of the differences of the parts' values.

    low, high: the 95 % interval of that mean by the bootstrap (Efron 1979), parts resampled with replacement
    10,000 times, percentiles 2.5 and 97.5. better, worse: parts on which it is so.
    """

    mean: float
    low: float
    high: float
    better: int
    worse: int
    parts: int

    @property
    def clear(self) -> bool:
        """Whether the interval leaves out zero: less likely to be noise."""
        return self.low > 0 or self.high < 0


Figures = dict[str, dict[int, float]]
"""part → seed → value"""


def figures_of(found: Sequence[Result], contender: str, key: str) -> Figures:
    """A contender's values of one metric, where they exist."""
    figures: Figures = {}
    for one in found:
        value = one.number(key)
        if one.contender == contender and value is not None:
            figures.setdefault(one.part, {})[one.seed] = value
    return figures


def part_values(figures: Figures) -> Values:
    """A part's value is the mean over its seeds."""
    return np.array([np.mean(list(own.values())) for own in figures.values()], dtype=np.float64)


def summary(figures: Figures, metric: Metric) -> Summary | None:
    """None where there is no value."""
    if not figures:
        return None
    values = part_values(figures)
    return Summary(
        mean=float(values.mean()),
        deviation=float(values.std(ddof=1)) if len(values) > 1 else None,
        median=float(np.median(values)),
        worst=float(max(values, key=metric.loss)),
        seeds=between_seeds(figures),
        parts=len(values),
    )


def between_seeds(figures: Figures) -> float | None:
    """Standard deviation over the seeds of the mean over the parts that have all of them."""
    seeds = sorted({seed for own in figures.values() for seed in own})
    whole = [own for own in figures.values() if len(own) == len(seeds)]
    if len(seeds) < 2 or not whole:
        return None
    return float(np.std([np.mean([own[seed] for own in whole]) for seed in seeds], ddof=1))


def difference(figures: Figures, baseline: Figures, metric: Metric) -> Difference | None:
    """How a contender differs from another; None without a part and seed that both have."""
    values, losses = [], []
    for part in sorted(figures.keys() & baseline.keys()):
        seeds = sorted(figures[part].keys() & baseline[part].keys())
        if seeds:
            mine = np.mean([figures[part][seed] for seed in seeds])
            its = np.mean([baseline[part][seed] for seed in seeds])
            values.append(float(mine - its))
            losses.append(metric.loss(float(mine)) - metric.loss(float(its)))
    if not values:
        return None
    low, high = interval(np.array(values))
    better, worse = sum(loss < 0 for loss in losses), sum(loss > 0 for loss in losses)
    return Difference(float(np.mean(values)), low, high, better, worse, len(values))


@dataclass(frozen=True)
class Correlation:
    """Spearman's rank correlation of two quantities of the parts, and its 95 % interval by the bootstrap.

    ρ = corr(rank x, rank y): 1 where one always grows with the other, 0 where neither tells of the other.
    """

    value: float
    low: float
    high: float


def correlation(first: Values, second: Values) -> Correlation | None:
    """None of fewer than 4 parts, or where one of the quantities is the same for all."""
    if len(first) < 4 or np.ptp(first) == 0 or np.ptp(second) == 0:
        return None
    pair = np.stack([first, second])
    values = _rank_correlations(pair[:, resampled(len(first))])
    low, high = np.nanpercentile(values, PERCENTILES)
    return Correlation(float(_rank_correlations(pair)), float(low), float(high))


def _rank_correlations(pairs: Float64[np.ndarray, "2 *many n"]) -> Float64[np.ndarray, "*many"]:
    """Of the last axis; NaN where a quantity is the same throughout, as in a resample of one part alone."""
    ranks = rankdata(pairs, axis=-1)
    centred = ranks - ranks.mean(axis=-1, keepdims=True)
    spread = np.sqrt((centred**2).sum(axis=-1)).prod(axis=0)
    return np.divide(
        centred.prod(axis=0).sum(axis=-1), spread, out=np.full_like(spread, np.nan), where=spread > 0
    )


def interval(values: Values) -> tuple[float, float]:
    """The bootstrap's interval of the mean of independent values."""
    low, high = np.percentile(values[resampled(len(values))].mean(axis=1), PERCENTILES)
    return float(low), float(high)


def resampled(count: int) -> Int64[np.ndarray, "resamples count"]:
    """Which parts each of the resamples consists of."""
    return generator(SEED).integers(count, size=(RESAMPLES, count))
