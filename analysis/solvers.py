#!/usr/bin/python3
"""Error of the positions over wall time per step, for every projection, as figure and table.

The error is relative to the direct solve with the most Newton iterations for the same rod at the same step (see
accuracy.py). So it shows the convergence within a step, not the error of the time step. One parameter gives the rows
of panels, another the columns. Each method has a line with a point per effort (iterations per step, tolerance of CG).
A point is the median over simulations; whiskers are 95 % bootstrap intervals. A method and effort that failed in any
simulation of a panel is left out of it. The table has the fastest way to reach every error. The file needs
trajectories (record.trajectory_every) and /solves (record.solves "all").
"""

import numpy as np

from rodsweep.drawing import layout, study, style
from rodsweep.reading import accuracy, commandline, texts
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/solvers.py results/solvers.h5
  analysis/solvers.py results/solvers.h5 --select scene.segments=50 --columns scene.youngs_modulus_pa"""
LEVELS = (1e-2, 1e-3, 1e-4, 1e-6)


def arguments():
    made = commandline.parser(__doc__, EXAMPLES, tolerances=None, newton=False)
    study.add_figure_arguments(made)
    made.add_argument("--rows", metavar="KEY", default="scene.segments",
                      help="parameter of the rows (default: scene.segments)")
    made.add_argument("--columns", metavar="KEY", default="scene.youngs_modulus_pa",
                      help="parameter of the columns (default: scene.youngs_modulus_pa)")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown = study.of_tasks(file, options, failed_too=True)
        found = accuracy.accuracy(file, shown.sims.tasks())
        row, column = (values(file, key, found) for key in (options.rows, options.columns))
        cells = [[lines(found, file, (row == r) & (column == c)) for c in np.unique(column)] for r in np.unique(row)]
        accuracy.require_points(file, [point for of_row in cells for ways in of_row for point in ways.values()])
        names = [[f"{texts.parameter_label(key, file.parameter(key).unit)} {texts.number_text(value)}"
                  for value in np.unique(of)] for key, of in ((options.rows, row), (options.columns, column))]
        print("\n".join(table(cells, names)) + "\n")
        study.save(file, options, {"solvers": figure(shown, found, cells, names)})


def values(file, key, found):
    parameter = file.parameter(key)
    if not parameter.numeric:
        raise KeyNotFound(f"{key} is not a number")
    return parameter.values[found.tasks]


def lines(found, file, cell):
    """{family: [Point]} of the tasks of a mask."""
    families = {}
    for point in accuracy.points(file, found, cell):
        families.setdefault(point.way.family, []).append(point)
    return families


def table(cells, names):
    rows = [["cheapest way to an error of at most"] + [f"{level:g}" for level in LEVELS]]
    for title, row in zip(names[0], cells):
        rows.append([title] + [""] * len(LEVELS))
        for column, ways in zip(names[1], row):
            best = [accuracy.cheapest(sum(ways.values(), []), level) for level in LEVELS]
            rows.append([f"  {column}"] + [f"{b.way.family} {texts.number_text(b.way.effort)}: {b.time_us.value:.3g} µs"
                                           if b else "-" for b in best])
    return texts.aligned(rows)


def figure(shown, found, cells, names):
    families = list(dict.fromkeys(family for row in cells for ways in row for family in ways))
    looks = style.guess_styles(families)
    handles = [looks[family].handle(family) for family in families]
    points = [point.error for row in cells for ways in row for line in ways.values() for point in line]
    efforts = "; ".join(f"{family} " + ", ".join(dict.fromkeys(
        texts.number_text(point.way.effort) for row in cells for ways in row for point in ways.get(family, [])))
        for family in families)
    notes = [f"Medians of {study.sample_text(points)}. Points: tolerances of CG, else iterations per step: {efforts}. "
             f"Errors below {accuracy.FLOOR:g} are drawn there. Methods that failed in any simulation are left out. "
             f"{accuracy.REFERENCE}", shown.about()]
    page = layout.Page(shown.width_mm, names[0], len(names[1]), len(names[1]) if shown.wide else 2, 32, handles, notes,
                       shown.timing_warning(), left_mm=12)
    errors = [error.value for error in points]
    for k, row in enumerate(cells):
        times = [point.time_us.value for ways in row for line in ways.values() for point in line
                 if point.time_us.value > 0] or [1.0]
        for column, (axes, ways) in enumerate(zip(page.axes[k], row)):
            for family, line in ways.items():
                _draw(axes, looks[family], line)
            axes.set(xscale="log", yscale="log", xlim=(0.6 * min(times), 1.6 * max(times)),
                     ylim=(0.4 * min(errors), 2.5 * max(errors)))
            page.title(axes, names[1][column])
            page.label_y(axes, column, "error / rod length")
        page.label_x(k, "wall time of a step (µs)")
    return page


def _draw(axes, look, line):
    x = [float(point.time_us.value) for point in line]
    y, low, high = (np.array([float(getattr(point.error, name)) for point in line])
                    for name in ("value", "low", "high"))
    style.errorbar(axes, x, y, yerr=style.whiskers(y, low, high), **style.WHISKERS, **look.line())


if __name__ == "__main__":
    commandline.run(main)
