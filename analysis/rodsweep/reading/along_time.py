"""CG iterations along the simulated time, summed over windows of steps: the numbers of temporal.py.

Steps go into at most MOST_BINS bins (fewer if many simulations would exceed BUDGET_BYTES). A window is a range of
whole bins around its centre, cut off at the ends of the run. A solve that missed a tolerance counts the iterations
that it used, as in the CG ratio of a simulation. A row does not have that number: the mean over all such solves of its
simulation is counted instead. Sums over a whole run are exact.
"""

from dataclasses import dataclass

import numpy as np

MOST_BINS = 400
FEWEST_BINS = 10
MOST_WINDOWS = 160
BUDGET_BYTES = 64 << 20
COLUMNS = ("/solves/newton", "/solves/step", "/solves/iterations")


@dataclass(frozen=True)
class Windows:
    """Sums over windows; NaN if a simulation has no task with the guess."""
    centre: np.ndarray      # [window] mean step of the window, counted from 1
    width: int              # steps of a whole window
    iterations: np.ndarray  # [simulation, window, guess, tolerance]
    solves: np.ndarray      # [simulation, window, guess]
    unreached: np.ndarray   # [window, guess, tolerance] solves that missed the tolerance


def recorded(file):
    return all(file.has(path) for path in COLUMNS)


def windows(file, sims, newton, guesses, tolerances, width=None):
    """Windows of `width` steps, by default a twentieth of the run; guesses and tolerances are indices."""
    steps = int(file.steps[sims.tasks()].max())
    per_bin = len(sims) * len(guesses) * (len(tolerances) + 1) * 8 * 2
    bins = min(steps, MOST_BINS, max(FEWEST_BINS, BUDGET_BYTES // per_bin))
    edges = np.unique(np.round(np.linspace(0, steps, bins + 1)).astype(int))
    iterations, solves, missed = _binned(file, sims, newton, guesses, tolerances, edges)
    iterations += _spent(file, sims, newton, guesses, tolerances, iterations, missed) * missed
    per_bin = steps / (len(edges) - 1)
    half = max(0, int(round(((steps / 20 if width is None else width) / per_bin - 1) / 2)))
    count = min(len(edges) - 1, MOST_WINDOWS)
    middle = np.unique(np.round(np.linspace(0, len(edges) - 2, count)).astype(int))
    begin, end = np.maximum(middle - half, 0), np.minimum(middle + half + 1, len(edges) - 1)
    return Windows((edges[begin] + edges[end] + 1) / 2, int(round((2 * half + 1) * per_bin)),
                   _between(iterations, begin, end), _between(solves, begin, end),
                   np.nansum(_between(missed, begin, end), axis=0))


def _between(values, begin, end):
    """Sums over bins begin … end − 1 along the second axis."""
    sums = np.zeros((values.shape[0], values.shape[1] + 1) + values.shape[2:])
    np.cumsum(values, axis=1, out=sums[:, 1:])
    return sums[:, end] - sums[:, begin]


def _binned(file, sims, newton, guesses, tolerances, edges):
    """Iterations of solves that reached the tolerance, all solves, and solves that missed it: [simulation, bin, guess,
    ...]."""
    shape = (len(sims), len(edges) - 1, len(guesses))
    iterations, missed = np.zeros(shape + (len(tolerances),)), np.zeros(shape + (len(tolerances),))
    solves = np.zeros(shape)
    row = np.full((file.task_count, len(guesses)), -1)
    for k, g in enumerate(guesses):
        there = np.flatnonzero(sims.task[:, g] >= 0)
        row[sims.task[there, g], k] = there
        absent = sims.task[:, g] < 0
        iterations[absent, :, k], missed[absent, :, k], solves[absent, :, k] = np.nan, np.nan, np.nan
    for owners, starts, rows in file.solve_blocks(sims.tasks(), COLUMNS):
        j = rows["/solves/newton"]
        counted = np.flatnonzero(j == 0 if newton == "first" else j >= 0)
        owner = np.repeat(owners, np.diff(np.append(starts, len(j))))[counted]
        at = np.searchsorted(edges, rows["/solves/step"][counted], side="right") - 1
        for k, g in enumerate(guesses):
            mine = row[owner, k] >= 0
            to = (row[owner[mine], k], at[mine], k)
            np.add.at(solves, to, 1)
            for m, t in enumerate(tolerances):
                used = rows["/solves/iterations"][counted[mine], g, t]
                np.add.at(iterations[..., m], to, np.maximum(used, 0))
                np.add.at(missed[..., m], to, used < 0)
    return iterations, solves, missed


def _spent(file, sims, newton, guesses, tolerances, iterations, missed):
    """Mean iterations of a solve that missed the tolerance, [simulation, 1, guess, tolerance]; 0 if none did."""
    sums = file.results("iterations_sum" if newton == "first" else "iterations_sum_all", sims.tasks())
    full = np.zeros((file.task_count, len(file.guesses), len(file.tolerances)))
    if sums is not None:
        full[sims.tasks()] = sums
    total = sims.gather(full)[:, guesses][:, :, tolerances]
    count = missed.sum(axis=1)
    return np.divide(total - iterations.sum(axis=1), count, out=np.zeros(count.shape), where=count > 0)[:, None]
