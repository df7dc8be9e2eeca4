"""The statistics of the score: bounds of medians, and paired comparisons with intervals and tests.

A bound of a median is an order statistic: of n independent values, x_(k) is at least the median with the probability
that fewer than k of them are below it, P(Bin(n, 1/2) < k). A comparison is that of the logarithms of times on the same
draws. Draws, repetitions and trainings are resampled, each independently of the others, so that an interval has the
randomness of all three. Tests of several kinds are corrected by Holm's method.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

BOUND = 0.9
MOST_FAILED = 0.05
RESAMPLES = 4000
EQUAL_WITHIN = 0.05
LEVEL = 0.95


def upper_bound(values):
    """Of the median, at the level BOUND; infinite if there are too few values (fewer than four)."""
    n = len(values)
    at = int(np.searchsorted(stats.binom.cdf(np.arange(n), n, 0.5), BOUND - 1e-12))
    return np.sort(values)[at] if at < n else np.inf


def lower_bound(values):
    """The same from below; of too few values the smallest."""
    return max(-upper_bound(-np.asarray(values)), np.min(values))


def admitted(errors, level):
    """Whether a setting with these errors, one of each draw, counts: the same rule for every kind."""
    return bool(upper_bound(errors) <= level and _few_failed(errors))


def kept(errors, level):
    """Whether a setting that was admitted keeps to the error on other draws."""
    return bool(np.median(errors) <= level and _few_failed(errors))


def _few_failed(errors):
    return np.count_nonzero(~np.isfinite(errors)) <= MOST_FAILED * len(errors)


def may_pass(errors, level):
    """Whether a few draws leave it open that more of them would admit the setting."""
    failed = np.count_nonzero(~np.isfinite(errors))
    return bool(lower_bound(errors) <= level and stats.binom.sf(failed - 1, len(errors), MOST_FAILED) > 1 - BOUND)


@dataclass(frozen=True)
class Factor:
    """How many times as long one setting takes as another: geometric mean over draws, with its 95 % interval and the
    probability of one as large if both were alike."""
    value: float
    low: float
    high: float
    p: float

    def equal(self):
        return 1 - EQUAL_WITHIN <= self.low and self.high <= 1 + EQUAL_WITHIN


def factor(times, others):
    """Of two arrays [training, repetition, draw], with the same repetitions and draws."""
    apart = [np.log(of) for of in (times, others)]
    generator = np.random.Generator(np.random.PCG64(20211))

    def weights(count):
        return generator.multinomial(count, np.full(count, 1 / count), size=RESAMPLES) / count

    repetition, draw = (weights(count) for count in times.shape[1:])
    of, by = (np.einsum("kt,kr,trk->k", weights(len(of)), repetition, of @ draw.T) for of in apart)
    found = of - by
    low, high = np.quantile(found, [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    p = min(1.0, 2 * max(1, min(np.count_nonzero(found <= 0), np.count_nonzero(found >= 0))) / RESAMPLES)
    return Factor(*np.exp([apart[0].mean() - apart[1].mean(), low, high]), p)


def holm(probabilities):
    """{key: probability} corrected for their number."""
    ordered, least, made = sorted(probabilities, key=probabilities.get), 0, {}
    for rank, key in enumerate(ordered):
        least = max(least, min(1.0, (len(ordered) - rank) * probabilities[key]))
        made[key] = least
    return made
