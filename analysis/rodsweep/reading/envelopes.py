"""Long runs, step by step, in bounded memory: envelopes of a few quantities and fits of the length drift, with the table
of long_term.py.

A failed run is included up to its last good step.

Steps go into buckets of equal width (or equal ratio of times). Each bucket keeps its smallest and largest value, so no
spike is lost in a run of any length. Drift per 1000 steps is the slope of a least-squares line through all steps from
`begin` on. A *history* is one task: of a guess in a closed loop, or of the direct solve.
"""

from dataclasses import dataclass

import numpy as np

from rodsweep.reading import intervals, texts
from rodsweep.reading.texts import number_text

MOST_BUCKETS = 240
FEWEST_BUCKETS = 10
BUDGET_BYTES = 96 << 20
QUANTITIES = ("length_drift", "joint_gap", "energy_j", "momentum_kg_m_s", "angular_momentum_kg_m2_s")
ENERGIES = ("kinetic_energy_j", "potential_energy_j", "elastic_energy_j")
# Of the table of long_term.py.
COLUMNS = ("scene", "settings", "method", "simulations", "failed", "failed_after_steps", "length_drift_largest",
           "length_drift_final", "drift_per_1000_steps", "drift_per_1000_steps_low", "drift_per_1000_steps_high",
           "joint_gap_largest")


@dataclass(frozen=True)
class Histories:
    """[task] or [task, bucket] over `tasks`; NaN where nothing was recorded."""
    tasks: np.ndarray
    edges: np.ndarray        # steps at which buckets begin, and the end
    low: dict                # quantity: smallest of the bucket
    high: dict
    largest: dict            # quantity: largest magnitude of the run
    first: dict              # quantity: at the first step
    final: dict              # quantity: at the last step
    slope: np.ndarray        # of the length drift, per 1000 steps
    reached: np.ndarray      # recorded steps: fewer than requested if the run failed
    largest_kinetic: np.ndarray

    def rows(self, tasks):
        """Row numbers of these tasks."""
        return np.searchsorted(self.tasks, tasks)


def edges(steps, tasks, logarithmic):
    """Steps at which buckets begin: as many buckets as the budget allows."""
    per_bucket = tasks * len(QUANTITIES) * 2 * 4
    buckets = min(steps, MOST_BUCKETS, max(FEWEST_BUCKETS, BUDGET_BYTES // per_bucket))
    even = np.geomspace(1, steps + 1, buckets + 1) - 1 if logarithmic else np.linspace(0, steps, buckets + 1)
    return np.unique(np.round(even).astype(int))


def recorded(file):
    """The quantities that the file has."""
    return [name for name in QUANTITIES if all(file.has(f"/steps/{part}") for part in _parts(name))]


def _parts(name):
    return ENERGIES if name == "energy_j" else (name,)


def histories(file, tasks, begin=0, logarithmic=False):
    """The Histories of complete tasks; `begin` is the first step of the fit."""
    tasks = np.unique(tasks)
    at = edges(int(file.steps[tasks].max()), len(tasks), logarithmic)
    names = recorded(file)
    paths = sorted({f"/steps/{part}" for name in names for part in _parts(name)})
    shape = (len(tasks), len(at) - 1)
    low = {name: np.full(shape, np.nan, dtype=np.float32) for name in names}
    high = {name: np.full(shape, np.nan, dtype=np.float32) for name in names}
    largest, first, final = ({name: np.full(len(tasks), np.nan) for name in names} for _ in range(3))
    kinetic, sums = np.full(len(tasks), np.nan), np.zeros((len(tasks), 5))
    done, reached = np.zeros(len(tasks), dtype=int), np.zeros(len(tasks), dtype=int)
    for owners, starts, rows in file.step_blocks(tasks, paths):
        owner = np.searchsorted(tasks, owners)
        sizes = np.diff(np.append(starts, len(rows[paths[0]])))
        step = np.arange(sizes.sum()) - np.repeat(starts - done[owner], sizes)
        done[owner] += sizes
        whose = np.repeat(owner, sizes)
        bucket = np.searchsorted(at, step, side="right") - 1
        for name in names:
            values = _values(name, rows)
            there = np.isfinite(values)
            w, b, v = whose[there], bucket[there], values[there]
            np.maximum.at(reached, w, step[there] + 1)
            np.fmin.at(low[name], (w, b), v)
            np.fmax.at(high[name], (w, b), v)
            np.fmax.at(largest[name], w, np.abs(v))
            at_first = step[there] == 0
            first[name][w[at_first]] = v[at_first]
            final[name][w] = v     # the last step of a task is written last
            if name == "energy_j":
                np.fmax.at(kinetic, w, rows["/steps/kinetic_energy_j"][there])
            if name == "length_drift":
                fitted = step[there] >= begin
                _add_to_fit(sums, w[fitted], step[there][fitted], v[fitted])
    return Histories(tasks, at, low, high, largest, first, final, _slope(sums), reached, kinetic)


def _values(name, rows):
    if name == "energy_j":
        return sum(rows[f"/steps/{part}"] for part in ENERGIES)
    values = rows[f"/steps/{name}"]
    return np.linalg.norm(values, axis=1) if values.ndim > 1 else values


def _add_to_fit(sums, whose, step, values):
    for k, part in enumerate((np.ones(len(step)), step, step.astype(float) ** 2, values, step * values)):
        np.add.at(sums[:, k], whose, part)


def _slope(sums):
    """Least squares, per 1000 steps; NaN with fewer than two steps."""
    n, x, xx, y, xy = sums.T
    below = n * xx - x * x
    return np.divide(1000 * (n * xy - x * y), below, out=np.full(len(n), np.nan), where=below > 0)


def records(panels, series, found, sims, ok):
    """One per panel and method. Largest and final: of the worst simulation. The slope: median over simulations that
    are `ok` (mask of tasks), with its interval. Steps before a failure: median over the others."""
    for panel, methods_of in zip(panels, series):
        settings = "; ".join(f"{key}={value}" for key, value in panel.settings.items())
        for method, (_, tasks, rows) in methods_of.items():
            at, well = found.rows(tasks), ok[tasks]
            slope = intervals.median(found.slope[at[well]], sims.sample[rows[well]])
            final = found.final["length_drift"][at]
            yield {"scene": panel.scene, "settings": settings, "method": method, "simulations": len(rows),
                   "failed": int((~well).sum()),
                   "failed_after_steps": np.nan if well.all() else float(np.median(found.reached[at[~well]])),
                   "length_drift_largest": np.fmax.reduce(found.largest["length_drift"][at]),
                   "length_drift_final": final[np.argmax(np.nan_to_num(np.abs(final)))],
                   "drift_per_1000_steps": float(slope.value), "drift_per_1000_steps_low": float(slope.low),
                   "drift_per_1000_steps_high": float(slope.high),
                   "joint_gap_largest": np.fmax.reduce(found.largest["joint_gap"][at])}


def lines(panels, series, found, sims, ok, begin):
    titles = {panel.title() for panel in panels}
    rows = [["", "n", "failed", "after steps", "largest |drift|", "final drift", "drift per 1000 steps", "largest gap"]]
    every = iter(records(panels, series, found, sims, ok))
    for panel, methods_of in zip(panels, series):
        if len(titles) > 1:
            rows.append([panel.title()] + [""] * 7)
        for _ in methods_of:
            r = next(every)
            low, high = (r[f"drift_per_1000_steps_{end}"] for end in ("low", "high"))
            interval = "" if np.isnan(low) else f" [{number_text(low)}, {number_text(high)}]"
            rows.append([f"  {r['method']}", str(r["simulations"]), str(r["failed"]), number_text(r["failed_after_steps"]),
                         number_text(r["length_drift_largest"]), number_text(r["length_drift_final"]),
                         number_text(r["drift_per_1000_steps"]) + interval, number_text(r["joint_gap_largest"])])
    heading = [f"Largest and final drift, largest gap: of the worst simulation. Drift per 1000 steps: slope from step "
               f"{begin} on, median over simulations that did not fail [95 % interval]. After steps: median number of "
               "steps of the others.", ""]
    return heading + texts.aligned(rows)
