"""A guess in Python beside the settings of the score: in those of CG from zero, a classical guess and one call of a
network it replaces theirs. Its setting is chosen on draws for tuning, as theirs were. Then all are simulated on the first
draws for testing and timed in one sitting."""

import os
from dataclasses import replace

import numpy as np

from rodsweep.scoring import answers, sitting, verdicts
from rodsweep.scoring.runs import Runs
from rodsweep.scoring.scenes import TEST, TUNING
from rodsweep.scoring.settings import CALL, CLASSICAL, OWN, ZERO, canonical

REPLACED = (ZERO, CLASSICAL, CALL)


def scored(scene, known, path, inputs, samples, work, show):
    """`known` (answers.Scored), on `samples` draws, with the cheapest setting of this guess at each error."""
    samples = min(samples, scene.samples)
    entry = {"file": os.path.abspath(path), **({"inputs": [os.path.abspath(name) for name in inputs]} if inputs else {})}
    runs = Runs(scene, work, os.cpu_count(), show)
    chosen = {(answer.level, answer.kind): (answer.setting, answer.tuning_s) for answer in known.answers}
    for level in known.levels:
        own = [replace(answer.setting, guess=canonical({"python": entry})) for answer in known.answers
               if answer.level == level and answer.kind in REPLACED]
        runs.measure(own, TUNING, samples)
        of = {setting: runs.results(setting, TUNING, samples) for setting in own}
        kept = [setting for setting in own if verdicts.admitted(of[setting].error[None], level)] or own
        if kept:
            best = min(kept, key=lambda setting: np.median(of[setting].time_s))
            chosen[level, OWN] = best, float(np.median(of[best].time_s))
    settings = [setting for setting, _ in chosen.values()]
    runs.measure([training for setting in settings for training in setting.trainings()], TEST, samples)
    times = sitting.Sitting(scene, work, show).repeated(settings, TEST, samples)
    return replace(known, answers=answers.answers_of(chosen, times, runs))
