"""How far every way of moving the rods ends from a converged trajectory, and what its steps cost: for solvers.py.

A way is a method with its effort: Newton iterations of the direct solve, the tolerance of CG, Gauss-Seidel iterations.
The reference of a simulation is the direct solve with the most Newton iterations, of the same scene, draw and step.
Error: the distance of a segment from where the reference has it, root mean square over segments, the largest over the
frames of the trajectory, relative to the rod's length; NaN where a simulation has no reference. Cost: wall time of a
step with its assembly, guess and solves, the median over steps.
"""

from dataclasses import dataclass

import numpy as np

from reading import measures
from reading.errors import KeyNotFound

REST, ASSEMBLY, DIRECT, GUESS, CG = ("/timing/steps/rest_s", *(f"/timing/solves/{part}_s" for part in
                                                               ("assemble", "direct", "guess", "cg")))
NEWTON = "time.newton_iterations"


@dataclass(frozen=True)
class Accuracy:
    """A row per task."""
    tasks: np.ndarray
    family: np.ndarray     # "direct", "CG from zero", "xpbd", …
    effort: np.ndarray     # iterations, or CG's tolerance
    reference: np.ndarray  # is it one?
    error: np.ndarray
    step_s: np.ndarray


def accuracy(file, tasks):
    """Of tasks that are complete. Raises KeyNotFound where the file has no trajectories, times or reference."""
    if not file.has("/trajectories/position_m"):
        raise KeyNotFound(f"{file.path} has no trajectories: ask for them with record.trajectory_every")
    if not all(file.has(path) for path in (REST, ASSEMBLY, DIRECT)):
        raise KeyNotFound(f"{file.path} has no times of single solves (record.solves is \"summary\")")
    family, effort = zip(*(_way(file, task) for task in tasks))
    family, effort = np.array(family), np.array(effort, dtype=float)
    reference = _references(file, tasks, family)
    error = np.full(len(tasks), np.nan)
    for of in np.unique(reference[reference >= 0]):
        exact = _positions(file, tasks[of])
        for k in np.flatnonzero(reference == of):
            error[k] = _error(file, tasks[k], exact)
    own = reference == np.arange(len(tasks))
    return Accuracy(tasks, family, effort, own, error, np.array([_step_s(file, task) for task in tasks]))


def _way(file, task):
    """(family, effort)"""
    method = file.parameters["solve.method"].values[task]
    if method == "cg":
        return f"CG from {file.guesses[file.own_guess[task]]}", file.parameters["solve.tolerance"].values[task]
    if method in ("xpbd", "pbd"):
        return method, file.parameters["solve.iterations"].values[task]
    return measures.without_guess(file, [task])[0], file.parameters[NEWTON].values[task]


def _references(file, tasks, family):
    """The row of the reference among `tasks` for each of them, -1 where there is none."""
    keys = [p.codes()[tasks] for p in file.parameters.values()
            if p.name.startswith(("scene.", "time.")) and p.name != NEWTON]
    rod = np.unique(np.column_stack([file.sample[tasks], *keys]), axis=0, return_inverse=True)[1].ravel()
    newton = file.parameters[NEWTON].values[tasks]
    found = np.full(len(tasks), -1)
    for group in range(rod.max() + 1):
        rows = np.flatnonzero(rod == group)
        direct = rows[family[rows] == "direct"]
        if len(direct):
            found[rows] = direct[np.argmax(newton[direct])]
    return found


def _positions(file, task):
    """[frame, segment, 3]"""
    first = file.h5["/trajectories/first_row"][task]
    first = first[first >= 0]
    if len(first) < 2:
        raise KeyNotFound(f"task {task} has fewer than two frames: make record.trajectory_every smaller")
    count = first[1] - first[0]
    return file.h5["/trajectories/position_m"][first[0]:first[-1] + count].reshape(len(first), count, 3)


def _error(file, task, exact):
    apart = np.sqrt((np.square(_positions(file, task) - exact).sum(axis=2)).mean(axis=1)).max()
    return apart / np.linalg.norm(np.diff(exact[0], axis=0), axis=1).sum()


def _step_s(file, task):
    """Median over steps; a task at a time, whose rows are those of its steps one after the other."""
    def rows(path, first, count):
        return file.h5[path][first[task]:first[task] + count[task]].astype(float)

    def solves(path, column=None):
        found = rows(path, file.first_solve, file.solves)
        found = found if column is None else found[:, column]
        return np.nan_to_num(found).reshape(file.steps[task], -1).sum(axis=1)

    own = file.own_guess[task]
    solved = solves(DIRECT) if own < 0 else solves(GUESS, own) + solves(CG, own)
    return np.median(rows(REST, file.first_step, file.steps) + solves(ASSEMBLY) + solved)
