"""What did not converge in tasks that ended ok: timed solves that missed their tolerance, and steps that ended far from
the Newton tolerance. Sentences for summary.py and the report.

CG has no time in a task where one of a guess's timed solves missed the tolerance: it did other work than the solves of
the others. In a closed loop such a task fails.
"""

import numpy as np

from rodsweep.reading import texts

RESIDUAL, NEWTON_TOLERANCE = "/steps/newton_residual", "time.newton_tolerance"
LARGE = 10_000               # a step ends far from the Newton tolerance if its residual is this many times that
LEAST_TOLERANCE = 1e-9       # the default; residuals do not fall much below
TASKS_SHOWN = 5


def solves(file, which):
    """Number of solves that were "timed", or that "missed" the tolerance, by [task, guess]; 0 of tasks that are not ok,
    and in files that are older than these columns."""
    path = f"/timing/tasks/solves_{which}"
    if not file.has(path):
        return np.zeros((file.task_count, len(file.guesses)), dtype=np.int64)
    return np.where(file.ok[:, None], np.maximum(file.h5[path][:], 0), 0)


def missed_text(file, tasks):
    """A sentence on the timed solves of some tasks that missed their tolerance; empty if there are none."""
    timed, missed = solves(file, "timed")[tasks].sum(), solves(file, "missed")[tasks].sum(axis=0)
    if not missed.sum():
        return ""
    named = ", ".join(f"{label} {count}" for label, count in zip(file.guesses, missed) if count)
    return (f"{missed.sum()} of {timed} solves missed the tolerance ({named}). A simulation has no times and speedups "
            "of a guess that missed it.")


def newton_text(file, tasks):
    """A sentence that names the tasks with the largest Newton residuals at the end of a step; empty if none is large.
    """
    over = _over_tolerance(file, tasks)
    large = tasks[np.argsort(-over, kind="stable")][:np.count_nonzero(over > LARGE)]
    if not len(large):
        return ""
    named = ", ".join(_largest_residual(file, task) for task in large[:TASKS_SHOWN])
    more = f", and {len(large) - TASKS_SHOWN} more" if len(large) > TASKS_SHOWN else ""
    return (f"{len(large)} of {len(tasks)} tasks have steps that end with a Newton residual over {LARGE:,} times "
            f"newton_tolerance: {named}{more}. More newton_iterations or a smaller time step may help.")


def _over_tolerance(file, tasks):
    """The largest residual of each task over its tolerance; 0 without Newton iterations."""
    worst = np.zeros(file.task_count)
    if not all(name in file.parameters for name in (NEWTON_TOLERANCE, "solve.method")) or not file.has(RESIDUAL):
        return worst[tasks]
    for owners, starts, rows in file.step_blocks(tasks, [RESIDUAL]):
        np.fmax.at(worst, owners, np.fmax.reduceat(rows[RESIDUAL], starts))
    newton = np.isin(file.parameter("solve.method").values, ("cg", "direct"))
    tolerance = np.maximum(file.parameter(NEWTON_TOLERANCE).values, LEAST_TOLERANCE)
    return np.where(newton, worst / tolerance, 0)[tasks]


def _largest_residual(file, task):
    residual = file.rows(RESIDUAL, task)
    step = int(np.nanargmax(residual))
    return f"task {task} ({texts.short_text(residual[step], 2)} in step {step})"
