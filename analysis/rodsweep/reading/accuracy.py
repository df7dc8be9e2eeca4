"""What a comparison of errors and costs needs of a task: where its segments were, and the time of its steps, which has
assembly, guess and solves. For score.py, balance.py and integrators.py.
"""

import numpy as np

from rodsweep.reading import measures
from rodsweep.reading.errors import KeyNotFound

REST, ASSEMBLY, DIRECT, GUESS, CG = ("/timing/steps/rest_s", *(f"/timing/solves/{part}_s" for part in
                                                               ("assemble", "direct", "guess", "cg")))

KINDS = {("euler", 0): "step of Shao et al.", ("euler", 1): "Euler in balance", ("bdf2", 0): "BDF2",
         ("bdf2", 1): "BDF2 in balance"}    # of steps, by time.integrator and time.balance; the last is the best reference


def kinds(file):
    """The kind of step of every task, a key of KINDS."""
    return [(str(integrator), int(balance)) for integrator, balance in
            zip(file.values("time.integrator", "euler"), file.values("time.balance", 0))]


def frames(file, task):
    """{time in ms, rounded: positions [segment, 3]}. Raises KeyNotFound if the file has no trajectories."""
    if not file.has("/trajectories/position_m"):
        raise KeyNotFound(f"{file.path} has no trajectories: set record.trajectory_every in the job")
    first = file.h5["/trajectories/first_row"][task]
    first = first[first >= 0]
    if len(first) < 2:
        raise KeyNotFound(f"task {task} has fewer than two frames: make record.trajectory_every smaller")
    count = first[1] - first[0]
    found = file.h5["/trajectories/position_m"][first[0]:first[-1] + count].reshape(len(first), count, 3)
    times = file.h5["/trajectories/time_s"][task][:len(found)]
    return {round(1e3 * time, 3): frame for time, frame in zip(times.tolist(), found)}


def distances(path, exact):
    """[frame]: root mean square distance of the segments in two frames(), after the start and as far as both have them,
    relative to the diagonal of the box around all segments at the start."""
    apart = [np.sqrt(np.square(path[time] - exact[time]).sum(axis=1).mean()) for time in path if time > 0 and time in exact]
    return measures.quotient(apart, np.linalg.norm(np.ptp(exact[0.0], axis=0)))


def root_mean_square(distances):
    return np.sqrt(np.square(distances).mean()) if len(distances) else np.nan


def step_s(file, task):
    """Median wall time of a task's steps. Its rows of solves are in the order of the steps."""
    def solves(path, column=None):
        found = file.rows(path, task).astype(float)
        found = found if column is None else found[:, column]
        return np.nan_to_num(found).reshape(file.steps[task], -1).sum(axis=1)

    own = file.own_guess[task]
    solved = solves(DIRECT) if own < 0 else solves(GUESS, own) + solves(CG, own)
    return np.median(file.rows(REST, task).astype(float) + solves(ASSEMBLY) + solved)
