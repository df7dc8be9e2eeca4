"""Content of a report's charts: the families of simulations of a file, the lines of each and their measures.

Simulations of a family share a chart. Those that try guesses have a line per guess and one for the direct solve of the
same systems; those that try none have a line per method. Every value is also one of spatial.py or summary.py. A
measure names the function that makes an estimate of its values.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rodsweep.drawing import looks
from rodsweep.reading import blocks, intervals, measures, timings

DIRECT = "direct"
SPEEDUPS = {"guess_cg": "speedup of guess and CG", "cg": "speedup of CG alone", "step": "speedup of the whole step"}
TIMES = {"guess_us": "time of the guess", "cg_us": "time of CG, or of the direct solve"}
# What is counted: its words, and the name and title of its ratio and of its number of a solve.
COUNTED = {"iterations": ("iterations", ("ratio", "CG ratio"), ("iterations", "CG iterations of a solve")),
           "matvecs": ("products with A, those of the guess included,", ("products_ratio", "CG ratio in products with A"),
                       ("products", "products with A of a solve"))}
OF_STEPS = ("length_drift", "joint_gap", "newton_residual", "penetration", "newton_iterations")    # in this order


@dataclass(frozen=True)
class Measure:
    name: str
    title: str
    unit: str            # how a value and its axis are written: ratio, times, us, count or part
    log: bool            # whether its axis is logarithmic
    values: dict         # {"first": …, "all": …}, or {"": …}, of [simulation, line] or [simulation, line, tolerance]
    estimate: Callable   # intervals.mean or intervals.median
    note: str = ""

    @property
    def tolerances(self):
        """Number of tolerances, 1 if it does not depend on them."""
        some = next(iter(self.values.values()))
        return some.shape[2] if some.ndim == 3 else 1


@dataclass(frozen=True)
class Family:
    name: str            # "guesses" or "methods"
    sims: measures.Simulations
    lines: dict          # {label: looks.Look}
    reference: str       # the line that others are compared with: "zero", or empty
    measures: list


def families(file, sims, guesses, tolerances):
    """The families that have simulations; guesses and tolerances are indices."""
    guessing = measures.has_guesses(file)[sims.any_task]
    found = [of_guesses(file, sims.subset(np.flatnonzero(guessing)), guesses, tolerances) if guessing.any() else None,
             of_methods(file, sims.subset(np.flatnonzero(~guessing))) if not guessing.all() else None]
    return [family for family in found if family is not None and family.measures]


def of_guesses(file, sims, guesses, tolerances):
    parts = timings.times(file, sims) if timings.timed(file) else {}
    direct = bool(parts) and bool(np.isfinite(parts["all"].direct_s).any())
    found = [*_ratios(file, sims, guesses, tolerances), *_times(file, parts, guesses, direct)]
    if sims.closed_loop:
        found += _steps(file, sims, guesses)
    of_all = looks.guess_looks(file.guesses)
    lines = {file.guesses[g]: of_all[file.guesses[g]] for g in guesses}
    if direct:
        lines[DIRECT] = looks.Look(*looks.KINDS[DIRECT])
    return Family("guesses", sims, lines, "zero" if file.zero in guesses else "", found)


def _ratios(file, sims, guesses, tolerances):
    if file.zero is None:
        return []
    chosen = np.ix_(range(len(sims)), guesses, tolerances)
    found = []
    for counted, (words, ratio, each) in COUNTED.items():
        counts = {newton: measures.cg_counts(file, sims, newton, counted) for newton in measures.NEWTON}
        if not np.isfinite(counts["first"].own).any():
            continue
        if guesses != [file.zero]:
            found.append(Measure(*ratio, "ratio", False, {newton: of.ratio[chosen] for newton, of in counts.items()},
                                 intervals.mean, f"The {words} with a guess over those from zero, summed over a simulation; "
                                 "mean over simulations. Below 1 the guess saves some."))
        found.append(Measure(*each, "count", False, {"": counts["first"].per_solve[chosen]}, intervals.mean,
                             "First Newton iterations; mean over a simulation, then over simulations."))
    return found


def _times(file, parts, guesses, with_direct):
    if not parts:
        return []
    found = []

    def beside(of_guesses, direct):
        """Columns of the guesses, and one of the direct solve if it was timed."""
        return np.column_stack([of_guesses[:, guesses], *([direct] if with_direct else [])])

    if file.zero is not None:
        over_zero = {newton: timings.speedups(parts, newton) for newton in measures.NEWTON}
        direct = {newton: timings.direct_speedups(parts, newton, file.zero) for newton in measures.NEWTON}
        for name, title in SPEEDUPS.items():
            of = {newton: beside(over_zero[newton][name], direct[newton][name]) for newton in measures.NEWTON}
            found.append(Measure(f"speedup_{name}", title, "times", True, {"": of["all"]} if name == "step" else of,
                                 intervals.median, "Time of CG from zero over the time with the guess, sums over a "
                                 "simulation; median over simulations." +
                                 (" All Newton iterations." if name == "step" else "")))
    us = {newton: blocks.per_solve_us(parts[newton]) for newton in measures.NEWTON}
    stand_in = 0 if file.zero is None else file.zero
    for name, title in TIMES.items():
        none = np.full(len(us["all"][name]), np.nan)
        of = {newton: beside(us[newton][name], us[newton]["direct_us"][:, stand_in] if name == "cg_us" else none)
              for newton in measures.NEWTON}
        found.append(Measure(name, title, "us", True, of, intervals.median,
                             "Mean time of a solve in a simulation; median over simulations."))
    return found


def _steps(file, sims, columns):
    figures = measures.step_figures(file, sims)
    found = []
    for name in OF_STEPS:
        values = figures[name][:, columns]
        if np.isfinite(values).any():
            found.append(Measure(name, measures.OF_STEPS[name].chart, "count" if name == "newton_iterations" else "part",
                                 bool(name != "newton_iterations" and np.nanmin(values) > 0), {"": values},
                                 intervals.median, "Median over simulations."))
    return found


def of_methods(file, sims):
    names = measures.without_guess(file, sims.any_task)
    labels = sorted(set(names.tolist()))
    mine = np.where(names[:, None] == np.array(labels), 1.0, np.nan)     # [simulation, line]
    found = []
    us = timings.direct_times(file, sims)["direct_us"]
    if np.isfinite(us).any():
        found.append(Measure("direct_us", "time of a direct solve", "us", True, {"": us * mine}, intervals.median,
                             "Mean over a simulation, all Newton iterations; median over simulations."))
    spread = [Measure(m.name, m.title, m.unit, m.log, {"": m.values[""] * mine}, m.estimate, m.note)
              for m in _steps(file, sims, [0])]
    return Family("methods", sims, looks.guess_looks(labels), "", found + spread)
