"""Errors of all ways of moving the rods, relative to a converged trajectory, and the cost of their steps: for
solvers.py and work_precision.py.

A way is a method with its effort: Newton iterations of the direct solve; for CG also tolerance, preconditioner and
guess; for xpbd and pbd their iterations. The reference of a simulation is the direct solve with the most Newton
iterations, of the same scene, draw and step. The error of a frame is the root mean square distance of the segments
from the reference, relative to the diagonal of the box around all segments at the start (for a straight rod, its
length). The error of a way is that of its worst frame. It is NaN without a reference, and infinite for a failed
simulation. The cost is the median wall time of a step with its assembly, guess and solves.
"""

from dataclasses import dataclass

import numpy as np

from rodsweep.reading import combinations, intervals, measures, texts
from rodsweep.reading.errors import KeyNotFound

REST, ASSEMBLY, DIRECT, GUESS, CG = ("/timing/steps/rest_s", *(f"/timing/solves/{part}_s" for part in
                                                               ("assemble", "direct", "guess", "cg")))
NEWTON = "time.newton_iterations"
FLOOR = 1e-12    # errors up to this are rounding errors
REFERENCE = ("Reference: converged Newton iterations with direct solves at the same step. xpbd converges to another "
             "trajectory, since its forces act along the positions of its iterations.")


@dataclass(frozen=True)
class Way:
    """Fields that do not apply are empty or 0."""
    method: str               # direct, cg, xpbd, pbd, or a network's method and its model
    newton: int = 0
    iterations: int = 0
    tolerance: float = 0
    preconditioner: str = ""
    guess: str = ""
    forcing: bool = False     # the tolerance holds for the first solves of a step

    @property
    def family(self):
        return f"CG {self.preconditioner} from {self.guess}" if self.method == "cg" else self.method

    @property
    def effort(self):
        """What varies along a line of a figure: iterations, or the tolerance of CG."""
        return self.tolerance or self.iterations or self.newton

    def text(self):
        if self.iterations:
            return f"{self.method} {self.iterations}"
        to = f" to {texts.tolerance_label(self.tolerance)}" if self.tolerance else ""
        to += " with forcing terms" if self.forcing else ""
        return f"{self.family}{to}, Newton {self.newton}"


@dataclass(frozen=True)
class Accuracy:
    """A row per task."""
    tasks: np.ndarray
    ways: list
    reference: np.ndarray  # whether it is one
    error: np.ndarray
    step_s: np.ndarray


@dataclass(frozen=True)
class Point:
    """Medians of a way over simulations."""
    way: Way
    time_us: intervals.Estimate
    error: intervals.Estimate


def accuracy(file, tasks):
    """The Accuracy of complete tasks. Raises KeyNotFound if the file has no trajectories, times or reference."""
    if not all(file.has(path) for path in (REST, ASSEMBLY, DIRECT)):
        raise KeyNotFound(f"{file.path} has no times of single solves (record.solves is \"summary\")")
    ways = [way_of(file, task) for task in tasks]
    ok = file.ok[tasks]
    reference = _references(file, tasks, ok & np.array([way.method == "direct" for way in ways]))
    if (reference < 0).all():
        raise KeyNotFound(f"{file.path} has no task with the direct solve to compare with")
    error, cost_s = np.full(len(tasks), np.nan), np.full(len(tasks), np.nan)
    error[(reference >= 0) & ~ok] = np.inf
    for of in np.unique(reference[reference >= 0]):
        exact = positions(file, tasks[of])
        for k in np.flatnonzero((reference == of) & ok):
            error[k], cost_s[k] = _error(file, tasks[k], exact), step_s(file, tasks[k])
    return Accuracy(tasks, ways, reference == np.arange(len(tasks)), error, cost_s)


def require_points(file, points):
    """Raises KeyNotFound if no way is left to compare with the reference."""
    if not points:
        raise KeyNotFound(f"{file.path} has nothing to compare with its reference, the direct solve with the most Newton "
                          "iterations: no other method ran all chosen simulations without a failure")


def points(file, found, cell):
    """A Point per way among the rows of a mask, without ways that failed in any simulation. Families keep the order of
    the job; in each, the least effort comes first."""
    rows, families = {}, {}
    for row in np.flatnonzero(cell & ~found.reference & ~np.isnan(found.error)):
        way = found.ways[row]
        rows.setdefault(way, []).append(row)
        families.setdefault(way.family, len(families))
    made = []
    for way in sorted(rows, key=lambda way: (families[way.family], -way.tolerance, way.iterations, way.newton)):
        of, draws = rows[way], file.sample[found.tasks[rows[way]]]
        if np.isfinite(found.error[of]).all():
            made.append(Point(way, intervals.median(1e6 * found.step_s[of], draws),
                              intervals.median(np.maximum(found.error[of], FLOOR), draws)))
    return made


def cheapest(points, level):
    """The fastest of the points whose error is at most `level`; None if there is none."""
    good = [point for point in points if point.error.value <= level]
    return min(good, key=lambda point: float(point.time_us.value)) if good else None


def envelope(points, floor):
    """The points that are more accurate than all faster ones, fastest first. Errors up to the floor count as equal."""
    kept, least = [], np.inf
    for point in sorted(points, key=lambda point: (float(point.time_us.value), float(point.error.value))):
        if max(float(point.error.value), floor) < least:
            kept.append(point)
            least = max(float(point.error.value), floor)
    return kept


def way_of(file, task):
    """The Way of a task."""
    def value(key):
        return file.parameter(key).values[task]

    method = value("solve.method")
    if method in ("xpbd", "pbd"):
        return Way(method, iterations=measures.gauss_seidel_iterations(file, task))
    newton = int(value(NEWTON))
    if method == "cg":
        forced = "solve.forcing" in file.parameters and value("solve.forcing") == "eisenstat_walker"
        return Way(method, newton, 0, float(value("solve.tolerance")), combinations.preconditioner_text(file, task),
                   file.guesses[file.own_guess[task]], forced)
    return Way(str(measures.without_guess(file, [task])[0]), newton)


def _references(file, tasks, candidate):
    """For each task, the row of its reference among the candidates; -1 if there is none."""
    keys = [p.codes()[tasks] for p in file.parameters.values()
            if p.name.startswith(("scene.", "time.")) and p.name != NEWTON]
    rod = np.unique(np.column_stack([file.sample[tasks], *keys]), axis=0, return_inverse=True)[1].ravel()
    newton = file.parameter(NEWTON).values[tasks]
    found = np.full(len(tasks), -1)
    for group in range(rod.max() + 1):
        rows = np.flatnonzero(rod == group)
        direct = rows[candidate[rows]]
        if len(direct):
            found[rows] = direct[np.argmax(newton[direct])]
    return found


def positions(file, task):
    """[frame, segment, 3]. Raises KeyNotFound if the file has no trajectories."""
    if not file.has("/trajectories/position_m"):
        raise KeyNotFound(f"{file.path} has no trajectories: set record.trajectory_every in the job")
    first = file.h5["/trajectories/first_row"][task]
    first = first[first >= 0]
    if len(first) < 2:
        raise KeyNotFound(f"task {task} has fewer than two frames: make record.trajectory_every smaller")
    count = first[1] - first[0]
    return file.h5["/trajectories/position_m"][first[0]:first[-1] + count].reshape(len(first), count, 3)


def frames(file, task):
    """{time in ms, rounded: positions [segment, 3]}"""
    found = positions(file, task)
    times = file.h5["/trajectories/time_s"][task][:len(found)]
    return {round(1e3 * time, 3): frame for time, frame in zip(times.tolist(), found)}


def _error(file, task, exact):
    apart = np.sqrt((np.square(positions(file, task) - exact).sum(axis=2)).mean(axis=1)).max()
    return float(measures.quotient(apart, np.linalg.norm(np.ptp(exact[0], axis=0))))


def step_s(file, task):
    """Median wall time of a task's steps. Its rows of solves are in the order of the steps."""
    def rows(path, first, count):
        return file.h5[path][first[task]:first[task] + count[task]].astype(float)

    def solves(path, column=None):
        found = rows(path, file.first_solve, file.solves)
        found = found if column is None else found[:, column]
        return np.nan_to_num(found).reshape(file.steps[task], -1).sum(axis=1)

    own = file.own_guess[task]
    solved = solves(DIRECT) if own < 0 else solves(GUESS, own) + solves(CG, own)
    return np.median(rows(REST, file.first_step, file.steps) + solves(ASSEMBLY) + solved)
