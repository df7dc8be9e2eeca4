"""The numbers of heatmap.py: one measure of every guess in every cell of a plane of two parameters.

A plane is a panel of simulations (groups.py). Its cells are the combinations of the values along x and y. The axis
`tolerance` has the file's tolerances, for measures with iterations to all of them.
"""

from dataclasses import dataclass

import numpy as np

from rodsweep.reading import groups, intervals, measures, texts, timings
from rodsweep.reading.errors import KeyNotFound

LADDER = "tolerance"


@dataclass(frozen=True)
class Measure:
    """A measure for cells. `better`: -1 if values below 1 are better, 1 if values above 1 are; 0: no comparison."""
    label: str
    explained: str
    better: int
    statistic: str           # over simulations: mean or median
    ladder: bool = False     # whether it has a value for every tolerance
    of_guess: bool = True    # whether it depends on the guess; if not, it is of a trajectory or of zero
    timed: bool = False


MEASURES = {
    "ratio": Measure("CG ratio", "Iterations with a guess ÷ from zero, summed over a simulation", -1, "mean", True),
    "matvec-ratio": Measure("ratio of products with A", "Products with A (of CG and of the guess) with a guess ÷ from "
                            "zero, summed over a simulation", -1, "mean", True),
    "other-norm-ratio": Measure("CG ratio in the other norm", "Iterations with a guess ÷ from zero, summed over a "
                                "simulation, to the residual in the norm that the job does not use", -1, "mean", True),
    "iterations": Measure("CG iterations from zero", "Iterations of a solve from zero, mean over a simulation", 0,
                          "mean", True, False),
    **{f"speedup-{name}".replace("_", "-"):
       Measure(f"speedup, {text}", f"Time of zero-guess CG ÷ time of the method ({text}), sums over a simulation", 1,
               "median", timed=True) for name, text in timings.SPEEDUPS.items()},
    "newton-residual": Measure("Newton residual", "Largest Newton residual at the end of a step of a simulation", 0,
                               "median", of_guess=False),
    "joint-gap": Measure("joint gap / length", "Largest joint gap at the end of a step of a simulation", 0, "median",
                         of_guess=False),
}


@dataclass(frozen=True)
class Plane:
    """Cells [y, x]; guess is -1 in an empty cell and for a measure that does not depend on the guess."""
    panel: groups.Panel
    x: groups.Points
    y: groups.Points
    cells: intervals.Estimate
    guess: np.ndarray
    unreached: np.ndarray    # solves of the cell's guess or of zero that missed the tolerance


def per_simulation(shown, name, tolerances):
    """[simulation, guess, tolerance] values and solves that missed the tolerance; unused axes have length 1."""
    file, sims, newton = shown.file, shown.sims, shown.newton
    none = np.zeros((len(sims), 1, 1))
    if MEASURES[name].ladder:
        counted, norm = {"matvec-ratio": ("matvecs", ""), "other-norm-ratio": ("iterations", "other_norm")}.get(
            name, ("iterations", ""))
        if norm and newton != "first":
            raise KeyNotFound(f"--measure {name} counts only first Newton iterations: remove --newton all")
        ratios = measures.cg_counts(file, sims, newton, counted, norm)
        if not np.isfinite(ratios.ratio).any():
            raise KeyNotFound(f"{file.path} has no counts for --measure {name}")
        missed = np.nan_to_num(ratios.unreached) + np.nan_to_num(ratios.unreached_zero)
        if name != "iterations":
            return ratios.ratio[:, :, tolerances], missed[:, :, tolerances]
        if newton != "first":
            raise KeyNotFound("--measure iterations counts only first Newton iterations: remove --newton all")
        return (part[:, [file.zero]][:, :, tolerances] for part in (ratios.per_solve, ratios.unreached))
    if MEASURES[name].timed:
        if not timings.timed(file):
            raise KeyNotFound(f"{file.path} has no times of single solves (record.solves is \"summary\")")
        found = timings.speedups(timings.times(file, sims), newton)[name.split("-", 1)[1].replace("-", "_")]
        return found[..., None], np.zeros(found.shape + (1,))
    values = measures.step_figures(file, sims)[name.replace("-", "_")]
    column = shown.guesses[0] if sims.closed_loop else 0
    return values[:, [column], None], none


def tolerance_points(file, tolerances):
    """The tolerances as points along an axis; each holds for all simulations."""
    order = np.argsort(file.tolerances[tolerances])
    values = file.tolerances[tolerances][order]
    return groups.Points(values, [texts.tolerance_label(value) for value in values], list(order), True, False)


def planes(shown, name, x, y, guesses, tolerances):
    """A Plane per scene type and value of any other grid. A cell has the best of `guesses`, if the measure needs
    one."""
    file, measure = shown.file, MEASURES[name]
    keys = tuple(key for key in (x, y) if key != LADDER)
    panels = groups.panels(file, shown.sims, keys, most=None)
    values, missed = per_simulation(shown, name, tolerances)
    columns = [0] if values.shape[1] == 1 else guesses
    found = []
    for panel in panels:
        along = {key: tolerance_points(file, tolerances) if key == LADDER else
                 groups.points(file, shown.sims, panel, key) for key in (x, y)}
        shape = (len(along[y].index), len(along[x].index))
        parts, best, unreached = np.full(shape + (4,), np.nan), np.full(shape, -1), np.zeros(shape)
        for cell in np.ndindex(shape):
            rows, t = _members(panel, along, {y: cell[0], x: cell[1]})
            if not len(rows):
                continue
            of = intervals.mean if measure.statistic == "mean" else intervals.median
            e = of(values[rows][:, columns, t], shown.sims.sample[rows])
            if not np.isfinite(e.value).any():
                continue
            k = int(np.nanargmax(e.value) if measure.better > 0 else np.nanargmin(e.value))
            parts[cell] = e.value[k], e.low[k], e.high[k], e.count[k]
            unreached[cell] = missed[rows][:, columns[k], t].sum()
            best[cell] = columns[k] if measure.of_guess else -1
        cells = intervals.Estimate(*parts[..., :3].transpose(2, 0, 1), np.nan_to_num(parts[..., 3]).astype(int))
        found.append(Plane(panel, along[x], along[y], cells, best, unreached))
    return found


def _members(panel, along, at):
    """Simulations of a cell and the index of its tolerance."""
    rows, t = panel.index, 0
    for key, k in at.items():
        if key == LADDER:
            t = along[key].index[k]
        else:
            rows = np.intersect1d(rows, along[key].index[k])
    return rows, t


def comparable(file, guesses):
    """Guesses among which the best is chosen: without zero and the oracle, which knows the solution."""
    return [g for g in guesses if g != file.zero and not texts.kind_of(file.guesses[g]).startswith("oracle")]
