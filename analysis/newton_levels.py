"""Residual and joint gap before every Newton iteration and at the end of a step: the numbers of newton.py.

Level j is the state before Newton iteration j (rows of /solves); a step that used k iterations ends in level k (rows of
/steps). Per simulation and level: the quartiles over the steps that reached it, and the largest. A step that Newton left
early, since it was below the job's tolerance, is in no later level.
"""

from dataclasses import dataclass

import numpy as np

SOLVES = {"newton_residual": "/solves/newton_residual", "joint_gap": "/solves/joint_gap"}
STEPS = {"newton_residual": "/steps/newton_residual", "joint_gap": "/steps/joint_gap"}
QUARTILES = (0.25, 0.5, 0.75)


@dataclass(frozen=True)
class Levels:
    """[task, level, 4]: lower quartile, median, upper quartile, largest; `share` of the steps that reached a level."""
    tasks: np.ndarray
    values: dict
    share: np.ndarray    # [task, level]

    def rows(self, tasks):
        return np.searchsorted(self.tasks, tasks)


def quantities(file):
    """The quantities that the file has, both before the iterations and at the ends of the steps."""
    if not all(file.has(path) for path in ("/solves/newton", "/steps/newton_iterations")):
        return []
    return [name for name in SOLVES if file.has(SOLVES[name]) and file.has(STEPS[name])]


def levels(file, tasks):
    """Of tasks that are complete, one after the other: the rows of one fit in memory."""
    tasks = np.unique(tasks)
    names = quantities(file)
    most = int(file.parameter("time.newton_iterations").values[tasks].max()) + 1
    values = {name: np.full((len(tasks), most, 4), np.nan) for name in names}
    share = np.zeros((len(tasks), most))
    for row, task in enumerate(tasks):
        solves = slice(file.first_solve[task], file.first_solve[task] + file.solves[task])
        steps = slice(file.first_step[task], file.first_step[task] + file.steps[task])
        level = np.concatenate([file.h5["/solves/newton"][solves], file.h5["/steps/newton_iterations"][steps]])
        ends = np.arange(len(level)) >= file.solves[task]
        count = max(1, int(ends.sum()))
        for name in names:
            both = np.concatenate([file.h5[SOLVES[name]][solves], file.h5[STEPS[name]][steps]])
            for k in range(most):
                reached = both[(level == k) & np.isfinite(both)]
                if len(reached):
                    values[name][row, k] = [*np.quantile(reached, QUARTILES), reached.max()]
                    share[row, k] = len(reached) / count
    return Levels(tasks, values, share)


def orders(medians, floor):
    """Observed order of convergence at every level from three successive medians; NaN at or below the floor.

    log(r[j+1] / r[j]) / log(r[j] / r[j-1]): 1 for a fixed factor, 2 where the residual is squared.
    """
    found = np.full(len(medians), np.nan)
    for j in range(1, len(medians) - 1):
        before, now, after = medians[j - 1:j + 2]
        if min(before, now, after) > floor and after < now < before:
            found[j] = np.log(after / now) / np.log(now / before)
    return found
