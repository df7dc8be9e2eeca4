"""Times the candidates of a scene, all in one sitting: NAME_times.json.

One worker simulates, nothing else may run. First the candidates on the first draws for tuning: the cheapest of each kind
at each error is chosen there. Then the chosen ones, with all trainings, on all draws for testing, REPETITIONS times, each
time in another random order. A time is the processor time of all steps, whole. Times of different sittings are not
compared: a sitting that took longer than LONGEST_S, or went on on another machine or with another program, is refused.
"""

import datetime
import json
import os
import random
import tempfile

import numpy as np

from rodsweep.reading.errors import SweepFileError
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.scoring.runs import point_of, run_quietly
from rodsweep.scoring.scenes import TEST, TUNING
from rodsweep.scoring.settings import Setting
from rodsweep.writing import outputs

REPETITIONS = 3
FOR_CHOICE = 10         # draws
LONGEST_S = 3600
SAME = ("host", "revision")


class Sitting:
    """`work`: where files may lie; `show` gets a line before each job."""

    def __init__(self, scene, work, show=lambda text: None):
        self.scene, self.work, self.show = scene, work, show
        self.runs = []      # rows of /runs, of all jobs

    def times(self, settings, draws, samples, order):
        """{setting: [draw] seconds of a simulated second} of one repetition; `order` is the seed of its order."""
        some = list(dict.fromkeys(settings))
        random.Random(order).shuffle(some)
        self.show(f"{self.scene.name}: {len(some)} settings on {samples} draws for {draws}, timed")
        with tempfile.TemporaryDirectory(dir=self.work) as folder:
            path, given = (os.path.join(folder, f"times.{kind}") for kind in ("h5", "json"))
            job = self.scene.job_of(some, draws, samples, frames=False)
            with open(given, "w", encoding="utf-8") as file:
                json.dump(job, file)
            run_quietly("run", given, "-o", path, renamed={given: job["name"]})
            with SweepFile(path) as file:
                self.runs += file.runs()
                require_one(self.runs)
                return times_in(file, some)

    def hold(self, candidates):
        """What NAME_times.json has: {"runs", "chosen": [{"level", "kind", "setting"}], "times": [{"setting", "time_s"
        [repetition][draw]}]}. `candidates`: {(level, kind): settings}."""
        every = [setting for some in candidates.values() for setting in some]
        first = self.times(every, TUNING, min(FOR_CHOICE, self.scene.samples), 0)
        chosen = {of: min(some, key=lambda s: np.median(first[s])) for of, some in candidates.items() if some}
        times = self.repeated(chosen.values(), TEST, self.scene.samples)
        return {"runs": [{name: str(run[name]) for name in ("begin", "end", *SAME)} for run in self.runs],
                "chosen": [{"level": level, "kind": kind, **setting.as_json()} for (level, kind), setting in chosen.items()],
                "times": [{**setting.as_json(), "time_s": [[float(f"{value:.5g}") for value in row] for row in of]}
                          for setting, of in times.items()]}

    def repeated(self, settings, draws, samples):
        """{setting: [repetition, draw]} of settings, with all trainings."""
        every = list(dict.fromkeys(training for setting in settings for training in setting.trainings()))
        found = [self.times(every, draws, samples, repetition) for repetition in range(1, REPETITIONS + 1)]
        return {setting: np.array([of[setting] for of in found]) for setting in every}


def times_in(file, settings):
    """{setting: [draw]} of a file whose points are the settings."""
    seconds, step = file.h5["/timing/tasks/steps_processor_s"][:], file.parameter("time.step_s").values
    done = file.h5["/tasks/steps_done"][:]
    made = {setting: np.full(file.sample.max() + 1, np.nan) for setting in settings}
    for task in range(file.task_count):
        made[settings[point_of(file, task)]][file.sample[task]] = seconds[task] / max(1, done[task]) / step[task]
    return made


def require_one(runs):
    """Raises SweepFileError unless these rows of /runs are of one sitting."""
    for name in SAME:
        if len({str(run[name]) for run in runs}) > 1:
            raise SweepFileError(f"times of different sittings are not compared: they differ in {name}; time all again")
    begin, end = (_moment(of) for of in (min(str(run["begin"]) for run in runs), max(str(run["end"]) for run in runs)))
    if (end - begin).total_seconds() > LONGEST_S:
        raise SweepFileError(f"times of different sittings are not compared: these took from {begin} to {end}, more than "
                             f"{LONGEST_S} s; use fewer draws")


def _moment(text):
    return datetime.datetime.fromisoformat(text.replace("Z", "+00:00"))


def write(path, held):
    outputs.write(path, json.dumps(held) + "\n")


def of(held):
    """{(level, kind): Setting}, {Setting: [repetition, draw]} of what hold() gave."""
    require_one(held["runs"])
    chosen = {(entry["level"], entry["kind"]): Setting.from_json(entry) for entry in held["chosen"]}
    return chosen, {Setting.from_json(entry): np.array(entry["time_s"]) for entry in held["times"]}
