"""Simulates settings of a scene and keeps what they gave: NAME.jsonl, a line per setting, draws and number of samples. It
begins with that of analysis/results/score, if there is one.

The error of a simulation is the root mean square distance of its segments from the reference, over the diagonal of the
box around all segments at the start, at the worst instant; infinite if it failed. Errors have the same bits on any
machine. Times here are processor time of the steps on a machine that may do other things: they only say which settings
are worth a sitting.
"""

import json
import lzma
import os
import tempfile
import warnings
from dataclasses import dataclass

import numpy as np

from rodsweep.program import JobWarning, call
from rodsweep.reading import accuracy, measures
from rodsweep.reading.errors import SweepFileError
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.scoring.scenes import TUNING
from rodsweep.scoring.settings import Setting
from rodsweep.writing import outputs

SOME_FAILED = 3     # the program's exit code for a complete sweep in which simulations failed
AT_ONCE = 250       # settings in a job


@dataclass(frozen=True)
class Measured:
    """Per draw; times [s] and products for a simulated second, `network`: share of solves for which a network ran."""
    error: np.ndarray
    time_s: np.ndarray
    products: np.ndarray
    network: np.ndarray

    @property
    def failed(self):
        return int(np.count_nonzero(~np.isfinite(self.error)))


class Runs:
    """What is known of a scene. `workers` simulate; `show` gets a line before each job."""

    def __init__(self, scene, folder, workers, show=lambda text: None):
        self.scene, self.folder, self.workers, self.show = scene, folder, workers, show
        os.makedirs(folder, exist_ok=True)
        self.path, published = os.path.join(folder, f"{scene.name}.jsonl"), scene.measured(".jsonl.xz")
        if not os.path.exists(self.path) and os.path.exists(published):
            with lzma.open(published, "rt", encoding="utf-8") as file:
                outputs.write(self.path, file.read())
        self.known = {}
        self._frames = {}
        if os.path.exists(self.path):
            with open(self.path, encoding="utf-8") as file:
                lines = file.readlines()
            whole = [line for line in lines if line.endswith("\n")]    # one that was being written may lack its end
            if len(whole) < len(lines):
                outputs.write(self.path, "".join(whole))
            for line in whole:
                self._remember(json.loads(line))

    def publish(self):
        os.makedirs(os.path.dirname(self.scene.measured("")), exist_ok=True)
        with open(self.path, "rb") as file, outputs.whole(self.scene.measured(".jsonl.xz")) as part, open(part, "wb") as out:
            out.write(lzma.compress(file.read(), preset=9 | lzma.PRESET_EXTREME))

    def _remember(self, entry):
        numbers = (np.array([np.inf if value is None else value for value in entry[name]], dtype=float)
                   for name in ("error", "time_s", "products", "network"))
        self.known[Setting.from_json(entry), entry["draws"], len(entry["error"])] = Measured(*numbers)

    def of(self, setting, draws=TUNING, samples=None):
        """What was measured on the first `samples` draws (default: all); None: nothing was. Few draws are remembered beside
        all of them, so that a search that goes on takes the same decisions."""
        return self.known.get((setting, draws, samples or self.scene.samples))

    def reference(self, draws):
        """[draw] of frames() with the smaller step, and the distances of those with the larger one from them."""
        if draws not in self._frames:
            job = self.scene.reference_job(draws)
            path = os.path.join(self.folder, f"{job['name']}.h5")
            self.show(f"{self.scene.name}: reference of {job['samples']} draws for {draws}")
            self._run(job, path, resume=True)
            self._frames[draws] = _reference(path)
        return self._frames[draws]

    def measure(self, settings, draws=TUNING, samples=None, limit_s=0):
        """Simulates those of the settings that are not known for the first `samples` draws. A simulation that takes longer than
        limit_s failed."""
        samples = samples or self.scene.samples
        wanted = [setting for setting in dict.fromkeys(settings) if self.of(setting, draws, samples) is None]
        by_step = {}
        for setting in wanted:
            by_step.setdefault(setting.step.step_s, []).append(setting)
        frames, _ = self.reference(draws)
        for step_s, some in by_step.items():
            for begin in range(0, len(some), AT_ONCE):
                part = some[begin:begin + AT_ONCE]
                self.show(f"{self.scene.name}: {len(part)} of {len(wanted)} settings on {samples} draws for {draws}, "
                          f"{1e3 * step_s:g} ms")
                with tempfile.TemporaryDirectory(dir=self.folder) as folder:
                    path = os.path.join(folder, "part.h5")
                    self._run(self.scene.job_of(part, draws, samples), path, limit_s=limit_s)
                    with SweepFile(path) as file:
                        self._store(part, draws, measured(file, len(part), frames))

    def _store(self, settings, draws, found):
        with open(self.path, "a", encoding="utf-8") as file:
            for setting, of in zip(settings, found):
                numbers = {name: [float(f"{value:.4g}") if np.isfinite(value) else None for value in getattr(of, name)]
                           for name in ("error", "time_s", "products", "network")}
                entry = {**setting.as_json(), "draws": draws, **numbers}
                file.write(json.dumps(entry) + "\n")
                self._remember(entry)

    def _run(self, job, path, limit_s=0, resume=False):
        given = path.replace(".h5", ".json")
        with open(given, "w", encoding="utf-8") as file:
            json.dump(job, file)
        words = ["run", given, "-o", path, "-n", str(self.workers)]
        words += ["--resume"] if resume else []
        words += ["--task-time-limit", f"{limit_s:g}"] if limit_s else []
        run_quietly(*words, renamed={given: job["name"]})


def run_quietly(*words, renamed):
    """Simulations that failed, and steps that are too large, are results here."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", JobWarning)
        call(*words, renamed=renamed, accepted=(0, SOME_FAILED))


def point_of(file, task):
    """Which of the settings of a job with one guess."""
    return file.point[task] // (file.sample.max() + 1)


def _reference(path):
    with SweepFile(path) as file:
        step = file.parameter("time.step_s").values
        frames, apart = [], []
        for draw in range(file.sample.max() + 1):
            coarse, fine = sorted(np.flatnonzero(file.sample == draw), key=lambda task: -step[task])
            if not file.ok[fine]:
                raise SweepFileError(f"{path}: the reference of draw {draw} ended with {file.outcome[fine]}: {fine}")
            frames.append(accuracy.frames(file, fine))
            apart.append(max(accuracy.distances(accuracy.frames(file, coarse), frames[-1])) if file.ok[coarse] else np.inf)
    return frames, np.array(apart)


def measured(file, points, frames):
    """[Measured] of the points of a file, against the frames() of its draws."""
    count = len(np.unique(file.sample))
    made = [Measured(*np.full((4, count), np.nan)) for _ in range(points)]
    seconds = file.h5["/timing/tasks/steps_processor_s"][:]
    step, done = file.parameter("time.step_s").values, file.h5["/tasks/steps_done"][:]
    simulated = measures.quotient(np.ones(len(step)), done * step)
    for task in range(file.task_count):
        of, draw = made[point_of(file, task)], file.sample[task]
        of.error[draw] = max(accuracy.distances(accuracy.frames(file, task), frames[draw])) if file.ok[task] else np.inf
        of.time_s[draw] = seconds[task] * simulated[task]
        of.products[draw] = file.rows("/steps/products", task)[:done[task]].sum() * simulated[task]
        of.network[draw] = _network_share(file, task)
    return made


def _network_share(file, task):
    own = file.own_guess[task]
    if own < 0:
        return 0
    solves, ran = (file.h5[f"/timing/tasks/{name}"][task, own] for name in ("solves_timed", "solves_with_network"))
    return ran / solves if solves > 0 else 0
