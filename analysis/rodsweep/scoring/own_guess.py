"""A guess in Python beside the settings of the score: in those of CG from zero, a classical guess and one call of a
network it replaces theirs. All are simulated on the first draws for testing and timed in one sitting."""

import os
from dataclasses import replace

from rodsweep.scoring import answers, sitting
from rodsweep.scoring.runs import Runs
from rodsweep.scoring.scenes import TEST
from rodsweep.scoring.settings import CALL, CLASSICAL, OWN, ZERO, canonical

REPLACED = (ZERO, CLASSICAL, CALL)


def scored(scene, known, path, inputs, samples, work, show):
    """`known` (answers.Scored), on `samples` draws, with the cheapest setting of this guess at each error."""
    entry = {"file": os.path.abspath(path), **({"inputs": [os.path.abspath(name) for name in inputs]} if inputs else {})}
    chosen = {(answer.level, answer.kind): answer.setting for answer in known.answers}
    own = {}
    for (level, kind), setting in chosen.items():
        if kind in REPLACED:
            own.setdefault(level, []).append(replace(setting, guess=canonical({"python": entry})))
    # A guess may have changed since: nothing of it is remembered.
    runs = Runs(scene, os.path.join(work, "own"), os.cpu_count(), show)
    runs.known = {key: value for key, value in runs.known.items() if OWN not in key[0].kinds()}
    every = [*chosen.values(), *(setting for some in own.values() for setting in some)]
    runs.measure([training for setting in every for training in setting.trainings()], TEST, samples)
    times = sitting.Sitting(scene, work, show).repeated(every, TEST, samples)
    found = answers.answers_of(chosen, times, runs)
    for level, some in own.items():
        of = answers.answers_of({(level, k): setting for k, setting in enumerate(some)}, times, runs)
        kept = [answer for answer in of if answer.kept] or of
        found.append(replace(min(kept, key=lambda answer: answer.time), kind=OWN))
    return replace(known, answers=found)
