"""Measurements of a sweep per simulation: CG ratios and results of the steps. Times are in timings.py.

A simulation is a parameter point. In a paired sweep one task tries every guess on the same systems. In a closed loop
each guess has its own task, and the tasks of one point belong together. Both give the same arrays, [simulation, guess,
...]. Values are summed over a simulation first; ratios are ratios of sums. Only tasks that ended `ok` count, since a
ratio over half a simulation is not comparable. A Census counts the other tasks, and every script shows it.
"""

import os
from collections import Counter
from dataclasses import dataclass

import numpy as np

from rodsweep.reading import constants

# Which solves count: those of the first Newton iteration of every step, or all.
NEWTON = {"first": "first Newton iteration (j = 0)", "all": "all Newton iterations"}


def quotient(above, below):
    """above / below; NaN where `below` is not positive: nothing was counted or timed there."""
    above, below = np.broadcast_arrays(np.asarray(above, dtype=float), np.asarray(below, dtype=float))
    return np.divide(above, below, out=np.full(below.shape, np.nan), where=below > 0)


@dataclass(frozen=True)
class Simulations:
    """task[s, g]: the task with guess g of simulation s, or -1. Without a guess axis there is only column 0."""
    task: np.ndarray
    any_task: np.ndarray   # a task with the simulation's parameters
    sample: np.ndarray     # its draw of the random parameters
    own: np.ndarray        # whether each guess has its own task (closed loop)

    def __len__(self):
        return len(self.task)

    @property
    def closed_loop(self):
        return bool(self.own.any())

    def subset(self, index):
        return Simulations(self.task[index], self.any_task[index], self.sample[index], self.own[index])

    def tasks(self):
        """All task numbers in it, each once."""
        return np.unique(self.task[self.task >= 0])

    def gather(self, per_task, zero=None):
        """[task, guess, ...] as [simulation, guess, ...], NaN without a task; zero: index of a guess for all
        columns."""
        guesses = np.arange(self.task.shape[1]) if zero is None else np.full(self.task.shape[1], zero)
        task = self.task[:, guesses]
        out = np.asarray(per_task, dtype=float)[np.maximum(task, 0), guesses[None, :]]
        out[task < 0] = np.nan
        return out


@dataclass(frozen=True)
class Census:
    """Number of chosen tasks in each state."""
    total: int
    ok: int
    pending: int
    failed: dict   # outcome: count

    def text(self):
        failures = ", ".join(f"{count} {outcome}" for outcome, count in sorted(self.failed.items()))
        return (f"{self.ok} of {self.total} tasks ok" + (f", failed: {failures}" if failures else ", none failed") +
                (f", {self.pending} pending" if self.pending else ""))


def census(file, chosen):
    outcomes = Counter(file.outcome[chosen & file.complete & ~file.ok].tolist())
    return Census(int(chosen.sum()), int((chosen & file.ok).sum()), int((chosen & ~file.complete).sum()),
                  dict(outcomes))


def failures(file, chosen, most):
    """The first failures of the mask, [(task, outcome, message)], and the number of the others."""
    failed = np.flatnonzero(chosen & file.complete & ~file.ok)
    shown = failed[:most].tolist()
    messages = file.results("message", shown)
    messages = [""] * len(shown) if messages is None else map(str, messages)
    return list(zip(shown, map(str, file.outcome[shown]), messages)), len(failed) - len(shown)


def has_guesses(file):
    """Mask of the tasks that try guesses: only the method cg does."""
    if not file.guesses:
        return np.zeros(file.task_count, dtype=bool)
    method = file.parameters.get("solve.method")
    return np.ones(file.task_count, dtype=bool) if method is None else method.values == "cg"


def without_guess(file, tasks):
    """Method names of tasks without their own guess: "direct", "end_to_end" or "state_network" with the model, "xpbd"
    or "pbd" with the number of iterations."""
    method = file.parameters.get("solve.method")
    if method is None:
        return np.full(len(tasks), "direct")
    return np.array([_method_name(file, method.values[task], task) for task in tasks], dtype=str)


def _method_name(file, method, task):
    if method in ("end_to_end", "state_network"):
        model = file.parameter("solve.model").values[task]
        return f"{method} {os.path.splitext(os.path.basename(model))[0]}"
    if method in ("xpbd", "pbd"):
        return f"{method} {gauss_seidel_iterations(file, task)}"
    return "direct"


def gauss_seidel_iterations(file, task):
    """Iterations of a step of a task with the method xpbd or pbd."""
    parameter = file.parameters.get("solve.iterations")
    given = parameter is not None and parameter.applies()[task]
    return int(parameter.values[task]) if given else constants.GAUSS_SEIDEL_ITERATIONS


def simulations(file, chosen, failed_too=False):
    """Simulations, by point, of the tasks of the mask that ended ok (`failed_too`: of all complete ones)."""
    tasks = np.flatnonzero(chosen & (file.complete if failed_too else file.ok))
    points, row = np.unique(file.point[tasks], return_inverse=True)
    task = np.full((len(points), max(1, len(file.guesses))), -1, dtype=np.int64)
    own = file.own_guess[tasks]
    task[row[own < 0]] = tasks[own < 0, None]
    task[row[own >= 0], own[own >= 0]] = tasks[own >= 0]
    any_task = np.zeros(len(points), dtype=np.int64)
    any_task[row] = tasks
    return Simulations(task, any_task, file.sample[any_task], file.own_guess[any_task] >= 0)


@dataclass(frozen=True)
class Counts:
    """Sums over a simulation, [simulation, guess, tolerance]; unreached counts solves that missed the tolerance."""
    own: np.ndarray
    zero: np.ndarray       # those of the zero guess
    unreached: np.ndarray
    unreached_zero: np.ndarray
    solves: np.ndarray     # [simulation, guess] first Newton iterations; NaN for `all`, which is not stored per task

    @property
    def ratio(self):
        return quotient(self.own, self.zero)

    @property
    def per_solve(self):
        return quotient(self.own, self.solves[..., None])


def cg_counts(file, sims, newton, counted="iterations", norm=""):
    """Counts of `counted` (iterations or matvecs), or of iterations in the `other_norm`; NaN if the file has none."""
    suffix = f"_{norm}" if norm else "" if newton == "first" else "_all"
    shape = (file.task_count, len(file.guesses), len(file.tolerances))
    tasks = sims.tasks()

    def spread(name):
        full = np.full(shape, np.nan)
        values = file.results(name, tasks)
        if values is not None:
            full[tasks] = np.where(values < 0, np.nan, values)
        return full

    iterations, unreached = spread(f"{counted}_sum{suffix}"), spread(f"unreached{suffix}")
    steps = np.full(shape[:2], np.nan)
    done = file.results("steps_done", tasks)
    if newton == "first" and done is not None:
        steps[tasks] = done[:, None]
    return Counts(sims.gather(iterations), sims.gather(iterations, file.zero), sims.gather(unreached),
                  sims.gather(unreached, file.zero), sims.gather(steps))


def solved(file, sims, newton):
    """Mask of the simulations in which a solve took an iteration. Others have no CG ratio: rods at rest, or in free
    fall, need no linear solve."""
    own = cg_counts(file, sims, newton).own.reshape(len(sims), -1)
    return (own > 0).any(axis=1) | ~np.isfinite(own).any(axis=1)


@dataclass(frozen=True)
class OfSteps:
    """A result of the steps: its headings in tables and on pages, what it is, and the title of its chart, if it has
    one."""
    column: str
    title: str
    meaning: str
    chart: str = ""


# By column of /steps. Of a simulation: the mean over its steps for newton_iterations, else the largest magnitude.
OF_STEPS = {
    "newton_iterations": OfSteps(
        "Newton its/step", "Newton iterations a step",
        "How often a step solves its linear systems, mean over the steps of a simulation.",
        "Newton iterations of a step"),
    "newton_residual": OfSteps(
        "Newton residual", "Newton residual",
        "What remains of the joints' equations at the end of a step, max |C + α̃λ|; no unit. A step has converged if it is "
        "below newton_tolerance.",
        "largest Newton residual at the end of a step"),
    "momentum_residual": OfSteps(
        "momentum residual", "momentum residual",
        "The largest missing force on a segment at the end of a step, over the largest force of a joint. Only steps with "
        "time.balance reduce it, to momentum_tolerance."),
    "length_drift": OfSteps(
        "length drift", "length drift",
        "Change of the total length since the start, over that length; 0 is exact for rods that do not stretch.",
        "largest length drift of a simulation, over the length"),
    "joint_gap": OfSteps(
        "joint gap/length", "joint gap / length",
        "The largest distance between the two sides of a joint, over the joint's length; 0 is exact.",
        "largest joint gap, over the length"),
    "penetration": OfSteps(
        "penetration/radius", "penetration / radius", "The deepest overlap of two bodies, over the smaller radius.",
        "deepest penetration, over the radius"),
    "contact_residual": OfSteps(
        "contact residual/radius", "contact residual / radius",
        "The largest correction of a contact that remains after a step, over the smaller radius. Contacts have converged "
        "if it is below contact.tolerance."),
}


def step_figures(file, sims):
    """{name in OF_STEPS: [simulation, guess]}; NaN where it does not apply. A paired sweep has one trajectory for all
    guesses."""
    tasks = sims.tasks()
    wanted = {name: f"/steps/{name}" for name in OF_STEPS if file.has(f"/steps/{name}")}
    largest = {name: np.full(file.task_count, np.nan) for name in OF_STEPS if name != "newton_iterations"}
    newton, steps = np.zeros(file.task_count), np.zeros(file.task_count)
    for owners, starts, rows in file.step_blocks(tasks, list(wanted.values())):
        for name in largest.keys() & wanted.keys():
            np.fmax.at(largest[name], owners, np.fmax.reduceat(np.abs(rows[wanted[name]]), starts))
        if "newton_iterations" in wanted:
            used = rows[wanted["newton_iterations"]].astype(float)
            np.add.at(newton, owners, np.add.reduceat(np.where(used >= 0, used, 0), starts))
            np.add.at(steps, owners, np.add.reduceat((used >= 0).astype(float), starts))
    newton = quotient(newton, steps)

    def spread(values):
        return sims.gather(np.broadcast_to(values[:, None], (file.task_count, sims.task.shape[1])))

    return {"newton_iterations": spread(newton), **{name: spread(values) for name, values in largest.items()}}


def median_of_finite(values):
    """Median of the finite values over the first axis; NaN if there are none."""
    found = np.full(values.shape[1:], np.nan)
    there = np.isfinite(values).any(axis=0)
    found[there] = np.nanmedian(np.where(np.isfinite(values), values, np.nan)[:, there], axis=0)
    return found
