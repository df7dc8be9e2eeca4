#!/usr/bin/python3
"""Solve times of all combinations of preconditioner and guess, compared with the direct solve.

For each value of --x (by default the nodes of a lattice, else the segments of a rod) a table lists all combinations
and the fastest of each kind: the direct solve, CG from zero, with a classical guess, with a learned one, and with an
oracle. Those that failed in the fewest simulations come first; "(4 of 5)" says that one of five failed. In a paired
sweep the time is that of a solve with guess and preconditioner set-up, without assembly. The oracle's own time is not
counted there. In a closed loop the time is that of a whole step. The figure has the time of the fastest of each kind
over the number of joints. Each scene type and value of any other grid has a panel. Intervals are 95 % bootstrap
intervals over simulations. The file needs /solves (record.solves "all"). Writes PDF and PNG and prints the paths.
"""

import numpy as np

from rodsweep.drawing import layout, study, style
from rodsweep.reading import combinations, commandline, groups, intervals, measures, remarks, texts, timings
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/combinations.py results/lattice_swing.h5
  analysis/combinations.py results/net_gusts.h5 --x scene.rows --newton all"""
STYLES = {combinations.DIRECT: style.DIRECT,
          combinations.ZERO: style.GuessStyle(style.KINDS["zero"][0], "s", style.KINDS["zero"][2]),  # may be one point
          combinations.CLASSICAL: style.GuessStyle(*style.KINDS["regression"]),
          combinations.LEARNED: style.GuessStyle(*style.KINDS["copingnet"]),
          combinations.OWN: style.GuessStyle(*style.SPARE[0]),
          combinations.ORACLE: style.GuessStyle(*style.KINDS["oracle"])}
NODES = "scene.nodes_x"
COMPARED = (combinations.CLASSICAL, combinations.ZERO, combinations.DIRECT)


def arguments():
    made = study.parser(__doc__, EXAMPLES, tolerances="1e-2,1e-3")
    made.add_argument("--x", metavar="KEY", help="parameter along x (default: scene.nodes_x of a lattice, else "
                                                 "scene.segments); the axis shows joints")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown = study.of_tasks(file, options)
        if not timings.timed(file):
            raise KeyNotFound(f"{file.path} has no times of guesses")
        if combinations.PRECONDITIONER not in file.parameters or file.zero is None:
            raise KeyNotFound(f"{file.path} has no preconditioner or no zero guess to compare with")
        x = options.x or usual_x(file, shown.sims)
        shown.sims = shown.sims.subset(groups.applicable(file, shown.sims, x))
        panels = combinations.panels(file, shown.sims, x)
        found = [combinations.cells(file, shown.sims, panel, x, options.newton, shown.guesses) for panel in panels]
        if not any(cell.cheapest(kind) for cells in found for cell in cells for kind in combinations.KINDS):
            raise KeyNotFound(f"{file.path} has no combination that was timed: {shown.census.text()}")
        chosen = commandline.chosen_tolerances(file, options) if options.tolerance else \
            [file.tolerance_index(t) for t in (1e-2, 1e-3)]
        print("\n".join(table(shown, panels, found, chosen, x)) + "\n")
        study.save(file, options, {"combinations": figure(shown, panels, found)})


def usual_x(file, sims):
    """The nodes of a lattice if the file has lattices, else the segments."""
    nodes = file.parameters.get(NODES)
    return NODES if nodes is not None and nodes.applies()[sims.any_task].any() else "scene.segments"


def table(shown, panels, found, tolerances, x):
    file, closed = shown.file, shown.sims.closed_loop
    unit = "a whole step" if closed else "a solve with guess and set-up, without assembly"
    lines = [f"{file.path}, {shown.census.text()}, revision {remarks.revisions(file)}",
             f"µs: {unit}, to {shown.solve_tolerance()}, median over simulations [95 % interval]. Iterations per solve "
             f"and CG ratios: means, {measures.NEWTON[shown.newton]}. * some solves missed the tolerance; the "
             "iterations that they used are counted"]
    lines += list(filter(None, [shown.timing_warning()]))
    for panel, cells in zip(panels, found):
        for cell in cells:
            title = f"{panel.title()}, {x} = {cell.x}: {cell.joints:.0f} joints, {texts.simulations_text(len(cell.draws))}"
            lines += ["", title] + texts.aligned(_combinations(file, cell, tolerances))
            lines += [""] + texts.aligned(_cheapest(cell))
    return lines


def _combinations(file, cell, tolerances):
    labels = [texts.tolerance_label(file.tolerances[t]) for t in tolerances]
    rows = [["", "µs", *[f"iterations to {label}" for label in labels], *[f"ratio at {label}" for label in labels],
             f"products to {labels[0]}"]]
    zeros = {one.solver: one for one in cell.combinations if one.kind == combinations.ZERO}
    for one in cell.combinations:
        if one.kind == combinations.DIRECT:
            rows.append([f"  {one.text()}", _time(one, cell)] + ["-"] * (2 * len(tolerances) + 1))
            continue
        marks = ["*" if one.unreached[t] else "" for t in tolerances]
        zero = zeros.get(one.solver)    # absent if it failed everywhere
        rows.append([f"  {one.text()}", _time(one, cell),
                     *[_mean(one.iterations[:, t]) + mark for t, mark in zip(tolerances, marks)],
                     *[_interval(combinations.ratio(one, zero, cell.draws, t)) if zero else "-" for t in tolerances],
                     _mean(one.products[:, tolerances[0]])])
    return rows


def _cheapest(cell):
    rows = [["  the cheapest", "", "µs", *[f"over {kind}" for kind in COMPARED]]]
    best = {kind: cell.cheapest(kind) for kind in combinations.KINDS}
    for kind, one in best.items():
        if one is None:
            continue
        over = [_interval(combinations.speedup(best[other], one, cell.draws)) if best[other] and other != kind else "-"
                for other in COMPARED]
        rows.append([f"  {kind}", one.text(), _time(one, cell), *over])
    return rows


def _time(one, cell):
    """With the number of simulations that were timed, unless all were."""
    text = _interval(intervals.median(one.time_us, cell.draws))
    return text if one.timed() == len(cell.draws) else f"{text} ({one.timed()} of {len(cell.draws)})"


def _mean(values):
    return f"{np.nanmean(values):.1f}" if np.isfinite(values).any() else "-"


def _interval(estimate):
    """Three digits, with the interval if there are enough draws."""
    value, low, high = (float(np.squeeze(part)) for part in (estimate.value, estimate.low, estimate.high))
    if not np.isfinite(value):
        return "-"
    text = f"{value:.3g}" if value < 1000 else f"{value:.0f}"
    return f"{text} [{low:.3g}, {high:.3g}]" if np.isfinite(low) and low < 1000 else text


def figure(shown, panels, found):
    closed = shown.sims.closed_loop
    there = [kind for kind in combinations.KINDS if any(cell.cheapest(kind) for cells in found for cell in cells)]
    handles = [STYLES[kind].handle("direct solve" if kind == combinations.DIRECT else f"CG {kind}" if
                                   kind == combinations.ZERO else f"CG, best {kind}") for kind in there]
    unit = "Time of a whole step" if closed else "Time of guess, preconditioner set-up and CG, or of the direct solve"
    estimates = [[{kind: intervals.median(cell.cheapest(kind).time_us, cell.draws) for kind in there
                   if cell.cheapest(kind)} for cell in cells] for cells in found]
    notes = [f"{unit}, to {shown.solve_tolerance()}. Each line: the fastest combination of its kind; "
             f"median over {study.sample_text([e for row in estimates for one in row for e in one.values()])}. "
             f"Counted: {measures.NEWTON[shown.newton]}.", shown.about()]
    titles = groups.short_titles(panels)
    page = layout.Page(shown.width_mm, [""], len(panels), 3 if shown.wide else 1, 46, handles, notes,
                       shown.timing_warning(), left_mm=13)
    bounds = [v for row in estimates for one in row for e in one.values() for v in (e.value, e.low, e.high)
              if np.isfinite(v)]
    low, high = 0.8 * min(bounds), 1.25 * max(bounds)
    joints = [cell.joints for cells in found for cell in cells]
    for k, (axes, cells, row, title) in enumerate(zip(page.axes[0], found, estimates, titles)):
        for kind in there:
            at = [c for c, one in enumerate(row) if kind in one]
            style.errorbar(axes, [cells[c].joints for c in at], [row[c][kind] for c in at], **style.WHISKERS,
                           **STYLES[kind].line())
        axes.set(xscale="log", yscale="log", xlim=(0.7 * min(joints), 1.4 * max(joints)), ylim=(low, high))
        for axis, bound in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, (low, high))):
            ticks = layout.log_ticks(*bound)
            layout.set_ticks(axis, ticks[::-(-len(ticks) // 5)])
        if title:
            page.title(axes, title)
        page.label_y(axes, k, "µs per step" if closed else "µs per solve")
    page.label_x(0, "joints")
    return page


if __name__ == "__main__":
    commandline.run(main)
