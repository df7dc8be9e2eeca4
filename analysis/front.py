#!/usr/bin/python3
"""CG ratio over the time of a guess, per segment and solve.

A row of panels per scene type and value of any other grid, a panel per tolerance. CG ratios are means over
simulations, times are medians; whiskers are 95 % bootstrap intervals. The grey line is the Pareto front. On the dashed
line, guess and CG take as long as with the best classical guess; a guess below it is faster. The line assumes that an
iteration takes as long as from zero, and leaves out deflation, whose iterations take longer. It is drawn if the
panel's tolerance is that of the timed solves. The file needs times and a zero guess. Prints the table, writes PDF and
PNG, and prints the paths.
"""

import numpy as np
from matplotlib.lines import Line2D

from rodsweep.drawing import layout, study, style
from rodsweep.reading import commandline, groups, intervals, measures, remarks, texts, timings
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/front.py results/learned_rods.h5 --tolerance 1e-2,1e-3
  analysis/front.py results/learned_rods.h5 --scene helix --newton all"""
# Words in labels of guesses that are not classical; deflation makes iterations longer.
OTHERS = ("copingnet", "knn", "oracle", "deflation")


def main():
    options = study.parser(__doc__, EXAMPLES).parse_args()
    with SweepFile(options.file) as file:
        shown = study.of_guesses(file, options)
        if not timings.timed(file):
            raise KeyNotFound(f"{file.path} has no times, so the cost of guesses is not known")
        tolerances = commandline.chosen_tolerances(file, options)
        panels = groups.panels(file, shown.sims, None, pooled="scene.", most=None)
        found = [estimates(shown, panel.index) for panel in panels]
        if not any((guess.value[shown.lines()] > 0).any() for _, guess, _ in found):
            raise KeyNotFound(f"{file.path} has no times above 0, so the cost of guesses is not known")
        print("\n".join(table(shown, panels, found, tolerances)) + "\n")
        study.save(file, options, {"front": figure(shown, panels, found, tolerances)})


def estimates(shown, index):
    """(ratio [guess, tolerance], time [us] per segment and solve of guesses [guess] and of CG from zero) of
    simulations."""
    file, sims = shown.file, shown.sims.subset(index)
    ratio = intervals.mean(measures.cg_counts(file, sims, shown.newton).ratio, sims.sample)
    spent = timings.times(file, sims)[shown.newton]
    segments = file.results("segments", sims.any_task)[:, None]
    guess = intervals.median(spent.guess_s / spent.solves / segments * 1e6, sims.sample)
    zero = intervals.median((spent.zero_cg_s / spent.solves / segments * 1e6)[:, [file.zero]], sims.sample)
    return ratio, guess, float(zero.value[0])


def table(shown, panels, found, tolerances):
    file = shown.file
    labels = [texts.tolerance_label(file.tolerances[t]) for t in tolerances]
    lines = [f"CG ratio over the cost of a guess, {measures.NEWTON[shown.newton]}"]
    for panel, (ratio, guess, zero) in zip(panels, found):
        rows = [[panel.title(), "us per segment"] + labels]
        rows += [[f"  {file.guesses[g]}", texts.fixed_text(guess[g].value, 3)] +
                 [texts.interval_text(ratio[g, t], 3) for t in tolerances] for g in shown.lines()]
        rows.append(["  CG from zero", texts.fixed_text(zero, 3)] + [""] * len(labels))
        lines += [""] + texts.aligned(rows)
    return lines


def figure(shown, panels, found, tolerances):
    file = shown.file
    lines = shown.lines()
    handles = shown.handles(lines) + [Line2D([], [], color="#999999", linewidth=0.8, label="Pareto front"),
                                      Line2D([], [], color="#999999", linewidth=0.8, linestyle=(0, (3, 2)),
                                             label="as fast as the best classical guess")]
    notes = [f"CG ratio: {measures.NEWTON[shown.newton]}; mean over simulations; time: median; "
             f"{study.sample_text([ratio for ratio, _, _ in found])}.", shown.about()]
    page = layout.Page(shown.width_mm, [panel.caption() for panel in panels], len(tolerances),
                       len(tolerances) if shown.wide else 1, 42, handles, notes, shown.timing_warning(), left_mm=12,
                       gap_mm=9, ticks_mm=5.5)
    for row, (panel, (ratio, guess, zero)) in enumerate(zip(panels, found)):
        timed = remarks.solve_tolerance(file, shown.sims.any_task[panel.index])
        for k, (axes, t) in enumerate(zip(page.axes[row], tolerances)):
            y, x = ratio[:, t].value, guess.value
            for g in lines:
                look = shown.style(g)
                time = guess[g:g + 1]
                style.errorbar(axes, time.value, [ratio[g, t]], xerr=style.whiskers(time.value, time.low, time.high),
                               **style.WHISKERS, **look.line())
            axes.set(xscale="log", ylim=(0, None))
            there = [g for g in lines if x[g] > 0 and np.isfinite(y[g])]
            best = np.array(there, dtype=int)[unbeaten(x[there], y[there])]
            axes.plot(x[best], y[best], color="#999999", linewidth=0.8, zorder=1)
            classical = [g for g in there if not any(word in file.guesses[g] for word in OTHERS)]
            if timed == texts.tolerance_label(file.tolerances[t]) and classical and zero > 0:
                fastest = (x[classical] + y[classical] * zero).min()
                along = np.geomspace(x[there].min(), fastest, 60)
                axes.plot(along, (fastest - along) / zero, color="#999999", linewidth=0.8, linestyle=(0, (3, 2)), zorder=1)
            layout.set_ticks(axes.xaxis, layout.log_ticks(*axes.get_xlim()))
            axes.set_title(f"to {texts.tolerance_label(file.tolerances[t])}")
            page.label_y(axes, k, "CG ratio", shared=False)
        page.label_x(row, "guess (µs per segment and solve)")
    return page


def unbeaten(x, y):
    """Indices, sorted by x, of the points without another point below and to the left."""
    order = np.lexsort((y, x))
    best = np.minimum.accumulate(np.concatenate([[np.inf], y[order]]))[:-1]
    return order[y[order] < best]


if __name__ == "__main__":
    commandline.run(main)
