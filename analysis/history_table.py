"""The table of long_term.py: how far the length and the joints of each method went, as text and as CSV."""

import csv

import numpy as np

import commandline
import intervals
from style import number_text

COLUMNS = ("scene", "settings", "method", "simulations", "failed", "length_drift_largest", "length_drift_final",
           "drift_per_1000_steps", "drift_per_1000_steps_low", "drift_per_1000_steps_high", "joint_gap_largest")


def records(panels, series, found, sims, failed):
    """One per panel and method. Largest and final: of the worst simulation; the slope: median with its interval."""
    for panel, methods_of in zip(panels, series):
        settings = "; ".join(f"{key}={value}" for key, value in panel.settings.items())
        for method, (_, tasks, rows) in methods_of.items():
            at = found.rows(tasks)
            slope = intervals.median(found.slope[at], sims.sample[rows])
            final = found.final["length_drift"][at]
            yield {"scene": panel.scene, "settings": settings, "method": method, "simulations": len(rows),
                   "failed": failed.get((panel.scene, method), (0, 0))[0],
                   "length_drift_largest": np.fmax.reduce(found.largest["length_drift"][at]),
                   "length_drift_final": final[np.argmax(np.nan_to_num(np.abs(final)))],
                   "drift_per_1000_steps": float(slope.value), "drift_per_1000_steps_low": float(slope.low),
                   "drift_per_1000_steps_high": float(slope.high),
                   "joint_gap_largest": np.fmax.reduce(found.largest["joint_gap"][at])}


def lines(panels, series, found, sims, failed, begin):
    titles = {panel.title() for panel in panels}
    rows = [["", "n", "failed", "largest |drift|", "final drift", "drift per 1000 steps", "largest gap"]]
    every = iter(records(panels, series, found, sims, failed))
    for panel, methods_of in zip(panels, series):
        if len(titles) > 1:
            rows.append([panel.title()] + [""] * 6)
        for _ in methods_of:
            r = next(every)
            interval = "" if np.isnan(r["drift_per_1000_steps_low"]) else (
                f" [{number_text(r['drift_per_1000_steps_low'])}, {number_text(r['drift_per_1000_steps_high'])}]")
            rows.append([f"  {r['method']}", str(r["simulations"]), str(r["failed"]),
                         number_text(r["length_drift_largest"]), number_text(r["length_drift_final"]),
                         number_text(r["drift_per_1000_steps"]) + interval, number_text(r["joint_gap_largest"])])
    heading = [f"Largest and final drift, largest gap: of the worst simulation. Drift per 1000 steps: slope from step "
               f"{begin} on, median over simulations [95 % interval].", ""]
    return heading + commandline.aligned(rows)


def write_csv(out, panels, series, found, sims, failed):
    writer = csv.DictWriter(out, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for record in records(panels, series, found, sims, failed):
        writer.writerow({key: "" if value != value else value for key, value in record.items()})
