#!/usr/bin/python3
"""Newton's convergence within a step: residual and joint gap before every iteration and at the end of the step.

Each solution method of the linear systems has a line: the direct solve (which also advances every paired sweep), and
in closed loops CG to each `solve.tolerance`, per guess. A line is the median over simulations of each simulation's
median over its steps. Whiskers are 95 % bootstrap intervals over simulations, bands the median quartiles over steps,
dots the largest value of all. The last panel shows the residual after an iteration against that before it. Its grey
lines have slope 1 (a fixed factor per iteration) and 2 (quadratic); the table has the observed orders. Each scene type
and value of any other grid has a row of panels. The file needs /solves (record.solves "all").
"""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, NullLocator

from rodsweep.drawing import layout, study, style
from rodsweep.reading import commandline, groups, intervals, newton_levels, texts
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/newton.py results/newton.h5
  analysis/newton.py results/newton.h5 --scene helix --guess zero --floor 1e-12"""
TITLES = {"newton_residual": "Newton residual", "joint_gap": "joint gap / joint length"}
AXES = ("solve.method", "solve.tolerance", "guess")
DECADES = 14


def arguments():
    made = commandline.parser(__doc__, EXAMPLES, tolerances=None, newton=False)
    study.add_figure_arguments(made)
    made.add_argument("--floor", type=float, default=1e-13, metavar="R",
                      help="residuals up to this are rounding errors without an order (default: 1e-13)")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        if "newton_residual" not in newton_levels.quantities(file):
            raise KeyNotFound(f"{file.path} has no rows of single solves (record.solves is \"summary\"), which this "
                              "script needs")
        shown = study.of_tasks(file, options)
        panels = groups.with_direct(shown.sims, groups.panels(file, shown.sims, AXES, most=None))
        found = newton_levels.levels(file, shown.sims.tasks())
        if not np.isfinite(found.values["newton_residual"]).any():
            raise KeyNotFound(f"{file.path} has no Newton residual in the chosen simulations")
        series = [methods(shown, panel) for panel in panels]
        medians = [{method: estimates(found, shown.sims, tasks, rows) for method, (_, tasks, rows) in ways.items()}
                   for ways in series]
        print("\n".join(table(panels, medians, options.floor)) + "\n")
        study.save(file, options, {"newton": figure(shown, panels, series, medians, found, options.floor)})


def methods(shown, panel):
    """{method: (style, tasks, rows of Simulations)}: CG by tolerance and guess in a closed loop, then the others."""
    file, sims = shown.file, shown.sims
    own = sims.own[panel.index]
    tolerance = file.parameters["solve.tolerance"] if "solve.tolerance" in file.parameters else None
    ways = []
    for g in shown.guesses:
        rows = panel.index[own & (sims.task[panel.index, g] >= 0)]
        values = tolerance.values[sims.task[rows, g]] if tolerance else np.zeros(len(rows))
        for value in sorted(set(values.tolist()), reverse=True):
            of_value = rows[values == value]
            label = (f"CG to {texts.tolerance_label(value)}" if tolerance else "CG") + (
                f", {file.guesses[g]}" if len(shown.guesses) > 1 else "")
            ways.append((label, sims.task[of_value, g], of_value))
    found = {label: (look, tasks, rows) for look, (label, tasks, rows) in zip(style.series_styles(len(ways)), ways)}
    return found | shown.methods_without_guess(panel)


def estimates(found, sims, tasks, rows):
    """{quantity: Estimate [level, 4]}: medians over simulations."""
    at = found.rows(tasks)
    return {name: intervals.median(values[at], sims.sample[rows]) for name, values in found.values.items()}


def table(panels, medians, floor):
    lines = ["Newton residual, median, before iteration j (last: after them), and the observed order of convergence "
             "(1: a fixed factor, 2: quadratic):"]
    for panel, ways in zip(panels, medians):
        levels = max(len(e["newton_residual"].value) for e in ways.values())
        rows = [[panel.title()] + [f"j = {j}" for j in range(levels)]]
        for method, e in ways.items():
            values = e["newton_residual"].value[:, 1]
            order = newton_levels.orders(values, floor)
            rows.append([f"  {method}"] +
                        [texts.number_text(float(f"{v:.1e}")) if np.isfinite(v) else "-" for v in values])
            rows.append(["    order"] + [f"{o:.2f}" if np.isfinite(o) else "-" for o in order])
        lines += [""] + texts.aligned(rows)
    return lines


def figure(shown, panels, series, medians, found, floor):
    handles = study.handles(series)
    handles += [Line2D([], [], color="#888888", linewidth=0.8, linestyle=dash, label=f"slope {order}")
                for order, dash in GUIDES.items()]
    names = list(found.values)
    shares = [found.share[found.rows(tasks)] for ways in series for _, tasks, _ in ways.values()]
    left_early = any(((share > 0) & (share < 1)).any() for share in shares)
    shown_counts = [e["newton_residual"] for ways in medians for e in ways.values()]
    notes = ["Before Newton iteration j, and after the last. Lines: median over simulations of their medians over steps; "
             f"{study.sample_text(shown_counts)}; bands: quartiles over steps; dots: largest of all."]
    if left_early:
        notes.append("Steps whose residual was below the job's newton_tolerance ended early and keep their last value.")
    page = layout.Page(shown.width_mm, [panel.caption() for panel in panels], len(names) + 1,
                       len(names) + 1 if shown.wide else 1, 42, handles, notes + [shown.about()], gap_mm=12,
                       left_mm=12, ticks_mm=8 if not shown.wide else 5.5)
    for row, (ways, e) in enumerate(zip(series, medians)):
        for axes, name in zip(page.axes[row], names):
            _levels(axes, name, ways, e, found)
            axes.set_title(TITLES[name])
            axes.set_xlabel("Newton iteration j", labelpad=1.5)
        _order(page.axes[row][-1], ways, e, floor)
    return page


def _levels(axes, name, ways, e, found):
    axes.set_yscale("log")
    top, bottom = 0, np.inf
    for method, (look, tasks, _) in ways.items():
        values = e[method][name]
        j = np.arange(len(values.value))
        centre = values[:, 1]
        bars = style.whiskers(centre.value, centre.low, centre.high)
        axes.fill_between(j, values.value[:, 0], values.value[:, 2], color=look.colour, alpha=0.13, linewidth=0)
        style.errorbar(axes, j, centre.value, yerr=bars, **style.WHISKERS, **look.line())
        largest = found.values[name][found.rows(tasks)][:, :, 3]
        worst = np.fmax.reduce(largest)
        axes.plot(j, worst, linestyle="", marker=".", markersize=2.5, color=look.colour)
        sizes = np.concatenate([worst, centre.value])
        sizes = sizes[np.isfinite(sizes) & (sizes > 0)]
        if len(sizes):
            top, bottom = max(top, sizes.max()), min(bottom, sizes.min())
    if top:
        axes.set_ylim(max(0.5 * bottom, top * 10.0 ** -DECADES), 2 * top)
    axes.xaxis.set_major_locator(MaxNLocator(8, integer=True))
    axes.xaxis.set_minor_locator(NullLocator())


GUIDES = {1: (0, (1, 0)), 2: (0, (3, 2))}


def _order(axes, ways, e, floor):
    """Residual after an iteration against that before it, with lines of slope 1 and 2 through the largest residual."""
    axes.set(xscale="log", yscale="log")
    befores, afters = [], []
    for method, (look, _, _) in ways.items():
        values = e[method]["newton_residual"].value[:, 1]
        before, after = values[:-1], values[1:]
        kept = (before > floor) & (after > 0)
        axes.plot(before[kept], after[kept], linewidth=0.6, color=look.colour, marker=look.marker, linestyle=look.dash)
        befores, afters = befores + before[kept].tolist(), afters + after[kept].tolist()
    if befores:
        right, top = max(befores), max(afters)
        left, bottom = min(befores), min(afters)
        x = np.geomspace(left, right, 2)
        for order, dash in GUIDES.items():
            axes.plot(x, top * (x / right) ** order, color="#888888", linewidth=0.8, linestyle=dash, zorder=1)
        axes.set(xlim=(0.4 * left, 2.5 * right), ylim=(0.3 * bottom, 4 * top))
    axes.set_title("residual after an iteration")
    axes.set_xlabel("residual before it", labelpad=1.5)


if __name__ == "__main__":
    commandline.run(main)
