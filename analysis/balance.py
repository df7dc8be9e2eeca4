#!/usr/bin/python3
"""Error against wall time for two kinds of time step: the paper's, and one that keeps the balance of momentum.

Each kind of scene has a panel: the error at the end of a simulation over the wall time of a simulated second, one
point per time step. If a scene has only one time step, there is no figure. The error is the distance of a segment from
its position with the smallest balanced step, root mean square over segments. It is relative to the diagonal of the box
around all segments at the start. Times and errors are medians over simulations. The table adds the mean Newton
iterations of a step and the largest momentum residual after the first step. The file needs trajectories to the end of
the simulation (record.trajectory_every) and /solves (record.solves "all").
"""

from dataclasses import dataclass

import numpy as np

from rodsweep.drawing import layout, study, style
from rodsweep.reading import accuracy, commandline, intervals, texts
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/balance.py results/balance.h5
  analysis/balance.py results/balance.h5 --scene helix"""
KINDS = {0: "the paper's step", 1: "in balance"}    # by time.balance


@dataclass(frozen=True)
class Line:
    """Estimates of one kind of scene and step, one per time step, largest step first."""
    step_s: list
    second_ms: list      # wall time of a simulated second
    error: list          # None for the reference
    iterations: list
    lacking: list        # momentum residual


def main():
    options = study.parser(__doc__, EXAMPLES, tolerances=None, newton=False).parse_args()
    with SweepFile(options.file) as file:
        shown = study.of_tasks(file, options)
        balance = file.parameters.get("time.balance")
        if balance is None or len(set(balance.values[shown.sims.tasks()].tolist())) < len(KINDS):
            raise KeyNotFound(f"{file.path} has only one kind of step in the chosen simulations: sweep time.balance "
                              "over false and true")
        if not all(path in file.h5 for path in (accuracy.REST, accuracy.ASSEMBLY, accuracy.DIRECT)):
            raise KeyNotFound(f"{file.path} has no times of steps and solves")
        if not file.has("/steps/momentum_residual"):
            raise KeyNotFound(f"{file.path} has no momentum residuals (/steps/momentum_residual)")
        tasks = np.unique(shown.sims.any_task)
        panels = {title: {kind: _line(file, tasks[of], kind) for kind in KINDS} for title, of in _scenes(file, tasks).items()}
        print("\n".join(table(panels)) + "\n")
        if any(len(lines[1].step_s) == 1 for lines in panels.values()):
            return  # one time step gives no line to draw
        study.save(file, options, {"balance": figure(shown, panels)})


def _scenes(file, tasks):
    """{title: mask of tasks} by scene type, tip load and what holds the scene."""
    keys = [key for key in ("scene.type", "scene.tip_force_n", "scene.held") if key in file.parameters]
    codes = np.column_stack([file.parameters[key].codes()[tasks] for key in keys])
    titles = {}
    for row in dict.fromkeys(map(tuple, codes.tolist())):
        of = (codes == row).all(axis=1)
        task = tasks[np.argmax(of)]
        name = file.parameters["scene.type"].text(task).replace("_", " ")
        if "scene.held" in keys and file.parameters["scene.held"].text(task) == "free":
            name = "free " + name
        if "scene.tip_force_n" in keys and np.any(np.nan_to_num(file.parameters["scene.tip_force_n"].values[task])):
            name += " at rest under a tip load"
        titles[name] = of
    return titles


def _line(file, tasks, kind):
    step_s, balance = file.parameters["time.step_s"].values, file.parameters["time.balance"].values[tasks]
    finest = step_s[tasks].min()
    exact = {int(file.sample[task]): accuracy.frames(file, task)
             for task in tasks[(balance == 1) & (step_s[tasks] == finest)]}
    line = Line([], [], [], [], [])
    for size in sorted(set(step_s[tasks].tolist()), reverse=True):
        of = [task for task in tasks[(balance == kind) & (step_s[tasks] == size)] if int(file.sample[task]) in exact]
        draws = file.sample[of]
        is_reference = kind == 1 and size == finest
        line.step_s.append(size)
        line.second_ms.append(intervals.median([1e3 * accuracy.step_s(file, task) / size for task in of], draws))
        apart = [accuracy.distances(accuracy.frames(file, task), exact[int(file.sample[task])]) for task in of]
        line.error.append(None if is_reference else intervals.median(
            [frames[-1] if len(frames) else np.nan for frames in apart], draws))
        line.iterations.append(intervals.mean([file.rows("/steps/newton_iterations", task).mean() for task in of], draws))
        line.lacking.append(intervals.median(
            [np.fmax.reduce(file.rows("/steps/momentum_residual", task)[1:], initial=np.nan) for task in of], draws))
    return line


def table(panels):
    rows = [["", "time step (s)", "step", "error", "ms per simulated second", "Newton iterations", "momentum residual"]]
    for title, lines in panels.items():
        for k, size in enumerate(lines[1].step_s):
            for kind, line in lines.items():
                error = texts.short_text(float(line.error[k].value), 2) if line.error[k] else "reference"
                rows.append([title if not (k or kind == 1) else "", f"{size:g}" if kind == 0 else "",
                             KINDS[kind], error, *(texts.short_text(float(values[k].value), 2)
                                                   for values in (line.second_ms, line.iterations, line.lacking))])
    return texts.aligned(rows)


def figure(shown, panels):
    looks = dict(zip(KINDS, style.series_styles(len(KINDS))))
    points = [error for lines in panels.values() for line in lines.values() for error in line.error if error]
    notes = [f"Medians of {study.sample_text(points, mark='')}. Along a line the time step halves from point to point, "
             f"from {max(next(iter(panels.values()))[1].step_s):g} s on the left to twice the reference's. "
             "Reference: the smallest step in balance.", shown.about()]
    page = layout.Page(shown.width_mm, ["Error at the end"], len(panels), 3 if shown.wide else 1, 44,
                       [look.handle(KINDS[kind]) for kind, look in looks.items()], notes, shown.timing_warning(),
                       left_mm=13, gap_mm=9)
    for column, (axes, (title, lines)) in enumerate(zip(page.axes[0], panels.items())):
        for kind, line in lines.items():
            kept = [k for k, size in enumerate(line.step_s) if size > min(line.step_s)]
            axes.plot([float(line.second_ms[k].value) for k in kept], [float(line.error[k].value) for k in kept],
                      **looks[kind].line(), linewidth=0.9, markersize=3)
        axes.set(xscale="log", yscale="log")
        layout.set_ticks(axes.xaxis, layout.log_ticks(*axes.get_xlim()))
        page.title(axes, title)
        if column == 0:
            axes.set_ylabel("error / size of the scene", labelpad=2)
    page.label_x(0, "wall time per simulated second (ms)")
    return page


if __name__ == "__main__":
    commandline.run(main)
