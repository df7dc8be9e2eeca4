"""Bootstrap confidence intervals for means and medians over simulations.

What is resampled is the *draw*: simulations that share a draw of the random parameters (grid points do) stay together,
and a solve is never a unit of its own. One draw gives no interval. The percentile interval is too narrow for few draws,
so its level is raised as Hesterberg (2015, "What teachers should know about the bootstrap", expanded percentile) says:
alpha'/2 = Phi(-sqrt(n/(n-1)) t_{alpha/2, n-1}). No such interval leaves the range of the data: of normal values "95 %"
covers 76, 88, 90, 95 % of the time for n = 3, 4, 5, 8 draws. The generator is seeded: a figure made twice is the same.
"""

from dataclasses import dataclass

import numpy as np
from scipy import special

LEVEL = 0.95
RESAMPLES = 4000


@dataclass(frozen=True)
class Estimate:
    """Arrays of one shape. low and high are NaN without at least two draws; `count` is simulations that contributed."""
    value: np.ndarray
    low: np.ndarray
    high: np.ndarray
    count: np.ndarray

    def __getitem__(self, index):
        return Estimate(self.value[index], self.low[index], self.high[index], self.count[index])


def mean(values, draws=None, level=LEVEL, resamples=RESAMPLES):
    """Mean over the first axis, NaN left out per column; `draws` labels the draw of each simulation."""
    return _estimate(values, draws, level, resamples, _weighted_means)


def median(values, draws=None, level=LEVEL, resamples=RESAMPLES):
    return _estimate(values, draws, level, resamples, _weighted_medians)


def _estimate(values, draws, level, resamples, statistic):
    values = np.asarray(values, dtype=float)
    shape = values.shape[1:]
    if not len(values):
        empty = np.full(shape, np.nan)
        return Estimate(empty, empty, empty, np.zeros(shape, dtype=int))
    values = values.reshape(len(values), -1)
    draws = np.arange(len(values)) if draws is None else np.unique(np.asarray(draws), return_inverse=True)[1]
    groups = int(draws.max()) + 1
    generator = np.random.Generator(np.random.PCG64(20210))
    weights = generator.multinomial(groups, np.full(groups, 1 / groups), size=resamples)[:, draws].astype(float)
    columns = [_column(values[:, k], draws, weights, level, statistic) for k in range(values.shape[1])]
    value, low, high, count = (np.array(part).reshape(shape) for part in zip(*columns))
    return Estimate(value, low, high, count)


def _column(column, draws, weights, level, statistic):
    finite = np.isfinite(column)
    column, count = column[finite], int(finite.sum())
    if not count:
        return np.nan, np.nan, np.nan, 0
    value = statistic(column, np.ones((1, count)))[0]
    groups = len(np.unique(draws[finite]))
    if groups < 2:
        return value, np.nan, np.nan, count
    tail = special.ndtr(-np.sqrt(groups / (groups - 1)) * special.stdtrit(groups - 1, (1 + level) / 2))
    resampled = statistic(column, weights[:, finite])
    low, high = np.nanquantile(resampled, [tail, 1 - tail])
    return value, low, high, count


def _weighted_means(column, weights):
    total = weights.sum(axis=1)
    return np.divide(weights @ column, total, out=np.full(len(weights), np.nan), where=total > 0)


def _weighted_medians(column, weights):
    """Median of each resample: the mean of the lower and the upper one, as for an even count."""
    order = np.argsort(column, kind="stable")
    column, cumulative = column[order], np.cumsum(weights[:, order], axis=1)
    half = cumulative[:, -1:] / 2
    lower, upper = np.argmax(cumulative >= half, axis=1), np.argmax(cumulative > half, axis=1)
    return np.where(half[:, 0] > 0, (column[lower] + column[upper]) / 2, np.nan)
