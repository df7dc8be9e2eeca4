"""Looks for the cheapest setting of each kind at each error, on the tuning draws.

First all steps of the grid with the direct solve, and all of Gauss-Seidel, on a few draws. Then CG: a search for every kind
and error goes along the axes (settings.Axes) from the cheapest step at which the direct solve may keep to the error. It
tries every value of every axis, moves to the cheapest that may keep to the error, and ends where no axis has a cheaper
one. Of all that was tried, the CHEAPEST that may keep to the error run on all draws; if none of them is admitted there,
the next ones. Those that are admitted, and take at most NEAR times as long as the first, are candidates for a sitting.
"""

from dataclasses import dataclass

import numpy as np

from rodsweep.scoring import settings, verdicts
from rodsweep.scoring.scenes import LEVELS, TEST, TUNING
from rodsweep.scoring.settings import KINDS, OF_CG, OWN, Way

NEAR = 2
CHEAPEST = 6
MOST_TRIES = 5
FINALISTS = 3
MOST_ROUNDS = 4
MOST_STEPS = 12
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
        _, apart = runs.reference(TUNING)
        self.levels = [level for level in LEVELS if verdicts.upper_bound(apart) <= level / 3]

    def time(self, setting, samples=None):
        return np.median(self.runs.of(setting, samples=samples or self.scene.few).time_s)

    def may_pass(self, setting, level):
        return verdicts.may_pass(self.runs.of(setting, samples=self.scene.few).error, level)

    def run(self):
        """{(level, kind): candidates}, cheapest first."""
        few = self.scene.few
        every, of_gauss_seidel = self.scene.steps()
        self.runs.measure([settings.direct(step) for step in every], samples=few)
        useful = {level: self.useful_steps(level) for level in self.levels}
        slowest = max((self.time(settings.direct(step)) for steps in useful.values() for step in steps), default=0)
        limit_s = max(SHORTEST_S, SLOW * slowest * self.scene.job["time"]["duration_s"])
        self.runs.measure([settings.gauss_seidel(step, sweeps) for step in of_gauss_seidel for sweeps in settings.SWEEPS],
                          samples=few, limit_s=limit_s)
        self._search_ways(useful, limit_s)
        places = {(level, kind): self.near(level, kind) for level in self.levels for kind in KINDS if kind != OWN}
        finalists = {}
        for begin in range(0, MOST_TRIES * CHEAPEST, CHEAPEST):
            some = {of: near[begin:begin + CHEAPEST] for of, near in places.items() if not finalists.get(of)}
            self.runs.measure([training for near in some.values() for setting in near for training in setting.trainings()])
            finalists |= {(level, kind): self.finalists(level, near) for (level, kind), near in some.items()}
        return {of: finalists[of] for of in places}

    def near(self, level, kind):
        """Settings that may keep to the level, cheapest first."""
        return sorted((s for s in self.found() if kind in s.kinds() and self.may_pass(s, level)), key=self.time)

    def finalists(self, level, near):
        kept = [setting for setting in near if self.time(setting) <= NEAR * self.time(near[0])
                and verdicts.admitted(self.errors(setting), level)]
        return sorted(kept, key=lambda setting: self.time(setting, self.scene.samples))[:FINALISTS]

    def errors(self, setting):
        """On all draws; of several trainings the median, so that one that fails is out-voted."""
        return np.median([self.runs.of(other).error for other in setting.trainings()], axis=0)

    def useful_steps(self, level):
        """Those with which the direct solve may keep to the level, cheapest first."""
        every, _ = self.scene.steps()
        found = [step for step in every if self.may_pass(settings.direct(step), level)]
        return sorted(found, key=lambda step: self.time(settings.direct(step)))[:MOST_STEPS]

    def _search_ways(self, steps, limit_s):
        at = {(level, kind): Place(steps[level][0], self.axes[kind].first())
              for level in self.levels if steps[level] for kind in OF_CG}
        tried = [Place(place.step, way) for (_, kind), place in at.items() for way in self.axes[kind].screened()]
        for _ in range(MOST_ROUNDS):
            beside = {of: [Place(place.step, way) for way in self.axes[of[1]].beside(place.way)] +
                      [Place(step, place.way) for step in steps[of[0]]] for of, place in at.items()}
            self.runs.measure([place.setting() for place in tried + [one for some in beside.values() for one in some]],
                              samples=self.scene.few, limit_s=limit_s)
            tried += [place for some in beside.values() for place in some]
            moved = {(level, kind): self._cheapest(tried, level, kind) or place for (level, kind), place in at.items()}
            if moved == at:
                break
            at = moved

    def _cheapest(self, places, level, kind):
        found = [place for place in dict.fromkeys(places)
                 if kind in place.setting().kinds() and self.may_pass(place.setting(), level)]
        return min(found, key=lambda place: self.time(place.setting()), default=None)

    def reference(self):
        """{draws: bound of the median error of the reference}"""
        return {draws: float(f"{verdicts.upper_bound(self.runs.reference(draws)[1]):.3g}") for draws in (TUNING, TEST)}

    def tried(self):
        """{kind: number of settings}"""
        return {kind: sum(kind in setting.kinds() for setting in self.found()) for kind in KINDS if kind != OWN}

    def found(self):
        """All settings that ran on a few draws."""
        return [setting for setting, draws, samples in self.runs.known if draws == TUNING and samples == self.scene.few]
