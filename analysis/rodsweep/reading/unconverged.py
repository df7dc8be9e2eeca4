"""What did not converge in tasks that ended ok: timed solves that missed their tolerance, and steps that ended far from
the Newton tolerance. Sentences for summary.py and the report.

CG has no time in a task where one of a guess's timed solves missed the tolerance: it did other work than the solves of
the others. In a closed loop such a task fails.
"""

import numpy as np

from rodsweep.reading import texts

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


def newton_text(file, tasks, times=LARGE):
    """A sentence on the steps that end with a Newton residual over `times` newton_tolerance; empty if there are none."""
    tolerance = np.maximum(file.values("time.newton_tolerance", np.nan), LEAST_TOLERANCE)
    return _steps_text(file, tasks, "/steps/newton_residual", np.where(_has_newton(file), times * tolerance, np.nan),
                       f"a Newton residual over {f'{times:,} times ' if times > 1 else ''}newton_tolerance",
                       "More newton_iterations or a smaller time step may help.")


def balance_text(file, tasks):
    """The same on steps in balance that end with a momentum residual over momentum_tolerance."""
    balance = _has_newton(file) & (file.values("time.balance", 0) == 1)    # others never balance
    tolerance = file.values("time.momentum_tolerance", np.nan)
    return _steps_text(file, tasks, "/steps/momentum_residual", np.where(balance, tolerance, np.nan),
                       "a momentum residual over momentum_tolerance",
                       "More newton_iterations or a smaller time step may help.")


def _has_newton(file):
    """Of every task, whether its method has Newton iterations."""
    return np.isin(file.values("solve.method", ""), ("cg", "direct"))


def _steps_text(file, tasks, path, most, what, remedy):
    """Names the steps whose value exceeds their task's `most` (NaN: not counted), the tasks with the largest first."""
    if not file.has(path):
        return ""
    steps, over, worst = (np.zeros(file.task_count) for _ in range(3))
    for owners, starts, rows in file.step_blocks(tasks[np.isfinite(most[tasks])], [path]):
        allowed = np.repeat(most[owners], np.diff(np.append(starts, len(rows[path]))))
        for sums, counted in ((steps, np.isfinite(rows[path])), (over, rows[path] > allowed)):
            np.add.at(sums, owners, np.add.reduceat(counted.astype(float), starts))
        np.fmax.at(worst, owners, np.fmax.reduceat(rows[path] / allowed, starts))
    named = tasks[np.argsort(-worst[tasks], kind="stable")][:np.count_nonzero(over[tasks])]
    if not len(named):
        return ""
    shown = ", ".join(_largest(file, path, task) for task in named[:TASKS_SHOWN])
    more = f", and {len(named) - TASKS_SHOWN} more" if len(named) > TASKS_SHOWN else ""
    return (f"{over.sum():,.0f} of {steps.sum():,.0f} steps, in {len(named)} of {len(tasks)} tasks, end with {what}: "
            f"{shown}{more}. {remedy}")


def _largest(file, path, task):
    residual = file.rows(path, task)
    step = int(np.nanargmax(residual))
    return f"task {task} ({texts.short_text(residual[step], 2)} in step {step})"
