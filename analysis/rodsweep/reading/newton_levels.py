"""Residual and joint gap before every Newton iteration and at the end of a step: the numbers of newton.py.

Level j is the state before Newton iteration j (rows of /solves). A step with k iterations ends in level k (rows of
/steps). Each simulation and level has the quartiles over all steps, and the largest value. A step that ended early,
below the job's tolerance, keeps its last value in later levels. Otherwise these would show only the hardest steps.
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
    """Quantities that the file has both before the iterations and at the ends of the steps."""
    if not all(file.has(path) for path in ("/solves/newton", "/steps/newton_iterations")):
        return []
    return [name for name in SOLVES if file.has(SOLVES[name]) and file.has(STEPS[name])]


def levels(file, tasks):
    """The Levels of complete tasks, one after the other: the rows of one task have to fit in memory."""
    tasks = np.unique(tasks)
    names = quantities(file)
    most = int(file.parameter("time.newton_iterations").values[tasks].max()) + 1
    values = {name: np.full((len(tasks), most, 4), np.nan) for name in names}
    share = np.zeros((len(tasks), most))
    there = tasks[(file.solves[tasks] > 0) & (file.steps[tasks] > 0)]
    solves, steps = (_by_task(blocks(there, list(paths)), count) for blocks, paths, count in (
        (file.solve_blocks, ["/solves/newton", *(SOLVES[name] for name in names)], file.solves),
        (file.step_blocks, ["/steps/newton_iterations", *(STEPS[name] for name in names)], file.steps)))
    for (task, before), (other, after) in zip(solves, steps, strict=True):
        if task != other:
            raise ValueError(f"rows of tasks {task} and {other} come in different orders")
        row = np.searchsorted(tasks, task)
        ended = after["/steps/newton_iterations"]
        for k in range(most):
            at_level, over = before["/solves/newton"] == k, ended <= k
            reached = at_level.sum() + (ended == k).sum()
            if reached:
                share[row, k] = reached / max(1, len(ended))
            for name in names:
                there = np.concatenate([before[SOLVES[name]][at_level], after[STEPS[name]][over]])
                there = there[np.isfinite(there)]
                if reached and len(there):
                    values[name][row, k] = [*np.quantile(there, QUARTILES), there.max()]
    return Levels(tasks, values, share)


def _by_task(blocks, count):
    """Yields (task, {column: rows}) with all rows of a task, even if it comes in several blocks."""
    waiting = {}
    for owners, starts, rows in blocks:
        ends = np.append(starts[1:], len(next(iter(rows.values()))))
        for task, start, end in zip(owners, starts, ends):
            pieces = waiting.setdefault(int(task), [])
            pieces.append({path: values[start:end] for path, values in rows.items()})
            if sum(len(next(iter(piece.values()))) for piece in pieces) == count[task]:
                del waiting[int(task)]
                yield int(task), {path: np.concatenate([piece[path] for piece in pieces]) for path in rows}


def orders(medians, floor):
    """Observed order of convergence at every level from three successive medians; NaN at or below the floor.

    log(r[j+1] / r[j]) / log(r[j] / r[j-1]): 1 for a fixed factor, 2 if the residual is squared.
    """
    found = np.full(len(medians), np.nan)
    for j in range(1, len(medians) - 1):
        before, now, after = medians[j - 1:j + 2]
        if min(before, now, after) > floor and after < now < before:
            found[j] = np.log(after / now) / np.log(now / before)
    return found
