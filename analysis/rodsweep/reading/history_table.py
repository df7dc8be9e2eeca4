"""The table of long_term.py: length drift and joint gap of each method, as text and as CSV."""

import numpy as np

from rodsweep.reading import intervals, texts
from rodsweep.reading.texts import number_text

COLUMNS = ("scene", "settings", "method", "simulations", "failed", "failed_after_steps", "length_drift_largest",
           "length_drift_final", "drift_per_1000_steps", "drift_per_1000_steps_low", "drift_per_1000_steps_high",
           "joint_gap_largest")


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
