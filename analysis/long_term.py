#!/usr/bin/python3
"""Length drift, joint gap, total energy and momenta of long runs over time, for every method, as figure and table.

The script is meant for closed loops, where every guess advances its own trajectory, and for tasks with `solve.method`
"direct" or "end_to_end". A paired sweep has one trajectory, that of the direct solve. The run is divided into up to
240 intervals. A line is the median over simulations of the largest value in an interval (energy: of the middle of its
range). Its band goes from the smallest to the largest value of all simulations. A failed simulation is included up to
its end, which a cross marks. The table has the largest and the final drift, its slope per 1000 steps with a 95 %
bootstrap interval over simulations, and the failures. Writes PDF and PNG; prints the table and the paths.
"""

import sys

import numpy as np

from rodsweep.drawing import layout, study, style
from rodsweep.reading import commandline, envelopes, groups, measures, texts
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/long_term.py results/long_term_learned.h5
  analysis/long_term.py results/long_term_learned.h5 --guess zero,previous,quadratic --log-time
  analysis/long_term.py results/long_term_learned.h5 --after 2000 --csv > drift.csv"""
PANELS = {  # quantity: title, vertical scale
    "length_drift": ("size of the length drift", "log"),
    "joint_gap": ("largest joint gap / joint length", "log"),
    "energy_j": ("change of the total energy ÷ largest kinetic energy", "energy"),
    "momentum_kg_m_s": ("linear momentum (kg m/s)", "log"),
    "angular_momentum_kg_m2_s": ("angular momentum about the origin (kg m²/s)", "log"),
}
DECADES = 8   # of a logarithmic axis, below the largest value of the methods that did not fail


def arguments():
    made = study.parser(__doc__, EXAMPLES, tolerances=None, newton=False)
    made.add_argument("--after", metavar="STEP", type=int,
                      help="first step of the fit of the drift (default: a tenth of the run)")
    made.add_argument("--log-time", action="store_true", help="logarithmic time axis")
    made.add_argument("--csv", action="store_true", help="the table as comma-separated values, without a figure")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown = make_study(file, options)
        panels = groups.panels(file, shown.sims, ("solve.method", "solve.model"), most=None)
        panels = groups.with_direct(shown.sims, panels)
        if len(panels) > groups.MOST_PANELS:
            raise KeyNotFound(f"{len(panels)} groups of simulations are too many for a page (at most "
                              f"{groups.MOST_PANELS}): choose with --scene TYPE or --select KEY=VALUE")
        begin = options.after if options.after is not None else int(file.steps[shown.sims.tasks()].max()) // 10
        found = envelopes.histories(file, shown.sims.tasks(), begin, options.log_time)
        if not found.reached.any():
            raise KeyNotFound(f"{file.path} has no recorded step in the chosen simulations: {shown.census.text()}")
        series = [methods(shown, panel) for panel in panels]
        if options.csv:
            texts.write_csv(sys.stdout, envelopes.COLUMNS,
                            envelopes.records(panels, series, found, shown.sims, file.ok))
            return
        print("\n".join(envelopes.lines(panels, series, found, shown.sims, file.ok, begin)) + "\n")
        study.save(file, options, {"long-term": figure(shown, panels, series, found, options)},
                   ["log-time" if options.log_time else ""])


def make_study(file, options):
    """A Study of all chosen tasks, with and without guesses, including failed ones."""
    if not envelopes.recorded(file):
        raise KeyNotFound(f"{file.path} has no rows of steps (/steps), which this script needs")
    return study.of_tasks(file, options, failed_too=True)


def methods(shown, panel):
    """{method: (style, tasks, rows of Simulations)} of a panel: guesses in the file's order, then the other methods."""
    file, sims = shown.file, shown.sims
    found = {}
    for g in shown.guesses:
        rows = panel.index[sims.own[panel.index] & (sims.task[panel.index, g] >= 0)]
        if len(rows):
            found[file.guesses[g]] = (shown.style(g), sims.task[rows, g], rows)
    return found | shown.methods_without_guess(panel)


def figure(shown, panels, series, found, options):
    names = [name for name in PANELS if name in found.low]
    counts = texts.range_text([len(rows) for methods_of in series for _, _, rows in methods_of.values()])
    buckets = len(found.edges) - 1
    steps = int(found.edges[-1])
    middle = (found.edges[:-1] + found.edges[1:] + 1) / 2
    times = [shown.time_axis(shown.sims.any_task[panel.index], middle) for panel in panels]
    notes = [f"{steps} steps in {buckets} intervals. Lines: median over {counts} simulations of the largest value in "
             "an interval (energy: of the middle of its range, relative to the first step). Bands: smallest to largest "
             "value of all simulations; for length drift, of the largest values. Crosses: failed simulations. "
             f"Logarithmic axes show {DECADES} decades below the largest value of the methods that did not fail."]
    scales = [_scales(found, methods_of, shown) for methods_of in series]
    envelopes_of = {name: [{method: _envelope(found, name, method, tasks, scale)
                            for method, (_, tasks, _) in methods_of.items()} for methods_of, scale in zip(series, scales)]
                    for name in names}
    notes += filter(None, [_coincident(envelopes_of)])
    titles = groups.short_titles(panels)
    columns = layout.even_columns(len(panels), 4 if shown.wide else 1)
    if max(map(len, titles)) > (shown.width_mm - 13) / columns / 1.2:    # about 1.2 mm per character
        titles = [title.replace(", ", "\n") for title in titles]
    page = layout.Page(shown.width_mm, [PANELS[name][0] for name in names], len(panels), columns,
                       26, study.handles(series), notes + [shown.about()], left_mm=13,
                       panel_titles_mm=1 + 2.6 * max(title.count("\n") + bool(title) for title in titles))
    for name, row in zip(names, page.axes):
        drawn = envelopes_of[name]
        for axes, (x, _), methods_of, of_panel in zip(row, times, series, drawn):
            _draw(axes, x, methods_of, found, of_panel, shown.file.ok)
        values = [part for parts in drawn for part in parts.values()]
        well = [part for parts, methods_of in zip(drawn, series) for method, part in parts.items()
                if shown.file.ok[methods_of[method][1]].any()]
        for k, (axes, (x, _)) in enumerate(zip(row, times)):
            _scale_y(axes, PANELS[name][1], _finite(values), _finite(well or values))
            if options.log_time:
                axes.set_xscale("log")
            axes.set_xlim(x[0] if options.log_time else 0, x[-1])
            axes.set_title(style.literal(titles[k]), fontsize=6, pad=2)
            page.label_y(axes, k, "")
    page.label_x(len(names) - 1, times[0][1])
    return page


def _scales(found, methods_of, shown):
    """{method: [task] J}: a draw's largest kinetic energy, the smallest over its methods (one may have diverged).
    Failed simulations count only if all failed."""
    scales = {}
    well = [(tasks[ok], rows[ok]) for _, tasks, rows in methods_of.values() for ok in [shown.file.ok[tasks]]]
    for tasks, rows in well if any(len(tasks) for tasks, _ in well) else [m[1:] for m in methods_of.values()]:
        for task, draw in zip(tasks, shown.sims.sample[rows]):
            kinetic = found.largest_kinetic[found.rows(task)]
            if kinetic > 0:
                scales[draw] = min(scales.get(draw, np.inf), kinetic)
    return {method: np.array([scales.get(draw, np.nan) for draw in shown.sims.sample[rows]])
            for method, (_, _, rows) in methods_of.items()}


def _envelope(found, name, method, tasks, scales):
    """(lower, upper, line) over buckets."""
    at = found.rows(tasks)
    low, high = found.low[name][at].astype(float), found.high[name][at].astype(float)
    if name == "energy_j":
        first, scale = found.first[name][at][:, None], scales[method][:, None]
        low, high = (low - first) / scale, (high - first) / scale
    if name == "length_drift":
        low = high = np.maximum(np.abs(low), np.abs(high))
    line = (low + high) / 2 if name == "energy_j" else high
    return np.fmin.reduce(low), np.fmax.reduce(high), measures.median_of_finite(line)


def _coincident(envelopes_of):
    """A sentence on methods whose lines coincide in all panels of a row: the largest set of each row."""
    found = {}
    for name, panels in envelopes_of.items():
        methods_of = list(dict.fromkeys(method for of_panel in panels for method in of_panel))
        sets = [[other for other in methods_of
                 if all(_same(of_panel[method][2], of_panel[other][2]) for of_panel in panels
                        if method in of_panel and other in of_panel)] for method in methods_of]
        largest = max(sets, key=len)
        if len(largest) > 1:
            found.setdefault(", ".join(largest), []).append(PANELS[name][0].split(" (")[0])
    return "; ".join(f"On one line: {methods_of} ({', '.join(names)})" for methods_of, names in found.items()) + (
        "." if found else "")


def _same(line, other):
    both = np.isfinite(line) & np.isfinite(other)
    return both.any() and np.allclose(line[both], other[both], rtol=0.05, atol=1e-3 * np.abs(line[both]).max())


def _draw(axes, x, methods_of, found, drawn, ok):
    every = max(1, len(x) // 7)
    for rank, (method, (low, high, line)) in enumerate(drawn.items()):
        look = methods_of[method][0]
        axes.fill_between(x, low, high, color=look.colour, alpha=0.10, linewidth=0)
        axes.plot(x, line, color=look.colour, linestyle=look.dash, marker=look.marker,
                  markevery=((rank * every) // len(drawn), every), linewidth=0.9, markersize=2.8)
        tasks = methods_of[method][1]
        ends = np.searchsorted(found.edges, found.reached[found.rows(tasks[~ok[tasks]])], side="left") - 1
        ends = np.unique(ends[ends >= 0])
        axes.plot(x[ends], high[ends], color=look.colour, linestyle="", marker="X", markersize=6.5,
                  markeredgecolor="black", markeredgewidth=0.6, zorder=4)


def _finite(parts):
    values = np.concatenate([np.ravel(part) for part in parts])
    return values[np.isfinite(values)]


def _scale_y(axes, scale, values, well):
    """One scale for all panels of a row. `values` of all methods set the top, `well` (no failures) the resolution."""
    sizes, typical = (np.abs(some[some != 0]) for some in (values, well))
    if not len(sizes) or not len(typical):
        return
    top, low, high = sizes.max(), values.min(), values.max()
    if scale == "log":
        axes.set_yscale("log")
        axes.set_ylim(max(0.7 * sizes.min(), typical.max() * 10.0 ** -DECADES), 1.4 * top)
    elif top < 20 * np.median(typical):
        axes.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
    else:
        # Linear about zero up to a typical value, at most four decades below the largest.
        largest = np.ceil(np.log10(typical.max()))
        linear = 10.0 ** np.clip(np.floor(np.log10(np.median(typical))), largest - 4, largest - 1)
        axes.set_yscale("symlog", linthresh=linear, linscale=0.6)
        axes.axhline(0, color="#888888", linewidth=0.5, zorder=1)
        axes.set_ylim(1.4 * low if low < 0 else -0.1 * linear, 1.4 * high if high > 0 else 0.1 * linear)
        axes.yaxis.get_major_locator().set_params(numticks=6)
        axes.yaxis.set_major_formatter(lambda value, _: texts.number_text(value))
        axes.yaxis.set_minor_locator(layout.NullLocator())


if __name__ == "__main__":
    commandline.run(main)
