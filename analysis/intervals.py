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
BLOCK_BYTES = 16 << 20


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


def ratio_of_sums(numerator, denominator, draws=None, level=LEVEL, resamples=RESAMPLES):
    """Sum over the first axis of one over that of the other; a simulation counts where both are finite."""
    numerator, denominator = np.asarray(numerator, dtype=float), np.asarray(denominator, dtype=float)
    both = np.isfinite(numerator) & np.isfinite(denominator)
    parts = np.stack([np.where(both, part, np.nan) for part in (numerator, denominator)], axis=-1)
    return _estimate(parts, draws, level, resamples, _weighted_ratios, parts=2)


def _estimate(values, draws, level, resamples, statistic, parts=1):
    """`parts` numbers of the last axis make one value of the statistic. Columns and resamples come in blocks."""
    values = np.asarray(values, dtype=float)
    if parts == 1:
        values = values[..., None]
    shape = values.shape[1:-1]
    if not len(values):
        empty = np.full(shape, np.nan)
        return Estimate(empty, empty, empty, np.zeros(shape, dtype=int))
    values = values.reshape(len(values), -1, parts)
    draws = np.arange(len(values)) if draws is None else np.unique(np.asarray(draws), return_inverse=True)[1]
    groups, columns = int(draws.max()) + 1, values.shape[1]
    finite = np.isfinite(values).all(axis=2)
    count = finite.sum(axis=0)
    drawn = np.array([len(np.unique(draws[finite[:, k]])) for k in range(columns)])
    value = np.concatenate([np.empty(0), *(statistic(values[:, k], finite[:, k], np.ones((1, len(values))))
                                           for k in range(columns))])
    low, high = np.full(columns, np.nan), np.full(columns, np.nan)
    uncertain = np.flatnonzero(drawn > 1)
    for block in np.array_split(uncertain, max(1, -(-len(uncertain) * resamples * 8 // BLOCK_BYTES))):
        resampled = np.empty((resamples, len(block)))
        generator = np.random.Generator(np.random.PCG64(20210))
        at_once = max(1, BLOCK_BYTES // (16 * len(values)))
        for begin in range(0, resamples if len(block) else 0, at_once):
            size = min(at_once, resamples - begin)
            weights = generator.multinomial(groups, np.full(groups, 1 / groups), size=size)[:, draws].astype(float)
            for to, k in enumerate(block):
                resampled[begin:begin + size, to] = statistic(values[:, k], finite[:, k], weights)
        for to, k in enumerate(block):
            n = drawn[k]
            tail = special.ndtr(-np.sqrt(n / (n - 1)) * special.stdtrit(n - 1, (1 + level) / 2))
            low[k], high[k] = np.nanquantile(resampled[:, to], [tail, 1 - tail])
    return Estimate(*(part.reshape(shape) for part in (value, low, high, count)))


def _weighted_means(values, finite, weights):
    return _weighted_ratios(np.stack([values[:, 0], np.ones(len(values))], axis=1), finite, weights)


def _weighted_ratios(values, finite, weights):
    sums = weights @ np.where(finite[:, None], values, 0)
    return np.divide(sums[:, 0], sums[:, 1], out=np.full(len(weights), np.nan), where=sums[:, 1] > 0)


def _weighted_medians(values, finite, weights):
    """Median of each resample: the mean of the lower and the upper one, as for an even count."""
    column, weights = values[finite, 0], weights[:, finite]
    if not len(column):
        return np.full(len(weights), np.nan)
    order = np.argsort(column, kind="stable")
    column, cumulative = column[order], np.cumsum(weights[:, order], axis=1)
    half = cumulative[:, -1:] / 2
    lower, upper = np.argmax(cumulative >= half, axis=1), np.argmax(cumulative > half, axis=1)
    return np.where(half[:, 0] > 0, (column[lower] + column[upper]) / 2, np.nan)
