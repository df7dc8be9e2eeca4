#!/usr/bin/python3
"""Error of the motion over the time step, and the energy that a step takes, for every integrator, as figure and table.

The reference of a simulation is the run with the smallest step, of bdf2 and in balance if these were tried. An error is
the root mean square distance of the segments from it, over the frames that all runs have, relative to the diagonal of
the box around the rod at the start (for a straight rod, its length). A point is the median over simulations, with a
95 % bootstrap interval. The lower row shows the total energy of one simulation at one step over time. Each value of a
parameter has a column. The file needs trajectories (record.trajectory_every) and a grid of time.step_s.
"""

import numpy as np

from rodsweep.drawing import layout, study, style
from rodsweep.reading import accuracy, commandline, intervals, measures, texts
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/integrators.py results/integrators.h5
  analysis/integrators.py results/integrators.h5 --columns scene.type --energy-step 0.005"""
VARIED = ("time.step_s", "time.steps", "time.integrator", "time.balance")


def arguments():
    made = study.parser(__doc__, EXAMPLES, tolerances=None, newton=False)
    made.add_argument("--columns", metavar="KEY", default="scene.youngs_modulus_pa",
                      help="a column per value of this parameter (default: scene.youngs_modulus_pa)")
    made.add_argument("--energy-step", metavar="S", type=float, help="step of the lower row (default: the largest)")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown = study.of_tasks(file, options)
        tasks = shown.sims.tasks()
        column = file.parameter(options.columns)
        codes = column.codes()[tasks]
        errors = {}
        for code in np.unique(codes):
            title = texts.parameter_label(column.name, column.unit) + " " + texts.number_text(
                column.values[tasks[codes == code][0]]) if column.numeric else column.text(tasks[codes == code][0])
            errors[title] = lines(file, tasks[codes == code])
        print("\n".join(table(errors)) + "\n")
        study.save(file, options, {"integrators": figure(shown, errors, options.energy_step)})


def lines(file, tasks):
    """{integrator: [(step, Estimate of the error, tasks)]}, largest step first."""
    step, kinds, best_last = file.parameter("time.step_s").values, accuracy.kinds(file), list(accuracy.KINDS)
    names = [integrator + " in balance" * balance for integrator, balance in kinds]
    keys = [p.codes()[tasks] for p in file.parameters.values() if p.name not in VARIED]
    rod = np.unique(np.column_stack([file.sample[tasks], *keys]), axis=0, return_inverse=True)[1].ravel()
    apart = np.full(len(tasks), np.nan)
    for group in range(rod.max() + 1):
        rows = np.flatnonzero(rod == group)
        best = min(rows, key=lambda row: (step[tasks[row]], -best_last.index(kinds[tasks[row]])))
        exact = accuracy.frames(file, tasks[best])
        for row in rows:
            distances = accuracy.distances(accuracy.frames(file, tasks[row]), exact)
            apart[row] = np.nan if row == best else accuracy.root_mean_square(distances)
    found = {}
    for which, size in sorted({(names[task], step[task]) for task in tasks}, key=lambda key: (key[0], -key[1])):
        rows = [row for row, task in enumerate(tasks) if (names[task], step[task]) == (which, size)
                and np.isfinite(apart[row])]
        if rows:
            found.setdefault(which, []).append((size, intervals.median(apart[rows], file.sample[tasks[rows]]),
                                                tasks[rows]))
    if not found:
        raise KeyNotFound(f"{file.path} has no simulation with several steps: give time.step_s a grid in the job")
    return found


def table(errors):
    steps = sorted({size for of in errors.values() for line in of.values() for size, *_ in line}, reverse=True)
    rows = [["error at a step of (s)"] + [texts.number_text(size) for size in steps] + ["order"]]
    for title, of in errors.items():
        for which, line in of.items():
            known = {size: float(estimate.value) for size, estimate, _ in line}
            rows.append([f"{title}, {which}"] + [f"{known[size]:.2g}" if size in known else "-" for size in steps]
                        + [texts.fixed_text(order(line, known), 2)])
    return texts.aligned(rows)


def order(line, known):
    """Observed order from the two smallest steps; NaN if there are fewer, or if an error is 0."""
    if len(line) < 2 or not min(known[size] for size, *_ in line[-2:]) > 0:
        return np.nan
    large, small = line[-2][0], line[-1][0]
    return np.log(known[large] / known[small]) / np.log(large / small)


def energies(file, task):
    """(times, total energy relative to the start ÷ the largest kinetic energy) of the steps."""
    kinetic, potential, elastic = (file.rows(f"/steps/{kind}_energy_j", task) for kind in
                                   ("kinetic", "potential", "elastic"))
    total = kinetic + potential + elastic
    return file.rows("/steps/time_s", task), measures.quotient(total - total[0], kinetic.max())


def figure(shown, errors, energy_step):
    names = list(dict.fromkeys(which for of in errors.values() for which in of))
    looks = dict(zip(names, style.series_styles(len(names))))
    steps = sorted({entry[0] for of in errors.values() for line in of.values() for entry in line})
    size = steps[-1] if energy_step is None else energy_step
    if not np.isclose(size, steps).any():
        raise KeyNotFound(f"--energy-step {size:g}: the steps are {', '.join(f'{one:g}' for one in steps)}")
    notes = ["Errors: root mean square over all segments and frames, relative to the size of the rod; medians with 95 % "
             f"intervals. Energy: change since the first step ÷ largest kinetic energy, at a step of {size:g} s.",
             shown.about()]
    page = layout.Page(shown.width_mm, ["Error of the motion", "Total energy"], len(errors), 5 if shown.wide else 2, 36,
                       [look.handle(which) for which, look in looks.items()], notes, left_mm=12, gap_mm=6)
    logarithmic = all(any(estimate.value > 0 for line in of.values() for _, estimate, _ in line)
                      for of in errors.values())
    for column, (title, of) in enumerate(errors.items()):
        upper, lower = page.axes[0][column], page.axes[1][column]
        for which, line in of.items():
            sizes, estimates, _ = zip(*line)
            style.errorbar(upper, sizes, estimates, **looks[which].line(), linewidth=0.9, markersize=2.8, elinewidth=0.5)
            here = [tasks[0] for of_size, _, tasks in line if np.isclose(of_size, size)]
            if here:
                lower.plot(*energies(shown.file, here[0]), color=looks[which].colour, linewidth=0.8)
        upper.set(xscale="log", yscale="log" if logarithmic else "linear")
        layout.set_ticks(upper.xaxis, steps[::-2][::-1])
        for axes in (upper, lower):
            page.title(axes, title)
        page.label_y(upper, column, "error / size of the rod")
        page.label_y(lower, column, "energy change")
    for row in page.axes:
        low, high = zip(*(axes.get_ylim() for axes in row))
        for axes in row:
            axes.set_ylim(min(low), max(high))
    page.label_x(0, "time step (s)")
    page.label_x(1, "time (s)")
    return page


if __name__ == "__main__":
    commandline.run(main)
