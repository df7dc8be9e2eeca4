"""Results of a sweep for the page's first lines: the numbers of summary.py's tables, and sentences about them.

An Answer is about one block (a scene type and gridded settings). The oracle, a guess that solves the system itself, is
in the table but cannot be the best. Numbers are formatted as in the table.
"""

import math
from dataclasses import dataclass

import numpy as np

from rodsweep.reading import blocks, texts, timings

DOT_WIDTH, BAR_WIDTH = 96, 120    # of the drawings in the table, in pixels


@dataclass(frozen=True)
class Row:
    """A guess or the direct solve. Keys: ratio and all (of iterations), products and all_products, the SPEEDUPS over CG
    from zero, and those over the direct solve with over_direct_ before the name."""
    label: str
    wins: bool         # whether it can be the best: not the oracle
    reached: bool      # whether all its solves reached the tolerance; only then it can have the fewest iterations
    texts: dict        # as summary.py writes them
    sort: dict         # the numbers of the texts, NaN where there is none
    estimates: dict    # of those that have an interval
    parts: dict        # the time of guess and CG, or of the direct solve, over CG from zero: the inverse of the speedup


@dataclass(frozen=True)
class Answer:
    block: blocks.Block
    title: str
    simulations: str
    missed: bool             # whether any solve missed the tolerance
    rows: list
    zero_us: str             # median time of CG from zero, of a solve
    fewest: Row = None       # of iterations
    leanest: Row = None      # the fewest products
    fastest: Row = None      # guess and CG
    whole: Row = None        # the whole step
    direct: Row = None

    @property
    def few(self):
        """Whether there are too few simulations for intervals."""
        return not any(math.isfinite(row.estimates["ratio"].low) for row in self.rows if "ratio" in row.estimates)

    @property
    def rivals(self):
        return sum(row.wins and row.reached for row in self.rows)

    def sorted(self):
        """By iterations; the direct solve, which has none, comes last."""
        return sorted(self.rows, key=lambda row: row.sort.get("ratio", math.inf))

    def at(self, ratio):
        """Position of a CG ratio in its drawing, in pixels."""
        highest = max([1.1] + [1.02 * row.sort["ratio"] for row in self.rows if "ratio" in row.sort])
        return round(5 + (DOT_WIDTH - 10) * min(ratio / highest, 1), 1)

    def bars(self, row):
        """(name, left edge, width) of Row.parts, in pixels; all rows of an answer have one scale."""
        longest = max((sum(other.parts.values()) for other in self.rows if math.isfinite(sum(other.parts.values()))),
                      default=math.nan)
        found, left = [], 0.0
        for name, time in row.parts.items():
            width = BAR_WIDTH * time / longest if longest > 0 else math.nan
            if math.isfinite(width):
                found.append((name, round(left, 1), round(max(width, 0.4), 1)))
                left += width
        return found


def answers(file, found, guesses, tolerance):
    """One per Block of `found` that has CG ratios, at a tolerance (an index)."""
    return [_answer(file, block, guesses, tolerance) for block in found if block.ratio is not None]


def tried(found):
    """A sentence on how the guesses of some Answers were tried, for readers who do not know it."""
    loops = [answer.block.sims.closed_loop for answer in found]
    direct = [answer.direct is not None for answer in found]
    how = "was tried on the same systems" if not all(loops) else "advanced its own simulations"
    if any(loops) and not all(loops):
        how += ", or in closed loops advanced its own simulations,"
    timed = any(answer.block.times is not None for answer in found)
    what = "its iterations and time were measured" if timed else "its iterations were counted"
    beside = "" if not any(direct) else f",{'' if all(direct) else ' in part'} with a direct solve for comparison"
    return f"Each guess {how} and {what}{beside}."


def headline_tolerance(file, sims, tolerances):
    """Index of the tolerance of the timed solves if it is shown, else of 1e-2, else of the first."""
    timed = timings.timed_rung(file)[sims.tasks()]
    wanted = [int(np.bincount(timed).argmax())]
    wanted += [k for k in tolerances if abs(math.log10(file.tolerances[k]) + 2) < 1e-6]
    return next((k for k in wanted if k in tolerances), tolerances[0])


def _answer(file, block, guesses, t):
    rows = [_row(file, block, g, t) for g in guesses]
    direct = _direct(file, block)
    missed = any(block.unreached[g, t] for g in {*guesses, file.zero})
    reached = [row for row in rows if row.reached]
    zero_us = texts.fixed_text(block.times["cg_us"].value[file.zero], 1) if block.times else "-"
    return Answer(block, block.title, texts.simulations_text(block.ratio.count[guesses]), missed,
                  rows + ([direct] if direct else []), zero_us, _best(reached, "ratio", min),
                  _best(reached, "products", min), _best(rows, "guess_cg", max), _best(rows, "step", max), direct)


def _best(rows, name, better):
    there = [row for row in rows if row.wins and math.isfinite(row.sort.get(name, math.nan))]
    return better(there, key=lambda row: row.sort[name]) if there else None


def _row(file, block, g, t):
    label, zero = file.guesses[g], g == file.zero
    estimates = {"ratio": block.ratio[g, t]}
    beside = {name: estimate[g, t] for name, estimate in (block.beside or {}).items()}
    estimates.update(beside)
    if block.speedup:
        estimates.update({name: block.speedup[name][g] for name in timings.SPEEDUPS})
        estimates.update({f"over_direct_{name}": block.speedup_over_direct[name][g] for name in timings.SPEEDUPS})
    shown = {name: texts.interval_text(estimate) for name, estimate in estimates.items()}
    sort = {name: float(estimate.value) for name, estimate in estimates.items()}
    shown.update({name: texts.fixed_text(sort[name], 2) for name in beside})
    if zero:    # the reference of all others
        shown.update({name: "1" for name in ("ratio", *beside, *timings.SPEEDUPS)
                      if math.isfinite(sort.get(name, math.nan))})
    elif block.unreached[g, t] or block.unreached[file.zero, t]:
        shown["ratio"] += "*"
    parts = {}
    if sort.get("guess_cg", 0) > 0:
        guess = float(block.guess_share[g])
        parts = {"guess": guess / sort["guess_cg"], "cg": (1 - guess) / sort["guess_cg"]}
    return Row(label, not zero and "oracle" not in label, not block.unreached[g, t], shown, sort, estimates, parts)


def _direct(file, block):
    if not block.direct_speedup or not math.isfinite(block.times["direct_us"].value[file.zero]):
        return None
    shown = {name: texts.interval_text(estimate) for name, estimate in block.direct_speedup.items()}
    sort = {name: float(estimate.value) for name, estimate in block.direct_speedup.items()}
    return Row("direct", False, True, shown, sort, dict(block.direct_speedup), {"direct": 1 / sort["guess_cg"]})
