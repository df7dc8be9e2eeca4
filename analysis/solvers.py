#!/usr/bin/python3
"""Figure and table of what accuracy costs: error of the positions over wall time per step, for every projection.

The error is relative to the trajectory of the direct solve with the most Newton iterations that the job has for the
same rod at the same step (see accuracy.py): what it shows is convergence within a step, not the error of the step. A
row of panels per value of one parameter, a panel per value of another; a line per method, a point per effort
(iterations per step, tolerance of CG), the median over simulations; whiskers are 95 % bootstrap intervals over them.
The table has the cheapest way to every error. Needs trajectories in the file (record.trajectory_every) and /solves
(record.solves "all").
"""

import numpy as np

from drawing import layout, study, style
from reading import accuracy, commandline, intervals, texts
from reading.errors import KeyNotFound
from reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/solvers.py results/solvers.h5
  analysis/solvers.py results/solvers.h5 --select scene.segments=50 --columns scene.youngs_modulus_pa"""
LEVELS = (1e-2, 1e-3, 1e-4, 1e-6)
FLOOR = 1e-12    # errors up to this are drawn there: rounding of another order of operations


def arguments():
    made = commandline.parser(__doc__, EXAMPLES, tolerances=None, newton=False)
    study.add_figure_arguments(made)
    made.add_argument("--rows", metavar="KEY", default="scene.segments", help="(default: scene.segments)")
    made.add_argument("--columns", metavar="KEY", default="scene.youngs_modulus_pa",
                      help="(default: scene.youngs_modulus_pa)")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown = study.of_tasks(file, options)
        found = accuracy.accuracy(file, shown.sims.tasks())
        if not found.reference.any():
            raise KeyNotFound(f"{file.path} has no task of the direct solve to compare the others with")
        row, column = (values(file, key, found) for key in (options.rows, options.columns))
        cells = [[lines(found, file, (row == r) & (column == c)) for c in np.unique(column)] for r in np.unique(row)]
        names = [[f"{style.parameter_label(key, file.parameter(key).unit)} {texts.number_text(value)}"
                  for value in np.unique(of)] for key, of in ((options.rows, row), (options.columns, column))]
        print("\n".join(table(cells, names)) + "\n")
        study.save(file, options, {"solvers": figure(shown, found, cells, names)})


def values(file, key, found):
    parameter = file.parameter(key)
    if not parameter.numeric:
        raise KeyNotFound(f"{key} is not a number")
    return parameter.values[found.tasks]


def lines(found, file, cell):
    """{family: [(effort, time [µs], error)]} of the tasks of a mask, least effort first; the latter two Estimates."""
    cell = cell & ~found.reference & np.isfinite(found.error)
    ways = {}
    for family in np.unique(found.family[cell]):
        of = cell & (found.family == family)
        efforts = np.unique(found.effort[of])
        ways[family] = []
        for effort in efforts[::-1] if family.startswith("CG") else efforts:
            rows = np.flatnonzero(of & (found.effort == effort))
            draws = file.sample[found.tasks[rows]]
            ways[family].append((texts.number_text(effort), intervals.median(1e6 * found.step_s[rows], draws),
                                 intervals.median(np.maximum(found.error[rows], FLOOR), draws)))
    return ways


def cheapest(ways, level):
    """The family, effort and time of the fastest point whose error is at most `level`; None where there is none."""
    good = [(float(time.value), family, effort) for family, points in ways.items() for effort, time, error in points
            if error.value <= level]
    return min(good) if good else None


def table(cells, names):
    rows = [["cheapest way to an error of at most"] + [f"{level:g}" for level in LEVELS]]
    for title, row in zip(names[0], cells):
        rows.append([title] + [""] * len(LEVELS))
        for column, ways in zip(names[1], row):
            best = [cheapest(ways, level) for level in LEVELS]
            rows.append([f"  {column}"] + [f"{b[1]} {b[2]}: {b[0]:.3g} µs" if b else "-" for b in best])
    return texts.aligned(rows)


def figure(shown, found, cells, names):
    looks = {**style.guess_styles(np.unique(found.family)),
             **{f"CG from {label}": look for label, look in shown.styles.items()}}
    families = [family for family in looks if any(family in ways for row in cells for ways in row)]
    handles = [looks[family].handle(family) for family in families]
    points = [error for row in cells for ways in row for line in ways.values() for _, _, error in line]
    efforts = "; ".join(f"{family} " + ", ".join(dict.fromkeys(
        effort for row in cells for ways in row for effort, _, _ in ways.get(family, []))) for family in families)
    notes = [f"Medians of {study.sample_text(points)}. Points: tolerances of CG, else iterations per step: {efforts}. "
             f"Errors up to {FLOOR:g} are drawn there; tasks that failed are not. Reference: Newton with direct "
             "solves, converged, with the same step; xpbd converges to a trajectory of its own, whose forces acted "
             "along the positions on its way.", shown.about()]
    page = layout.Page(shown.width_mm, names[0], len(names[1]), len(names[1]) if shown.wide else 2, 32, handles, notes,
                       shown.timing_warning(), left_mm=12)
    errors = [error.value for error in points]
    for k, row in enumerate(cells):
        times = [time.value for ways in row for line in ways.values() for _, time, _ in line]
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
    x = [float(time.value) for _, time, _ in line]
    y, low, high = (np.array([float(getattr(e, name)) for _, _, e in line]) for name in ("value", "low", "high"))
    axes.errorbar(x, y, yerr=style.whiskers(y, low, high), **style.WHISKERS, **look.line())


if __name__ == "__main__":
    commandline.run(main)
