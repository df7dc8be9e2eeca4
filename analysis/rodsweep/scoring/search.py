"""Looks for the cheapest setting of each kind at each error, on the tuning draws, by successive halving.

All settings that are tried run on the fewest draws. Of those whose errors are at most SLACK times the level there, the
BATCH cheapest run on a few draws, and the FINAL cheapest of those that may keep to the error on all draws, ours with all
trainings; until LEAST are admitted, the next FINAL do, then the next BATCH. Of all settings that are admitted on all
draws, the cheapest ones are candidates for a sitting, if they take at most NEAR times as long as the first.

The direct solve with all steps of the grid, and Gauss-Seidel with all of its steps, are tried first. The useful steps
of an error are the first whose direct solve is admitted. A search for every kind of CG and every error goes along the
axes: those of settings.Axes, and the fields of a step, among the useful ones. It has two centres: the cheapest setting
that may keep to the error on the fewest draws, and the cheapest with SLACK. It tries every value of every axis beside
them; and the guesses of the kind's centres with the steps, preconditioners and tolerances of the centres of other kinds
and of other errors. It ends where nothing is cheaper, or after MOST_ROUNDS.

A large scene tries what was the cheapest on a smaller one in place of that search: of each kind at each error, settings
with BEST different preconditioners and with BEST different guesses, with the cheapest useful step.
"""

from dataclasses import dataclass, replace

import numpy as np

from rodsweep.scoring import settings, verdicts
from rodsweep.scoring.scenes import LEVELS, TEST, TUNING
from rodsweep.scoring.settings import DIRECT, KINDS, OF_CG, OWN, Setting, Way

NEAR = 2
SLACK = 1.5
BATCH = 24
FINAL = 4
LEAST = 4
BEST = 4
MOST_TRIES = 5
FINALISTS = 3
MOST_ROUNDS = 6
SLOW = 10           # times the slowest direct solve that is of use: what takes longer is stopped
SHORTEST_S = 2


@dataclass(frozen=True)
class Place:
    step: settings.Step
    way: Way

    def setting(self):
        return self.way.setting(self.step)


class Search:
    """`smaller`: the Runs of a smaller scene, whose search is complete."""

    def __init__(self, runs, smaller=None):
        self.runs, self.scene, self.smaller = runs, runs.scene, smaller
        self.axes = {kind: self.scene.axes(kind) for kind in OF_CG}
        self.reference = {draws: float(f"{verdicts.upper_bound(runs.reference(draws)[1]):.3g}") for draws in (TUNING, TEST)}
        self.levels = [level for level in LEVELS if max(self.reference.values()) <= level / 3]

    def run(self):
        """{(level, kind): candidates}, cheapest first."""
        every, of_gauss_seidel = self.scene.steps()
        self._try([settings.direct(step) for step in every])
        first = self._run_on_all({(level, DIRECT): promising(self.runs, level, DIRECT) for level in self.levels}, BATCH)
        useful = {level: [setting.step for setting in some] for (level, _), some in first.items()}
        slowest = max((self.time(settings.direct(step)) for steps in useful.values() for step in steps), default=0)
        limit_s = max(SHORTEST_S, SLOW * slowest * self.scene.job["time"]["duration_s"])
        self._try([settings.gauss_seidel(step, sweeps) for step in of_gauss_seidel for sweeps in settings.SWEEPS], limit_s)
        with_steps = {level: steps for level, steps in useful.items() if steps}
        if self.smaller:
            self._try([replace(setting, step=self._cheapest_step(steps)) for level, steps in with_steps.items()
                       for kind in OF_CG for setting in best(self.smaller, level, kind)], limit_s)
        else:
            self._search_ways(with_steps, limit_s)
        left = {(level, kind): [s for s in promising(self.runs, level, kind) if kind not in OF_CG or s.step in useful[level]]
                for level in self.levels for kind in KINDS if kind != OWN}
        self._run_on_all(left)
        return {(level, kind): self.near(self.admitted(level, kind)) for level, kind in left}

    def near(self, some):
        """The first ones that take at most NEAR times as long as the first."""
        return [setting for setting in some if self.time_on_all(setting) <= NEAR * self.time_on_all(some[0])][:FINALISTS]

    def admitted(self, level, kind):
        """Of the settings that ran on all draws, cheapest first."""
        return sorted((s for s in tried(self.runs) if kind in s.kinds() and all(map(self.runs.results, s.trainings()))
                       and verdicts.admitted(self.errors(s), level)), key=self.time_on_all)

    def _run_on_all(self, left, final=FINAL):
        """Runs settings of {(level, kind): settings, cheapest first} until LEAST are admitted, which it gives. What is known
        of other kinds and levels does not count: a search that goes on must not decide otherwise."""
        found, few = {place: [] for place in left}, self.scene.few
        for begin in range(0, MOST_TRIES * BATCH, BATCH):
            batch = {place: some[begin:begin + BATCH] for place, some in left.items() if len(found[place]) < LEAST}
            self.runs.measure([setting for some in batch.values() for setting in some], samples=few)
            batch = {(level, kind): [s for s in sorted(some, key=lambda s: _time(self.runs, s, few))
                                     if _may_keep(self.runs, s, level, few)] for (level, kind), some in batch.items()}
            for first in range(0, BATCH, final):
                part = {place: some[first:first + final] for place, some in batch.items() if len(found[place]) < LEAST}
                self.runs.measure([training for some in part.values() for setting in some for training in setting.trainings()])
                for (level, kind), some in part.items():
                    found[level, kind] += [setting for setting in some if verdicts.admitted(self.errors(setting), level)]
        return found

    def _try(self, some, limit_s=0):
        self.runs.measure([s for s in some if self.scene.renews(s)], samples=self.scene.fewest, limit_s=limit_s)

    def time(self, setting):
        return _time(self.runs, setting, self.scene.fewest)

    def time_on_all(self, setting):
        return np.median(np.mean([self.runs.results(training).time_s for training in setting.trainings()], axis=0))

    def errors(self, setting):
        """[training, draw]"""
        return np.array([self.runs.results(training).error for training in setting.trainings()])

    def _cheapest_step(self, steps):
        return min(steps, key=lambda step: self.time(settings.direct(step)))

    def _search_ways(self, useful, limit_s):
        step = {level: self._cheapest_step(steps) for level, steps in useful.items()}
        now = {(level, kind): [Place(step[level], self.axes[kind].first())] for level in useful for kind in OF_CG}
        places = [Place(step[level], way) for level, kind in now for way in self.axes[kind].screened()]
        for _ in range(MOST_ROUNDS):
            for (level, kind), some in now.items():
                guesses = dict.fromkeys(place.way.guess for (_, of), own in now.items() if of == kind for place in own)
                places += [other for place in some for other in self._beside(place, kind, useful[level])]
                places += [Place(place.step if place.step in useful[level] else step[level], way)
                           for (at, of), others in now.items() if (at == level) != (of == kind)
                           for place in others for way in self.axes[kind].crossed(place.way, guesses)]
            places = [place for place in dict.fromkeys(places) if self.scene.renews(place.setting())]
            self._try([place.setting() for place in places], limit_s)
            moved = {of: self._cheapest(places, *of) or some for of, some in now.items()}
            if moved == now:
                break
            now = moved

    def _beside(self, place, kind, useful):
        ways = [Place(place.step, way) for way in self.axes[kind].beside(place.way)]
        return ways + [Place(step, place.way) for step in useful if _fields_apart(step, place.step) <= 1]

    def _cheapest(self, places, level, kind):
        """Of the places that may keep to the level, and of those that may with SLACK."""
        found = []
        for slack in (1, SLACK):
            may = [place for place in places if kind in place.setting().kinds()
                   and _may_keep(self.runs, place.setting(), slack * level, self.scene.fewest)]
            found += [min(may, key=lambda place: self.time(place.setting()))] if may else []
        return list(dict.fromkeys(found))

    def tried(self):
        """{kind: number of settings}"""
        return {kind: sum(kind in setting.kinds() for setting in tried(self.runs)) for kind in KINDS if kind != OWN}


def tried(runs):
    """All settings of the grid that ran on the fewest draws."""
    return [setting for setting, draws, samples in runs.known
            if draws == TUNING and samples == runs.scene.fewest and runs.scene.renews(setting)]


def promising(runs, level, kind):
    """The settings of a kind that may keep to a level on the fewest draws, with SLACK, cheapest first."""
    fewest = runs.scene.fewest
    return sorted((setting for setting in tried(runs)
                   if kind in setting.kinds() and _may_keep(runs, setting, SLACK * level, fewest)),
                  key=lambda setting: _time(runs, setting, fewest))


def best(runs, level, kind):
    """Of the promising settings the cheapest with BEST different preconditioners, and with BEST different guesses."""
    made = []
    for part in (Setting.preconditioner, lambda setting: setting.guess):
        first = {}
        for setting in promising(runs, level, kind):
            first.setdefault(part(setting), setting)
        made += list(first.values())[:BEST]
    return list(dict.fromkeys(made))


def _time(runs, setting, samples):
    return np.median(runs.results(setting, samples=samples).time_s)


def _may_keep(runs, setting, level, samples):
    return verdicts.may_keep(runs.results(setting, samples=samples).error, level)


def _fields_apart(step, other):
    return sum(getattr(step, name) != getattr(other, name) for name in ("step_s", "integrator", "newton", "balance", "contact"))
