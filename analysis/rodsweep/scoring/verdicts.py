"""The statistics of the score: bounds of medians, and paired comparisons with intervals and tests.

A bound of a median is an order statistic: of n independent values, x_(k) is at least the median with the probability
that fewer than k of them are below it, P(Bin(n, 1/2) < k). A comparison is that of the logarithms of times on the same
draws. Its variance is the sum of those of draws, repetitions and trainings, each estimated from the means over the
others. The degrees of freedom of Student's distribution are Satterthwaite's (1946, Biometrics Bulletin 2). Tests of
several kinds are corrected by Holm's method.
"""

from dataclasses import dataclass

import numpy as np
from scipy import special, stats

BOUND = 0.9
MOST_FAILED = 0.05
ADMITTED_FAILED = 0.025     # half of it, since other draws may have more
EQUAL_WITHIN = 0.05
LEVEL = 0.95


def upper_bound(values):
    """Of the median, at the level BOUND; infinite if there are too few values (fewer than four)."""
    n = len(values)
    at = int(np.searchsorted(stats.binom.cdf(np.arange(n), n, 0.5), BOUND - 1e-12))
    return np.sort(values)[at] if at < n else np.inf


# Errors of a setting are [training, draw], infinite for a simulation that failed. That of a draw is the median over
# trainings; failures count over all simulations, so that two trainings do not hide those of the third.


def admitted(errors, level):
    """Whether a setting counts: the same rule for every kind."""
    return bool(upper_bound(np.median(errors, axis=0)) <= level and _few_failed(errors, ADMITTED_FAILED))


def kept(errors, level):
    """Whether a setting that was admitted keeps to the error on other draws."""
    return bool(np.median(np.median(errors, axis=0)) <= level and _few_failed(errors, MOST_FAILED))


def _few_failed(errors, most):
    return np.count_nonzero(~np.isfinite(errors)) <= most * np.size(errors)


def may_keep(errors, level):
    """Whether a few draws of one training leave it open that all of them would admit the setting: half of them keep to
    the level, and the failures do not rule out a share of MOST_FAILED, at 10 %."""
    failed = np.count_nonzero(~np.isfinite(errors))
    return bool(2 * np.count_nonzero(errors <= level) >= len(errors) and
                stats.binom.sf(failed - 1, len(errors), MOST_FAILED) > 1 - BOUND)


@dataclass(frozen=True)
class Factor:
    """How many times as long one setting takes as another: geometric mean over draws, with its 95 % interval and the
    probability of one as far from 1 if both took as long."""
    value: float
    low: float
    high: float
    p: float

    def equal(self):
        return 1 - EQUAL_WITHIN <= self.low and self.high <= 1 + EQUAL_WITHIN


def factor(times, others):
    """Of two arrays [training, repetition, draw], with the same repetitions and draws; NaN where a simulation failed. Only
    draws count that all have."""
    of, by = np.log(times), np.log(others)
    draws = np.isfinite(of).all(axis=(0, 1)) & np.isfinite(by).all(axis=(0, 1))
    of, by = of[..., draws], by[..., draws]
    if not draws.any():
        return Factor(*[np.nan] * 3, 1)
    apart = of.mean(axis=0) - by.mean(axis=0)
    mean = apart.mean()
    parts = [part for part in (_variance(apart.mean(axis=0)), _variance(apart.mean(axis=1)),
                               _variance(of.mean(axis=(1, 2))), _variance(by.mean(axis=(1, 2)))) if part[0] > 0]
    variance = sum(part for part, _ in parts)
    if variance == 0:
        return Factor(*np.exp([mean] * 3), float(mean == 0))
    freedom = variance ** 2 / sum(part ** 2 / of_part for part, of_part in parts)
    half = special.stdtrit(freedom, (1 + LEVEL) / 2) * np.sqrt(variance)
    p = 2 * special.stdtr(freedom, -abs(mean) / np.sqrt(variance))
    return Factor(*map(float, np.exp([mean, mean - half, mean + half])), float(p))


def _variance(values):
    """(variance of the mean, degrees of freedom); zero for one value."""
    return (float(np.var(values, ddof=1)) / len(values), len(values) - 1) if len(values) > 1 else (0, 0)


def holm(probabilities):
    """{key: probability} corrected for their number."""
    ordered, least, made = sorted(probabilities, key=probabilities.get), 0, {}
    for rank, key in enumerate(ordered):
        least = max(least, min(1.0, (len(ordered) - rank) * probabilities[key]))
        made[key] = least
    return made
