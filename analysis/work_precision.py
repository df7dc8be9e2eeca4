#!/usr/bin/python3
"""Error of a trajectory over wall time per step: which method, preconditioner and guess is fastest for an accuracy.

Errors and times are those of solvers.py (see accuracy.py). Each value of a parameter has a column of panels. The rows
compare methods, preconditioners of CG, and guesses of CG. A line is the lower envelope over all that its name leaves
open: the effort (Newton iterations, tolerance of CG, iterations of xpbd and pbd), for preconditioners also the
guesses, for guesses the preconditioners, for methods both. A way that failed in any simulation of a panel is left out
of it. For each error, the table has the fastest way, the fastest CG, and the time of that CG over that of the fastest
direct solve. The file needs trajectories (record.trajectory_every) and /solves (record.solves "all").
"""

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from rodsweep.drawing import layout, study, style
from rodsweep.reading import accuracy, commandline, measures, texts
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/work_precision.py results/work_precision.h5
  analysis/work_precision.py results/work_precision.h5 --guess zero        # preconditioners only
  analysis/work_precision.py results/solvers.h5 --select scene.segments=50 --columns scene.youngs_modulus_pa"""
LEVELS = (1e-2, 1e-3, 1e-4, 1e-6)
DRAWN_FROM = 1e-8    # smallest error on the axis


def arguments():
    made = commandline.parser(__doc__, EXAMPLES, tolerances=None, newton=False)
    study.add_figure_arguments(made)
    made.add_argument("--columns", metavar="KEY", default="scene.type",
                      help="a panel per value of this parameter, number or word (default: scene.type)")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown = study.of_tasks(file, options, failed_too=True)
        tasks = np.unique(shown.sims.task[:, shown.guesses or [0]])
        found = accuracy.accuracy(file, tasks[tasks >= 0])
        panels = by_panel(file, found, file.parameter(options.columns))
        accuracy.require_points(file, sum(panels.values(), []))
        print("\n".join(table(panels)) + "\n")
        study.save(file, options, {"work-precision": figure(shown, panels)})


def by_panel(file, found, parameter):
    """{title: [Point]}; numbers are sorted, words keep the order of the job."""
    codes = parameter.codes()[found.tasks]
    ordered = np.unique(codes) if parameter.numeric else dict.fromkeys(codes.tolist())
    label = texts.parameter_label(parameter.name, parameter.unit)
    panels = {}
    for code in ordered:
        task = found.tasks[np.argmax(codes == code)]
        title = (f"{label} {texts.number_text(parameter.values[task])}" if parameter.numeric else
                 parameter.text(task).replace("_", " "))
        panels[title] = accuracy.points(file, found, codes == code)
    return panels


def table(panels):
    rows = [["", "error at most", "cheapest way", "µs", "cheapest CG", "µs", "÷ direct"]]
    for panel, points in panels.items():
        for k, level in enumerate(LEVELS):
            best = accuracy.cheapest(points, level)
            cg, direct = (accuracy.cheapest([point for point in points if point.way.method == method], level)
                          for method in ("cg", "direct"))
            factor = texts.short_text(float(measures.quotient(cg.time_us.value, direct.time_us.value)), 3) \
                if cg and direct else "-"
            rows.append(["" if k else panel, f"{level:g}", *_cells(best), *_cells(cg), factor])
    return texts.aligned(rows)


def _cells(point):
    return (point.way.text(), texts.short_text(float(point.time_us.value), 3)) if point else ("-", "-")


def choices(shown, points):
    """Rows of panels: (title, function from a Way to its line's name, {name: style}), for what has several values."""
    cg = [point.way for point in points if point.way.method == "cg"]
    methods = dict.fromkeys(_method(point.way) for point in points)
    preconditioners, guesses = dict.fromkeys(way.preconditioner for way in cg), dict.fromkeys(way.guess for way in cg)
    direct = {"direct": style.DIRECT} if "direct" in methods else {}

    def best(*others):
        swept = [name for name, values in others if len(values) > 1]
        return f", with the best {' and '.join(swept)} at every point" if swept and shown.wide else ""

    rows = [("Methods" + best(("preconditioner", preconditioners), ("guess of CG", guesses)), _method,
             style.guess_styles(methods))]
    if len(preconditioners) > 1:
        looks = zip(preconditioners, style.series_styles(len(preconditioners)))
        rows.append(("Preconditioners of CG" + best(("guess", guesses)), lambda way: way.preconditioner or way.method,
                     {**direct, **dict(looks)}))
    if len(guesses) > 1:
        looks = {guess: shown.styles[guess] for guess in guesses}
        rows.append(("Guesses of CG" + best(("preconditioner", preconditioners)), lambda way: way.guess or way.method,
                     {**direct, **looks}))
    return rows


def _method(way):
    return "CG" if way.method == "cg" else way.method


def figure(shown, panels):
    points = sum(panels.values(), [])
    rows = choices(shown, points)
    notes = [f"Medians of {study.sample_text([point.error for point in points], mark='')}. Lines: the lower envelope "
             f"over all other choices, also Newton iterations and the tolerance of CG. Errors below {DRAWN_FROM:g} "
             f"are drawn there. Methods that failed in any simulation are left out. {accuracy.REFERENCE}",
             shown.about()]
    page = layout.Page(shown.width_mm, [title for title, _, _ in rows], len(panels), 5 if shown.wide else 2, 36, [],
                       notes, shown.timing_warning(), left_mm=12, gap_mm=3,
                       row_handles=[[look.handle(name) for name, look in looks.items()] for _, _, looks in rows])
    for k, (_, name, looks) in enumerate(rows):
        for column, (axes, (title, here)) in enumerate(zip(page.axes[k], panels.items())):
            times = []
            for line, look in looks.items():
                kept = accuracy.envelope([point for point in here if name(point.way) == line], DRAWN_FROM)
                x = [float(point.time_us.value) for point in kept]
                axes.plot(x, [max(float(point.error.value), DRAWN_FROM) for point in kept], **look.line(),
                          linewidth=0.9, markersize=2.8)
                times += [time for time in x if time > 0]
            axes.set(xscale="log", yscale="log", ylim=(0.4 * DRAWN_FROM, 2))
            if times:
                low, high = 0.7 * min(times), 1.4 * max(times)
                axes.set_xlim(low, high)
                ticks = layout.log_ticks(low, high)
                axes.xaxis.set_major_locator(FixedLocator(ticks[::-(-len(ticks) // 4)]))
                axes.xaxis.set_minor_locator(NullLocator())
                axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: texts.number_text(value)))
            page.title(axes, title)
            page.label_y(axes, column, "error / size of the scene")
        page.label_x(k, "wall time of a step (µs)")
    return page


if __name__ == "__main__":
    commandline.run(main)
