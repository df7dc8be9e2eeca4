"""Times the candidates of a scene, all in one sitting: NAME_times.json.

One worker simulates, nothing else may run. First the candidates, with all trainings, on the first draws for tuning: the
cheapest of each kind at each error is chosen there. Then the chosen ones on all draws for testing, REPETITIONS times. Each
repetition has settings in another order, and runs in PARTS parts, each with some draws of every setting. A time is
the processor time of all steps but the first, whole. Times of different sittings are not compared: a sitting that took
longer than LONGEST_S, or went on on another machine or with another program, is refused.
"""

import json
import os
import random
import tempfile
from datetime import datetime

import numpy as np

from rodsweep.reading import texts
from rodsweep.reading.errors import SweepFileError
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.scoring.runs import effort, run_job
from rodsweep.scoring.scenes import TEST, TUNING
from rodsweep.scoring.settings import Setting
from rodsweep.writing import outputs

REPETITIONS = 3
PARTS = 4
FOR_CHOICE = 10         # draws
LONGEST_S = 3600
SAME = ("host", "revision", "versions", "petsc_options")


class Sitting:
    """`work`: where files may lie; `show` gets a line before each job."""

    def __init__(self, scene, work, show=lambda text: None):
        self.scene, self.work, self.show = scene, work, show
        self.runs = []      # rows of /runs, of all jobs

    def times(self, settings, draws, samples, order):
        """{setting: [2, draw]} of one repetition: seconds, and products, of a simulated second; NaN for simulations that
        failed. `order` is the seed of its order."""
        some = list(dict.fromkeys(settings))
        found = {setting: np.full((2, samples), np.nan) for setting in some}
        random.Random(order).shuffle(some)    # not for each part: which tasks are in it depends on the order
        for part in range(1, PARTS + 1):
            self.show(f"{self.scene.name}: {len(some)} settings on {samples} draws for {draws}, timed, part {part} of {PARTS}")
            with tempfile.TemporaryDirectory(dir=self.work) as folder:
                path = os.path.join(folder, "times.h5")
                run_job(self.scene.job_of(some, draws, samples, frames=False), path, "--shard", f"{part}/{PARTS}")
                with SweepFile(path) as file:
                    self.runs += file.runs()
                    require_one(self.runs)
                    for task in np.flatnonzero(file.ok):
                        found[some[file.point[task] // samples]][:, file.sample[task]] = effort(file, task)
        return found

    def hold(self, candidates):
        """What NAME_times.json has: "candidates", "runs", "chosen": [{"level", "kind", "tuning_s", setting}], "times":
        [{setting, "time_s" and "products" [repetition][draw]}]. `candidates`: {(level, kind): settings}."""
        every = [training for some in candidates.values() for setting in some for training in setting.trainings()]
        first = self.times(every, TUNING, min(FOR_CHOICE, self.scene.samples), 0)

        def tuned(setting):
            return float(np.nanmedian(np.mean([first[training][0] for training in setting.trainings()], axis=0)))

        chosen = {of: min(some, key=tuned) for of, some in candidates.items() if some}
        times = self.repeated(chosen.values(), TEST, self.scene.samples)
        return {"candidates": listed(candidates),
                "runs": [{name: str(run[name]) for name in ("begin", "end", *SAME)} for run in self.runs],
                "chosen": [{"level": level, "kind": kind, "tuning_s": tuned(setting), **setting.as_json()}
                           for (level, kind), setting in chosen.items()],
                "times": [{**setting.as_json(), "time_s": texts.shortened(of[:, 0], 5),
                       "products": texts.shortened(of[:, 1], 5)}
                          for setting, of in times.items()]}

    def repeated(self, settings, draws, samples):
        """{setting: [repetition, 2, draw]} of settings, with all trainings."""
        every = list(dict.fromkeys(training for setting in settings for training in setting.trainings()))
        found = [self.times(every, draws, samples, repetition) for repetition in range(1, REPETITIONS + 1)]
        return {setting: np.array([of[setting] for of in found]) for setting in every}


def listed(candidates):
    return [{"level": level, "kind": kind, "settings": [setting.as_json() for setting in some]}
            for (level, kind), some in candidates.items()]


def require_one(runs):
    """Raises SweepFileError unless these rows of /runs are of one sitting."""
    for name in SAME:
        if len({str(run[name]) for run in runs}) > 1:
            raise SweepFileError(f"times of different sittings are not compared: they differ in {name}; time all again")
    begin = datetime.fromisoformat(min(str(run["begin"]) for run in runs))
    end = datetime.fromisoformat(max(str(run["end"]) for run in runs))
    if (end - begin).total_seconds() > LONGEST_S:
        raise SweepFileError(f"times of different sittings are not compared: these took from {begin} to {end}, more than "
                             f"{LONGEST_S} s; use fewer draws")


def read(path):
    """What NAME_times.json has; empty without the file."""
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def write(path, held):
    outputs.write(path, json.dumps(held) + "\n")


def chosen_and_times(held):
    """{(level, kind): (Setting, seconds on the tuning draws)}, {Setting: [repetition, 2, draw]} of what hold() gave."""
    require_one(held["runs"])
    chosen = {(entry["level"], entry["kind"]): (Setting.from_json(entry), entry["tuning_s"]) for entry in held["chosen"]}
    return chosen, {Setting.from_json(entry): np.array([entry["time_s"], entry["products"]], dtype=float).swapaxes(0, 1)
                    for entry in held["times"]}
