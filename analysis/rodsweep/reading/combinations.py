"""Solve times of all combinations of preconditioner and guess, and the fastest of each kind: for combinations.py.

A combination is a preconditioner, with the settings that the job sweeps, and a guess; or the direct solve. Paired
combinations solve the same systems, in a closed loop each has its own trajectory. The time is that of a solve with
guess and preconditioner set-up, or in a closed loop of a whole step. Kinds of guesses: CG from zero, classical ones,
learned ones, those of the user's plug-ins, and oracles, which know the solution. A paired oracle's own time is not
counted: it is a free guess.
"""

import os
from dataclasses import dataclass

import numpy as np

from rodsweep.reading import groups, intervals, measures, timings

PRECONDITIONER = "solve.preconditioner"
MODEL = "solve.learned_preconditioner.model"
SETTINGS = {"solve.fill_levels": "levels", "solve.lag_steps": "lag"}
AXES = (PRECONDITIONER, *SETTINGS)
WITH_LEVELS = ("block_icc", "condensed")
DIRECT, ZERO, CLASSICAL, LEARNED, OWN, ORACLE = KINDS = ("direct", "from zero", "classical guess", "learned guess",
                                                         "own guess", "free oracle")


@dataclass(frozen=True)
class Combination:
    """Values per draw, NaN if a simulation failed; iterations and products per solve [draw, tolerance]."""
    kind: str
    solver: str
    guess: str
    time_us: np.ndarray
    iterations: np.ndarray
    products: np.ndarray
    unreached: np.ndarray   # [tolerance] solves of all draws

    def text(self):
        return f"{self.solver} from {self.guess}" if self.guess else self.solver

    def timed(self):
        """The number of draws with a time: others failed."""
        return int((self.time_us > 0).sum())


@dataclass(frozen=True)
class Cell:
    """The combinations of one panel at one value of x, over the same draws."""
    x: str
    joints: float
    draws: np.ndarray
    combinations: list

    def cheapest(self, kind):
        """The fastest by the median over draws, among those that were timed in the most draws; None if none was."""
        there = [one for one in self.combinations if one.kind == kind and one.timed()]
        return min(there, key=lambda one: (-one.timed(), np.nanmedian(one.time_us))) if there else None


def kind_of(guess):
    if guess == "zero":
        return ZERO
    if "oracle" in guess:
        return ORACLE
    if "python" in guess or "plugin" in guess:
        return OWN
    return LEARNED if "copingnet" in guess or "knn" in guess else CLASSICAL


def panels(file, sims, x):
    """Panels by scene type and gridded keys except x and those of the preconditioner, each with the direct solve."""
    found = groups.with_direct(sims, groups.panels(file, sims, (x, *AXES)))
    # Titles omit keys of `solve` that are equal in all panels.
    same = {key for panel in found for key in panel.settings
            if key.startswith("solve.") and len({other.settings.get(key) for other in found}) == 1}
    return [panel.without(same) for panel in found]


def cells(file, sims, panel, x, newton, guesses):
    """[Cell] with these guesses, sorted by the number of joints."""
    measured = _Measured(file, sims, newton)
    codes = file.parameter(x).codes()[sims.any_task]
    found = []
    for code in np.unique(codes[panel.index]):
        rows = panel.index[codes[panel.index] == code]
        joints = file.results("joints", sims.any_task[rows])
        task = sims.any_task[rows[0]]
        found.append(Cell(file.parameter(x).text(task), float(np.median(joints)), np.unique(sims.sample[rows]),
                          measured.combinations(rows, guesses)))
    return sorted(found, key=lambda cell: cell.joints)


class _Measured:
    """Times and counts per simulation and guess, from which cells take their rows."""

    def __init__(self, file, sims, newton):
        self.file, self.sims = file, sims
        by_newton = timings.times(file, sims)
        times, whole = by_newton[newton], by_newton["all"]
        solves = times.solves
        if sims.closed_loop:
            steps = np.maximum(file.steps[sims.any_task], 1)[:, None]
            self.time_us = 1e6 * (whole.assemble_s + whole.guess_s + whole.cg_s + whole.rest_s) / steps
        else:
            own = np.array([kind_of(guess) != ORACLE for guess in file.guesses])
            self.time_us = measures.quotient(1e6 * (np.where(own, times.guess_s, 0) + times.cg_s), solves)
        self.direct_us = self._direct_us(times)
        self.iterations, self.unreached = self._per_solve("iterations", newton, solves)
        self.products, _ = self._per_solve("matvecs", newton, solves)

    def _per_solve(self, counted, newton, solves):
        ratios = measures.cg_counts(self.file, self.sims, newton, counted)
        return measures.quotient(ratios.own, solves[..., None]), ratios.unreached

    def _direct_us(self, times):
        """[simulation]"""
        if not self.sims.closed_loop:
            zero = self.file.zero or 0
            return measures.quotient(1e6 * times.direct_s[:, zero], times.solves[:, zero])
        return timings.direct_step_us(self.file, self.sims)

    def combinations(self, rows, guesses):
        draws = np.unique(self.sims.sample[rows])
        guessing = rows[measures.has_guesses(self.file)[self.sims.any_task[rows]]]
        solvers = {}
        for row in guessing:
            text = preconditioner_text(self.file, self.sims.any_task[row])
            solvers.setdefault(text.replace("_", " "), []).append(row)
        found = [self._direct(rows, guessing, draws)]
        for solver, members in solvers.items():
            found += [self._of(draws, np.array(members), solver, g) for g in guesses]
        return [one for one in found if np.isfinite(one.time_us).any()]

    def _direct(self, rows, guessing, draws):
        """The direct solve. In a paired sweep simulations of all preconditioners time it: the median counts."""
        from_rows = guessing if not self.sims.closed_loop else np.setdiff1d(rows, guessing)
        time_us = np.full(len(draws), np.nan)
        for k, draw in enumerate(draws):
            of_draw = self.direct_us[from_rows[self.sims.sample[from_rows] == draw]]
            if np.isfinite(of_draw).any():
                time_us[k] = np.nanmedian(of_draw)
        empty = np.full((len(draws), len(self.file.tolerances)), np.nan)
        return Combination(DIRECT, "direct", "", time_us, empty, empty, np.zeros(len(self.file.tolerances)))

    def _of(self, draws, rows, solver, g):
        at = np.searchsorted(draws, self.sims.sample[rows])

        def by_draw(values):
            spread = np.full((len(draws), *values.shape[1:]), np.nan)
            spread[at] = values
            return spread

        guess = self.file.guesses[g]
        return Combination(kind_of(guess), solver, guess, by_draw(self.time_us[rows, g]),
                           by_draw(self.iterations[rows, g]), by_draw(self.products[rows, g]),
                           np.nansum(self.unreached[rows, g], axis=0))


def preconditioner_text(file, task):
    """A preconditioner with its settings that the job sweeps, and the name of its model."""
    name_of = file.parameters[PRECONDITIONER].text(task)
    swept = [f"{name} {file.parameters[key].text(task)}" for key, name in SETTINGS.items()
             if key in file.parameters and file.parameters[key].swept and file.parameters[key].applies()[task]
             and (name_of in WITH_LEVELS if name == "levels" else file.parameters[key].values[task] > 0)]
    model = [os.path.basename(str(file.parameters[MODEL].values[task])).removesuffix(".h5")] if name_of == "learned" else []
    return " ".join([name_of, *model, *swept])


def speedup(slower, faster, draws):
    """Estimate of the time of one combination over that of a faster one: the median over draws."""
    return intervals.median(measures.quotient(slower.time_us, faster.time_us), draws)


def ratio(one, zero, draws, tolerance):
    """Estimate of the CG ratio of a combination at a tolerance: the mean over draws."""
    return intervals.mean(measures.quotient(one.iterations[:, tolerance], zero.iterations[:, tolerance]), draws)
