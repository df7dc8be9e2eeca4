"""The wall time of a simulated second at an error of the trajectory: all settings of a closed-loop sweep, and the
cheapest of each kind at each error. For score.py.

A setting is an integrator and its step, a method with its Newton iterations, and for CG preconditioner, tolerance and
guess. Learned settings have a learned guess, or a learned preconditioner with any guess. The reference of a draw is its
simulation with the smallest step. The error of a frame is the root mean square distance of the segments from the
reference, relative to the diagonal of the box around all segments at the start; that of a simulation is its worst
frame. It is infinite for a failed simulation. The time is that of all steps with their
assembly, guesses and solves, over the simulated time. A step that took CLIPPED times the median of its simulation was
interrupted, and counts as that.

Settings are chosen on the draws of one file (tuning) and measured on those of another (test): the fastest of many is
fast also by chance. Where small differences grow, the most exact of many is exact by chance too: CG reaches an error
only if the direct solve with the same integrator, step and Newton iterations reaches it. A model may have others beside
it that differ only in the seed of their training, seeds/NAME-2.h5, ...: then learned settings are measured with each.
"""

import copy
import json
import os
import re
from dataclasses import dataclass, field, replace

import numpy as np

from rodsweep.reading import accuracy, combinations, intervals, job_paths, measures
from rodsweep.reading.errors import KeyNotFound

LEVELS = (1e-1, 1e-2, 1e-3, 1e-4)
ALL, DIRECT, JACOBI, GAUSS_SEIDEL = "cheapest of all", "direct solve", "CG, Jacobi", "Gauss-Seidel"
LEARNED_PRECONDITIONER, OWN = "CG, learned preconditioner", "your guess"
_OF_KIND = {combinations.ZERO: "CG from zero", combinations.CLASSICAL: "CG, classical guess",
            combinations.LEARNED: "CG, learned guess"}
ANSWERS = (ALL, DIRECT, *_OF_KIND.values(), LEARNED_PRECONDITIONER, JACOBI, GAUSS_SEIDEL, OWN)
CLIPPED = 5
REST, SOLVE = "/timing/steps/rest_s", "/timing/steps/solve_s"
STEP, INTEGRATOR = "time.step_s", "time.integrator"


@dataclass(frozen=True)
class Setting:
    way: accuracy.Way
    integrator: str
    step_s: float
    solve: dict = field(default_factory=dict, compare=False)    # its entry in a job
    seeds: dict = field(default_factory=dict, compare=False)    # seeds_in() its job

    def text(self):
        return f"{self.way.text()}, {self.integrator} {1e3 * self.step_s:g} ms"

    def answers(self):
        """The ANSWERS that it may be."""
        way = self.way
        if way.method != "cg":
            return {ALL, {"direct": DIRECT, "xpbd": GAUSS_SEIDEL, "pbd": GAUSS_SEIDEL}.get(way.method, ALL)}
        if combinations.kind_of(way.guess) == combinations.OWN:
            return {OWN}
        if way.preconditioner.startswith("learned"):
            return {ALL, LEARNED_PRECONDITIONER}
        kind = _OF_KIND.get(combinations.kind_of(way.guess))
        return {ALL, kind} | ({JACOBI} if way.preconditioner == "jacobi" else set()) if kind else set()

    def exact(self):
        """The direct solve of the same equations."""
        return replace(self, way=accuracy.Way("direct", self.way.newton))

    def without_seeds(self):
        """With the models that its own, seeds/NAME-2.h5, differ from only in their seed."""
        guess, preconditioner = (re.sub(r"[\w.-]+", lambda name: self.seeds.get(name[0], name[0]), text)
                                 for text in (self.way.guess, self.way.preconditioner))
        return replace(self, way=replace(self.way, guess=guess, preconditioner=preconditioner))


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
    step, method = file.parameter(STEP).values, file.parameter("solve.method").values
    keys = {name: _solve_keys(file.job()["solve"], name) for name in np.unique(method)}
    tasks = np.flatnonzero(file.complete)
    rows, seeds = {}, seeds_in(file.job())
    for draw in np.unique(file.sample[tasks]):
        of = tasks[file.sample[tasks] == draw]
        best = of[np.argmin(step[of])]
        if not file.ok[best]:
            raise KeyNotFound(f"{file.path}: the reference of draw {draw}, task {best}, ended with {file.outcome[best]}")
        exact = accuracy.frames(file, best)
        for task in of[step[of] > step[best]]:
            setting = Setting(accuracy.way_of(file, task), str(file.parameter(INTEGRATOR).values[task]), float(step[task]),
                              _solve_entry(file, task, keys[method[task]]), seeds)
            error = np.inf
            if file.ok[task]:
                error = max(accuracy.distances(accuracy.frames(file, task), exact), default=np.nan)
            rows.setdefault(setting, []).append((draw, error, *_effort(file, task)))
    if not rows:
        raise KeyNotFound(f"{file.path} has nothing to compare: give {STEP} several values, the smallest of the reference")
    return {setting: Runs(*map(np.array, zip(*of))) for setting, of in rows.items()}


def cheapest(found, answer, level):
    """The fastest Setting of {Setting: Runs} that is of this answer and reaches the level; None if there is none."""
    good = [setting for setting in found if answer in setting.answers() and _reaches(setting, found, level)]
    return min(good, key=lambda setting: np.median(found[setting].time_s)) if good else None


def _reaches(setting, found, level):
    exact = found.get(setting.exact()) if setting.way.method == "cg" else None
    return found[setting].reaches(level) and (exact is None or exact.reaches(level))


def chosen(found):
    """{(level, answer): Setting} of {Setting: Runs}. The choice is among models of one training each: the fastest of
    several trainings is fast by chance."""
    found = {setting: of for setting, of in found.items() if setting.without_seeds() == setting}
    best = {(level, answer): cheapest(found, answer, level) for level in LEVELS for answer in ANSWERS}
    return {key: setting for key, setting in best.items() if setting}


def trainings(setting, found):
    """The Runs of a setting in {Setting: Runs}, and those that differ from it in the seeds of their models."""
    return [of for other, of in found.items() if other.without_seeds() == setting]


def factor(all_of, over):
    """Estimate of how many times longer a setting takes than Runs: the median over draws, of several trainings the
    median. The interval contains those of all trainings."""
    found = [_factor(of, over) for of in all_of]
    return replace(found[0], value=np.median([one.value for one in found]), low=min(one.low for one in found),
                   high=max(one.high for one in found))


def _factor(of, over):
    draws, here, there = np.intersect1d(of.draws, over.draws, return_indices=True)
    return intervals.median(measures.quotient(of.time_s[here], over.time_s[there]), draws)


def test_job(job, labels, settings, samples, folder=""):
    """The job that measures settings on other draws than `job` (both parsed), with its reference. `labels` are those of
    its guesses. `folder` is that of `job`: models beside those of the settings are measured too."""
    made = copy.deepcopy(job)
    reference = _reference(job)
    settings = list(dict.fromkeys(settings))
    entries = [_entry(setting) for setting in settings]
    entries = [json.loads(entry) for entry in dict.fromkeys(json.dumps(entry) for entry in entries)]
    entries = [reference, *_with_seeds(entries, folder)]
    for key in ("step_s", "integrator", "newton_iterations"):
        made["time"][key] = {"zip": [entry[key] for entry in entries]}
    made["solve"] = {"zip": [entry["solve"] for entry in entries]}
    if "guesses" in job:
        used = {"zero", *(setting.way.guess for setting in settings)}
        made["guesses"] = _with_seeds([guess for guess, label in zip(job["guesses"], labels) if label in used], folder)
    made.update(name=job["name"].removesuffix("_tuning") + "_test", seed=job["seed"] + 1000, samples=samples,
                description=f"Settings chosen on {job['name']}, on other draws.")
    return made


def seeds_of(path):
    """The models beside one that differ only in their seed."""
    folder, name = os.path.split(path)
    stem = name.removesuffix(".h5")
    found = os.listdir(os.path.join(folder, "seeds")) if os.path.isdir(os.path.join(folder, "seeds")) else []
    return sorted(os.path.join(folder, "seeds", other) for other in found if re.fullmatch(re.escape(stem) + r"-\d+\.h5", other))


def seeds_in(job):
    """{name of a model of the job, seeds/NAME-2.h5: name of the model beside that folder}, both without .h5, if the job
    has both."""
    models = [os.path.splitext(path)[0] for path in job_paths.given(job, ("model",))]
    found = {}
    for path in models:
        folder, name = os.path.split(path)
        base = re.sub(r"-\d+$", "", name)
        if os.path.basename(folder) == "seeds" and os.path.join(os.path.dirname(folder), base) in models:
            found[name] = base
    return found


def _with_seeds(entries, folder):
    """Each entry, with copies that have the other seeds of its model."""
    made = []
    for entry in entries:
        beside = [other for model in job_paths.given(entry, ("model",)) for other in seeds_of(os.path.join(folder, model))]
        made += [entry, *(job_paths.placed(entry, lambda _, other=other: os.path.relpath(other, folder or "."), ("model",))
                          for other in beside)]
    return made


def _reference(job):
    """The first entry of the zips of a tuning job, which is its reference."""
    time = job["time"]
    return {**{key: time[key]["zip"][0] for key in ("step_s", "integrator", "newton_iterations")},
            "solve": job["solve"]["zip"][0]}


def _entry(setting):
    return {"step_s": setting.step_s, "integrator": setting.integrator, "newton_iterations": setting.way.newton or 1,
            "solve": setting.solve}


def _solve_keys(solve, method):
    """The keys of a job's entries of `solve` with this method: a dict by key, of dicts for objects."""
    found = {}
    for entry in solve["zip"]:
        if method in (None, entry.get("method", "cg")):
            for key, value in entry.items():
                nested = isinstance(value, dict) and not set(value) & {"grid", "zip"}
                found[key] = {**found.get(key, {}), **_solve_keys({"zip": [value]}, None)} if nested else {}
    return found


def _solve_entry(file, task, keys, path="solve"):
    """The values of these keys that apply to a task."""
    made = {}
    for key, nested in keys.items():
        value = _solve_entry(file, task, nested, f"{path}.{key}") if nested else _value(file, task, f"{path}.{key}")
        if value not in (None, {}):
            made[key] = value
    return made


def _value(file, task, key):
    parameter = file.parameters.get(key)
    return parameter.values[task].item() if parameter and parameter.applies()[task] else None


def _effort(file, task):
    """(wall seconds, products) per simulated second."""
    seconds = file.rows(REST, task).astype(float) + file.rows(SOLVE, task)
    seconds = seconds[np.isfinite(seconds)]
    if not len(seconds):
        return np.nan, np.nan
    simulated = len(seconds) * float(file.parameter(STEP).values[task])
    products = file.rows("/steps/products", task)[:len(seconds)]
    return np.minimum(seconds, CLIPPED * np.median(seconds)).sum() / simulated, products.sum() / simulated
