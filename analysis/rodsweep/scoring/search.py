"""Looks for the cheapest setting of each kind at each error, on the tuning draws.

First all steps of the grid with the direct solve, and all of Gauss-Seidel, on a few draws. Then CG: a search for every kind
and error goes along the axes: those of settings.Axes, and the fields of a step, among the steps whose direct solve is
admitted. It tries every value of every axis, moves to the cheapest that may keep to the error, and ends where
no axis has a cheaper one, or after MOST_ROUNDS. Of all that was tried, the CHEAPEST that may keep to the error run on all
draws; if none of them is admitted there, the next ones. Those that are admitted, and take at most NEAR times as long as
the cheapest of them, are candidates for a sitting.
"""

from dataclasses import dataclass

import numpy as np

from rodsweep.scoring import settings, verdicts
from rodsweep.scoring.scenes import LEVELS, TEST, TUNING
from rodsweep.scoring.settings import KINDS, OF_CG, OWN, Way

NEAR = 2
CHEAPEST = 6
MOST_TRIES = 10
FINALISTS = 3
MOST_ROUNDS = 4
SLOW = 30           # times the slowest direct solve that is of use: what takes longer is stopped
SHORTEST_S = 2


@dataclass(frozen=True)
class Place:
    step: settings.Step
    way: Way

    def setting(self):
        return self.way.setting(self.step)


class Search:
    def __init__(self, runs):
        self.runs, self.scene = runs, runs.scene
        self.axes = {kind: self.scene.axes(kind) for kind in OF_CG}
        self.reference = {draws: float(f"{verdicts.upper_bound(runs.reference(draws)[1]):.3g}") for draws in (TUNING, TEST)}
        self.levels = [level for level in LEVELS if max(self.reference.values()) <= level / 3]

    def run(self):
        """{(level, kind): candidates}, cheapest first."""
        few = self.scene.few
        every, of_gauss_seidel = self.scene.steps()
        self.runs.measure([settings.direct(step) for step in every], samples=few)
        useful = self._useful(every)
        slowest = max((self.time(settings.direct(step)) for steps in useful.values() for step in steps), default=0)
        limit_s = max(SHORTEST_S, SLOW * slowest * self.scene.job["time"]["duration_s"])
        self.runs.measure([settings.gauss_seidel(step, sweeps) for step in of_gauss_seidel for sweeps in settings.SWEEPS],
                          samples=few, limit_s=limit_s)
        self._search_ways({level: steps for level, steps in useful.items() if steps}, limit_s)
        left = {(level, kind): self.promising(level, kind, useful[level]) for level in self.levels for kind in KINDS
                if kind != OWN}
        found = {place: [] for place in left}
        for begin in range(0, MOST_TRIES * CHEAPEST, CHEAPEST):
            batch = {place: some[begin:begin + CHEAPEST] for place, some in left.items() if not found[place]}
            self.runs.measure([training for some in batch.values() for setting in some for training in setting.trainings()])
            found |= {(level, kind): self.finalists(level, some) for (level, kind), some in batch.items()}
        return found

    def _useful(self, steps):
        """{level: steps whose direct solve is admitted}"""
        may = {level: [step for step in steps if self.may_keep(settings.direct(step), level)] for level in self.levels}
        self.runs.measure([settings.direct(step) for some in may.values() for step in some])
        return {level: [step for step in some if verdicts.admitted(self.errors(settings.direct(step)), level)]
                for level, some in may.items()}

    def promising(self, level, kind, useful):
        """The settings of a kind that may keep to a level, cheapest first; of CG those with useful steps."""
        return sorted((s for s in self.tried_settings() if kind in s.kinds() and self.may_keep(s, level)
                       and (kind not in OF_CG or s.step in useful)), key=self.time)

    def finalists(self, level, some):
        kept = sorted((s for s in some if verdicts.admitted(self.errors(s), level)), key=self.time_on_all)
        return [s for s in kept if self.time_on_all(s) <= NEAR * self.time_on_all(kept[0])][:FINALISTS]

    def time(self, setting):
        return np.median(self.runs.results(setting, samples=self.scene.few).time_s)

    def time_on_all(self, setting):
        return np.median(np.mean([self.runs.results(training).time_s for training in setting.trainings()], axis=0))

    def may_keep(self, setting, level):
        return verdicts.may_keep(self.runs.results(setting, samples=self.scene.few).error, level)

    def errors(self, setting):
        """[training, draw]"""
        return np.array([self.runs.results(training).error for training in setting.trainings()])

    def _search_ways(self, useful, limit_s):
        now = {(level, kind): Place(min(steps, key=lambda step: self.time(settings.direct(step))), self.axes[kind].first())
               for level, steps in useful.items() for kind in OF_CG}
        tried = [Place(place.step, way) for (_, kind), place in now.items() for way in self.axes[kind].screened()]
        for _ in range(MOST_ROUNDS):
            tried += [other for (level, kind), place in now.items() for other in self._beside(place, kind, useful[level])]
            self.runs.measure([place.setting() for place in tried], samples=self.scene.few, limit_s=limit_s)
            moved = {(level, kind): self._cheapest(tried, level, kind) or place for (level, kind), place in now.items()}
            if moved == now:
                break
            now = moved

    def _beside(self, place, kind, useful):
        ways = [Place(place.step, way) for way in self.axes[kind].beside(place.way)]
        return ways + [Place(step, place.way) for step in useful if _fields_apart(step, place.step) <= 1]

    def _cheapest(self, places, level, kind):
        may = [place for place in dict.fromkeys(places)
               if kind in place.setting().kinds() and self.may_keep(place.setting(), level)]
        return min(may, key=lambda place: self.time(place.setting()), default=None)

    def tried(self):
        """{kind: number of settings}"""
        return {kind: sum(kind in setting.kinds() for setting in self.tried_settings()) for kind in KINDS if kind != OWN}

    def tried_settings(self):
        """All settings that ran on a few draws."""
        return [setting for setting, draws, samples in self.runs.known if draws == TUNING and samples == self.scene.few]


def _fields_apart(step, other):
    return sum(getattr(step, name) != getattr(other, name) for name in ("step_s", "integrator", "newton", "balance", "contact"))
