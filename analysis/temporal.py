#!/usr/bin/python3
"""CG ratio and iterations of guesses over the simulated time.

  cg-ratio-in-time    CG iterations relative to the zero guess, a panel per tolerance
  iterations-in-time  CG iterations of a solve, zero guess included

The script is meant for simulations that share their fixed parameters (the temporal study of Shao et al. 2021: one
scene, many samples). Iterations are summed over simulations and over a window of steps around each point (--window, by
default a twentieth of the run); the ratio is that of the sums. Bands are 95 % bootstrap intervals over simulations.
Each scene type and value of any grid of the job has a row of panels. The file needs /solves (record.solves "all").
Writes PDF and PNG and prints the paths.
"""

import numpy as np
from matplotlib.ticker import MaxNLocator

from rodsweep.drawing import layout, study, style
from rodsweep.reading import along_time, commandline, groups, intervals, measures
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/temporal.py results/temporal_bending.h5
  analysis/temporal.py results/temporal_helix.h5 --tolerance 1e-2 --guess zero,previous,quadratic --newton all
  analysis/temporal.py results/spatial_bending.h5 --select scene.segments=30 --window 1"""


def arguments():
    made = study.parser(__doc__, EXAMPLES)
    made.add_argument("--window", metavar="STEPS", type=commandline.whole_number,
                      help="steps per window, 1 for no smoothing (default: a twentieth of the run)")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown = study.of_guesses(file, options)
        if not along_time.recorded(file):
            raise KeyNotFound(f"{file.path} has no rows of single solves (record.solves is \"summary\"), which this "
                              "script needs")
        tolerances = commandline.chosen_tolerances(file, options)
        panels = groups.panels(file, shown.sims)
        columns = sorted({*shown.guesses, file.zero})
        found = [along_time.windows(file, shown.sims.subset(panel.index), options.newton, columns, tolerances,
                                    options.window) for panel in panels]
        made = {"cg-ratio-in-time": figure(shown, panels, found, columns, tolerances, relative=True),
                "iterations-in-time": figure(shown, panels, found, columns, tolerances, relative=False)}
        study.save(file, options, made, [f"window{options.window}" if options.window else ""])


def estimate(sims, windows, zero, relative):
    """[window, guess, tolerance]: iterations over those from zero, or per solve; sums over simulations."""
    found = []
    for k in range(windows.iterations.shape[-1]):   # one tolerance at a time: the bootstrap copies its input
        counts = windows.iterations[..., k]
        per = counts[:, :, [zero]] if relative else windows.solves
        found.append(intervals.ratio_of_sums(counts, np.broadcast_to(per, counts.shape), sims.sample))
    return intervals.Estimate(*(np.stack([getattr(e, name) for e in found], axis=-1)
                                for name in ("value", "low", "high", "count")))


def figure(shown, panels, found, columns, tolerances, relative):
    file = shown.file
    zero = columns.index(file.zero)
    lines = [g for g in shown.guesses if not (relative and g == file.zero)]
    estimates = [estimate(shown.sims.subset(panel.index), windows, zero, relative)
                 for panel, windows in zip(panels, found)]
    widths = " / ".join(dict.fromkeys(str(windows.width) for windows in found))
    what = "Iterations with a guess ÷ from zero, sums" if relative else "Iterations of a solve, mean"
    steps = "step" if widths == "1" else "steps"
    notes = [f"{what} over a window of {widths} {steps} (shorter at the ends) and over "
             f"{study.sample_text(estimates, mark='bands')}. Counted: {measures.NEWTON[shown.newton]}."]
    if any(windows.unreached[:, columns.index(g)].any() for windows in found for g in lines):
        notes.append("Open markers: some solves of the window missed the tolerance (iteration limit or divergence). "
                     "They count with the mean iterations of such solves in their simulation.")
    page = layout.Page(shown.width_mm, [panel.caption() for panel in panels], len(tolerances),
                       layout.even_columns(len(tolerances), 2 if shown.wide else 1), 38 if shown.wide else 32,
                       shown.handles(lines, "zero guess (= 1)" if relative else ""), notes + [shown.about()])
    for row, (panel, windows, e) in enumerate(zip(panels, found, estimates)):
        at = [columns.index(g) for g in lines]
        tops = [_top(e[:, at, k]) for k in range(len(tolerances))]
        x, label = shown.time_axis(shown.sims.any_task[panel.index], windows.centre)
        for k, axes in enumerate(page.axes[row]):
            if relative:
                axes.axhline(1, zorder=1.5, **style.ZERO_LINE)
            for rank, g in enumerate(lines):
                at = columns.index(g)
                draw(axes, x, e[:, at, k], shown.style(g), windows.unreached[:, at, k] > 0, rank, len(lines))
            line = k - k % page.columns
            axes.set_ylim(0, max(tops[line:line + page.columns]))
            axes.set_xlim(0, 1.01 * x[-1])
            axes.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
            axes.set_title("tolerance " + style.tolerance_text(file.tolerances[tolerances[k]]))
            page.label_y(axes, k, "CG ratio" if relative else "CG iterations")
        page.label_x(row, label)
    return page


def _top(e):
    """Upper end of an axis: it includes all lines, and bands up to 1.5 times the highest line."""
    value, high = (float(np.nanmax(part)) if np.isfinite(part).any() else 1.0 for part in (e.value, e.high))
    return 1.06 * max(1.0, value, min(high, 1.5 * value))


def draw(axes, x, e, guess_style, hollow, rank, count):
    """A line with its band and some markers. Markers are open where solves missed the tolerance."""
    every = max(1, len(x) // 8)
    colour = guess_style.colour
    axes.fill_between(x, e.low, e.high, color=colour, alpha=0.15, linewidth=0)
    axes.plot(x, e.value, color=colour, linestyle=guess_style.dash)
    marked = np.zeros(len(x), dtype=bool)
    marked[(rank * every) // max(1, count)::every] = True
    for some, face in ((marked & ~hollow, colour), (marked & hollow, "white")):
        axes.plot(x[some], e.value[some], linestyle="", marker=guess_style.marker, color=colour, markerfacecolor=face,
                  markeredgewidth=0.8)


if __name__ == "__main__":
    commandline.run(main)
