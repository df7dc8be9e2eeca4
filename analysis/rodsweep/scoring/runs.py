"""Simulates settings of a scene and keeps what they gave: NAME.jsonl, a line per setting, draws and number of samples. It
begins with that of analysis/results/score, if there is one.

The error of a simulation is the root mean square distance of its segments from the reference, over the diagonal of the
box around all segments at the start, at the worst instant; infinite if it failed, or was stopped because it took too
long. Errors have the same bits on any machine with the same vector instructions. Times here are processor time of the
steps on a machine that may do other things: they only say which settings are worth a sitting.

A line before those of each program and machine has the checksum of the scene's job. Lines of another job are refused. With
another program or machine some direct solves are simulated again: their errors must be the same, and the quotient of
their times, "scale", holds for all earlier lines. Lines of models that have changed are left out.
"""

import hashlib
import json
import lzma
import os
import tempfile
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rodsweep.program import TASKS_FAILED, JobWarning, call
from rodsweep.reading import accuracy, job_paths, measures, texts
from rodsweep.reading.errors import KeyNotFound, SweepFileError
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.scoring.scenes import TUNING
from rodsweep.scoring.settings import DIRECT, OWN, Setting
from rodsweep.writing import outputs

AT_ONCE = 250       # settings in a job
COMPARED = 5        # settings that are simulated again with another program or machine
SAME_TO = 1e-3      # relative; errors are stored with four digits


@dataclass(frozen=True)
class Measured:
    """Per draw; times [s] and products for a simulated second, `network`: share of solves for which a network ran."""
    error: np.ndarray
    time_s: np.ndarray
    products: np.ndarray
    network: np.ndarray


class Runs:
    """What is known of a scene. `workers` simulate; `show` gets a line before each job. `complete`: settings on tuning draws
    that are not known are an error."""

    def __init__(self, scene, folder, workers, show=lambda text: None, complete=False):
        self.scene, self.folder, self.workers, self.show, self.complete = scene, folder, workers, show, complete
        os.makedirs(folder, exist_ok=True)
        self.path, published = os.path.join(folder, f"{scene.name}.jsonl"), scene.measured(".jsonl.xz")
        if not os.path.exists(self.path) and os.path.exists(published):
            with lzma.open(published, "rt", encoding="utf-8") as file:
                outputs.write(self.path, file.read())
        self.known, self._frames, self._sums = {}, {}, {}
        self._header = {"job": job_paths.checksum(scene.job), "made": made_by()}
        self._last = None
        if os.path.exists(self.path):
            self._read()

    def _read(self):
        with open(self.path, encoding="utf-8") as file:
            lines = file.readlines()
        whole = [line for line in lines if line.endswith("\n")]    # one that was being written may lack its end
        if len(whole) < len(lines):
            outputs.write(self.path, "".join(whole))
        for entry in map(json.loads, whole):
            if "job" not in entry:
                self._remember(entry)
                continue
            if entry["job"] != self._header["job"]:
                raise SweepFileError(f"{self.path} is of another jobs/score/{self.scene.name}_draws.json: restore that, or "
                                     "remove this file and the references beside it")
            self.known = {key: replace(of, time_s=of.time_s * entry["scale"]) for key, of in self.known.items()}
            self._last = entry["made"]

    def require_timed(self):
        """A search may be published before it is complete, but only a complete one is timed."""
        if not os.path.exists(self.scene.measured(".json")):
            raise KeyNotFound(f"{self.scene.name} comes first: run score.py --errors {self.scene.name}, then --times "
                              f"{self.scene.name}")

    def publish(self):
        with open(self.path, "rb") as file, outputs.whole(self.scene.measured(".jsonl.xz")) as part, open(part, "wb") as out:
            out.write(lzma.compress(file.read(), preset=9 | lzma.PRESET_EXTREME))

    def _remember(self, entry):
        if any(self._model(path) != of for path, of in entry.get("models", {}).items()):
            return
        numbers = (np.array([np.inf if value is None else value for value in entry[name]], dtype=float)
                   for name in ("error", "time_s", "products", "network"))
        self.known[Setting.from_json(entry), entry["draws"], len(entry["error"])] = Measured(*numbers)

    def _model(self, path):
        """The checksum of a model, "" if it does not exist."""
        if path not in self._sums:
            full = os.path.join(self.scene.root, path)
            self._sums[path] = hashlib.sha256(Path(full).read_bytes()).hexdigest()[:12] if os.path.exists(full) else ""
        return self._sums[path]

    def results(self, setting, draws=TUNING, samples=None):
        """What was measured on the first `samples` draws (default: all); None: nothing was. Few draws are remembered beside
        all of them: the search decides by them."""
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
        """Simulates those of the settings that are not known for the first `samples` draws. A simulation that takes longer
        than limit_s failed."""
        samples = samples or self.scene.samples
        wanted = [setting for setting in dict.fromkeys(settings) if self.results(setting, draws, samples) is None]
        if not wanted:
            return
        if self.complete and draws == TUNING:
            raise KeyNotFound(f"the search of {self.scene.name} is not complete: run score.py --errors {self.scene.name}")
        if self._last != self._header["made"]:
            self._begin()
        self._simulate(wanted, draws, samples, limit_s)

    def _begin(self):
        """Writes a line before those of this program and machine."""
        scale, known = 1, [(setting, draws, samples) for setting, draws, samples in self.known
                           if draws == TUNING and DIRECT in setting.kinds()]    # CG's depend on the order of sums
        if known:
            again = known[::max(1, len(known) // COMPARED)][:COMPARED]
            before = [self.known[key] for key in again]
            for setting, draws, samples in again:
                self._simulate([setting], draws, samples, 0, store=False)
            after = [self.known[key] for key in again]
            for (setting, _, _), old, new in zip(again, before, after):
                ran = np.isfinite(old.error)    # the others may have been stopped
                if not np.allclose(old.error[ran], new.error[ran], rtol=SAME_TO):
                    raise SweepFileError(f"{self.path} has other errors than this program gives ({setting.text()}): remove it")
            scale = texts.shortened(np.median([np.median(new.time_s) / np.median(old.time_s)
                                               for old, new in zip(before, after)]), 3)
            self.known.update(zip(again, before))    # as in the file, so that a search that goes on decides alike
            self.known = {key: replace(of, time_s=of.time_s * scale) for key, of in self.known.items()}
        self._write({**self._header, "scale": scale})
        self._last = self._header["made"]

    def _simulate(self, wanted, draws, samples, limit_s, store=True):
        frames, _ = self.reference(draws)
        by_step = {}
        for setting in wanted:
            by_step.setdefault(setting.step.step_s, []).append(setting)
        for step_s, some in by_step.items():
            for begin in range(0, len(some), AT_ONCE):
                part = some[begin:begin + AT_ONCE]
                self.show(f"{self.scene.name}: {len(part)} of {len(wanted)} settings on {samples} draws for {draws}, "
                          f"{1e3 * step_s:g} ms")
                with tempfile.TemporaryDirectory(dir=self.folder) as folder:
                    path = os.path.join(folder, "part.h5")
                    self._run(self.scene.job_of(part, draws, samples), path, limit_s=limit_s)
                    with SweepFile(path) as file:
                        for setting, of in zip(part, measured(file, len(part), samples, frames)):
                            self._store(setting, draws, of, store)

    def _store(self, setting, draws, of, store):
        numbers = {name: texts.shortened(getattr(of, name), 4) for name in ("error", "time_s", "products", "network")}
        models = {path: self._model(path) for path in setting.models()}
        entry = {**setting.as_json(), "draws": draws, "models": models, **numbers}
        if store and OWN not in setting.kinds():    # a guess of the user's may change
            self._write(entry)
        self._remember(entry)

    def _write(self, entry):
        with open(self.path, "a", encoding="utf-8") as file:
            file.write(json.dumps(entry) + "\n")

    def _run(self, job, path, limit_s=0, resume=False):
        run_job(job, path, "-n", str(self.workers), *(["--resume"] if resume else []),
                *(["--task-time-limit", f"{limit_s:g}"] if limit_s else []))


def made_by():
    """The revision of the program, and its processor."""
    return " ".join(call("--version", renamed={})[1].split())


def run_job(job, path, *words):
    """Runs a job into a file. Simulations that failed, and steps that are too large, are results here."""
    given = os.path.splitext(path)[0] + ".json"
    with open(given, "w", encoding="utf-8") as file:
        json.dump(job, file)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", JobWarning)
        call("run", given, "-o", path, *words, renamed={given: job["name"]}, accepted=(0, TASKS_FAILED))


def _reference(path):
    with SweepFile(path) as file:
        step = file.parameter("time.step_s").values
        frames, apart = [], []
        for draw in range(file.sample.max() + 1):
            coarse, fine = sorted(np.flatnonzero(file.sample == draw), key=lambda task: -step[task])
            if not file.ok[fine]:
                raise SweepFileError(f"{path}: the reference of draw {draw}, task {fine}, ended with {file.outcome[fine]}")
            instants = accuracy.frames(file, coarse)
            frames.append({time: frame for time, frame in accuracy.frames(file, fine).items() if time in instants})
            apart.append(max(accuracy.distances(instants, frames[-1])) if file.ok[coarse] else np.inf)
    return frames, np.array(apart)


def measured(file, points, samples, frames):
    """[Measured] of the points of a file, against the frames() of its draws."""
    made = [Measured(*np.full((4, samples), np.nan)) for _ in range(points)]
    for task in range(file.task_count):
        of, draw = made[file.point[task] // samples], file.sample[task]
        of.error[draw] = _error(accuracy.frames(file, task), frames[draw]) if file.ok[task] else np.inf
        of.time_s[draw], of.products[draw] = effort(file, task)
        of.network[draw] = _network_share(file, task)
    return made


def _error(frames, exact):
    if list(frames) != list(exact):
        raise SweepFileError(f"frames at {list(frames)} ms are compared with those at {list(exact)} ms")
    return max(accuracy.distances(frames, exact))


def effort(file, task):
    """(processor time [s], products) of a task for a simulated second. The first step, which sets up solvers, is in neither;
    NaN if there is no other."""
    steps = int(file.h5["/tasks/steps_done"][task]) - 1
    simulated = steps * file.parameter("time.step_s").values[task]
    if steps <= 0:
        return np.nan, np.nan
    products = file.rows("/steps/products", task)[1:steps + 1].sum()
    return measures.quotient([file.h5["/timing/tasks/steps_processor_s"][task], products], simulated)


def _network_share(file, task):
    own = file.own_guess[task]
    if own < 0:
        return 0
    solves, ran = (file.h5[f"/timing/tasks/{name}"][task, own] for name in ("solves_timed", "solves_with_network"))
    return ran / solves if solves > 0 else 0
