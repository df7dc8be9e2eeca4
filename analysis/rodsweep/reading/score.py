"""The wall time of a simulated second at an error of the trajectory: all settings of a closed-loop sweep, and the
cheapest of each kind at each error. For score.py.

A setting is an integrator and its step, a method with its Newton iterations, and for CG preconditioner, tolerance and
guess. The reference of a draw is its simulation with the smallest step. The error of a frame is the root mean square
distance of the segments from the reference, relative to the diagonal of the box around all segments at the start; that
of a simulation is its worst frame. It is infinite for a failed simulation. The time is that of all steps with their
assembly, guesses and solves, over the simulated time. A step that took CLIPPED times the median of its simulation was
interrupted, and counts as that.

Settings are chosen on the draws of one file (tuning) and measured on those of another (test): the fastest of many is
fast also by chance.
"""

import copy
import json
from dataclasses import dataclass

import numpy as np

from rodsweep.reading import accuracy, combinations, intervals, measures
from rodsweep.reading.errors import KeyNotFound

LEVELS = (1e-1, 1e-2, 1e-3, 1e-4)
ALL, DIRECT, JACOBI, GAUSS_SEIDEL = "cheapest of all", "direct solve", "CG, Jacobi", "Gauss-Seidel"
_OF_KIND = {combinations.ZERO: "CG from zero", combinations.CLASSICAL: "CG, classical guess",
            combinations.LEARNED: "CG, learned guess"}
ANSWERS = (ALL, DIRECT, *_OF_KIND.values(), JACOBI, GAUSS_SEIDEL)
CLIPPED = 5
REST, SOLVE = "/timing/steps/rest_s", "/timing/steps/solve_s"
STEP, INTEGRATOR = "time.step_s", "time.integrator"


@dataclass(frozen=True)
class Setting:
    way: accuracy.Way
    integrator: str
    step_s: float

    def text(self):
        return f"{self.way.text()}, {self.integrator} {1e3 * self.step_s:g} ms"

    def answers(self):
        """The ANSWERS that it may be."""
        if self.way.method != "cg":
            return {ALL, {"direct": DIRECT, "xpbd": GAUSS_SEIDEL, "pbd": GAUSS_SEIDEL}.get(self.way.method, ALL)}
        kind = _OF_KIND.get(combinations.kind_of(self.way.guess))
        return {ALL, kind} | ({JACOBI} if self.way.preconditioner == "jacobi" else set()) if kind else set()


@dataclass(frozen=True)
class Runs:
    """Simulations of a setting, by draw; times and products per simulated second."""
    draws: np.ndarray
    error: np.ndarray
    time_s: np.ndarray
    products: np.ndarray

    def reaches(self, level):
        return bool(np.isfinite(self.error).all() and np.median(self.error) <= level)


def runs(file):
    """{Setting: Runs} of a file, without the references. Raises KeyNotFound without trajectories, times or reference."""
    if not all(file.has(path) for path in (REST, SOLVE)):
        raise KeyNotFound(f"{file.path} has no times of its steps ({SOLVE})")
    step = file.parameter(STEP).values
    tasks = np.flatnonzero(file.complete)
    rows = {}
    for draw in np.unique(file.sample[tasks]):
        of = tasks[file.sample[tasks] == draw]
        best = of[np.argmin(step[of])]
        if not file.ok[best]:
            raise KeyNotFound(f"{file.path}: the reference of draw {draw}, task {best}, ended with {file.outcome[best]}")
        exact = accuracy.frames(file, best)
        for task in of[step[of] > step[best]]:
            setting = Setting(accuracy.way_of(file, task), str(file.parameter(INTEGRATOR).values[task]), float(step[task]))
            error = distance(accuracy.frames(file, task), exact) if file.ok[task] else np.inf
            rows.setdefault(setting, []).append((draw, error, *_effort(file, task)))
    if not rows:
        raise KeyNotFound(f"{file.path} has nothing to compare: give {STEP} several values, the smallest of the reference")
    return {setting: Runs(*map(np.array, zip(*of))) for setting, of in rows.items()}


def cheapest(found, answer, level):
    """The fastest Setting of {Setting: Runs} that is of this answer and reaches the level; None if there is none."""
    good = [setting for setting, of in found.items() if answer in setting.answers() and of.reaches(level)]
    return min(good, key=lambda setting: np.median(found[setting].time_s)) if good else None


def chosen(found):
    """{(level, answer): Setting} of a tuning file's runs."""
    best = {(level, answer): cheapest(found, answer, level) for level in LEVELS for answer in ANSWERS}
    return {key: setting for key, setting in best.items() if setting}


def factor(of, over):
    """Estimate of the median over draws of how many times longer Runs take than others."""
    draws, here, there = np.intersect1d(of.draws, over.draws, return_indices=True)
    return intervals.median(measures.quotient(of.time_s[here], over.time_s[there]), draws)


def test_job(job, settings, samples):
    """The job that measures settings on other draws than `job` (both parsed), with its reference."""
    made = copy.deepcopy(job)
    reference = _reference(job)
    entries = list(dict.fromkeys(json.dumps(_entry(setting)) for setting in settings))
    entries = [reference, *(json.loads(entry) for entry in entries)]
    for key in ("step_s", "integrator", "newton_iterations"):
        made["time"][key] = {"zip": [entry[key] for entry in entries]}
    made["solve"] = {"zip": [entry["solve"] for entry in entries]}
    made.update(name=job["name"].removesuffix("_tuning") + "_test", seed=job["seed"] + 1000, samples=samples,
                description=f"Settings chosen on {job['name']}, on other draws.")
    return made


def _reference(job):
    """The first entry of the zips of a tuning job, which is its reference."""
    time = job["time"]
    return {**{key: time[key]["zip"][0] for key in ("step_s", "integrator", "newton_iterations")},
            "solve": job["solve"]["zip"][0]}


def _entry(setting):
    way = setting.way
    solve = {"method": way.method}
    if way.method == "cg":
        solve |= {"preconditioner": way.preconditioner, "tolerance": way.tolerance}
    if way.iterations:
        solve |= {"iterations": way.iterations}
    return {"step_s": setting.step_s, "integrator": setting.integrator, "newton_iterations": way.newton or 1,
            "solve": solve}


def distance(path, exact):
    """The error of a trajectory, over the frames after the start that both have; NaN if there are none."""
    apart = [np.sqrt(np.square(path[time] - exact[time]).sum(axis=1).mean()) for time in path if time > 0 and time in exact]
    size = np.linalg.norm(np.ptp(exact[0.0], axis=0))
    return float(measures.quotient(max(apart), size)) if apart else np.nan


def _effort(file, task):
    """(wall seconds, products) per simulated second."""
    rows = slice(file.first_step[task], file.first_step[task] + file.steps[task])
    seconds = file.h5[REST][rows].astype(float) + file.h5[SOLVE][rows]
    seconds = seconds[np.isfinite(seconds)]
    if not len(seconds):
        return np.nan, np.nan
    simulated = len(seconds) * float(file.parameter(STEP).values[task])
    products = file.h5["/steps/products"][rows][:len(seconds)]
    return np.minimum(seconds, CLIPPED * np.median(seconds)).sum() / simulated, products.sum() / simulated
