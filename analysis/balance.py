#!/usr/bin/python3
"""Error against wall time for kinds of time step: Euler or BDF2, with or without the balance of momentum.

Each kind of scene has a panel: the error at the end of a simulation over the wall time of a simulated second, one point
per time step. If a kind has only one time step, there is no figure. The error is the root mean square distance of the
segments from where they are with the smallest step, relative to the diagonal of the box around all segments at the
start. With the smallest step, BDF2 in balance is the reference if it was tried, else Euler in balance. Times and errors
are medians over simulations. The table adds the mean Newton iterations of a step and the median momentum residual after
the first step. The file needs trajectories to the end of the simulation (record.trajectory_every) and /solves
(record.solves "all").
"""

from dataclasses import dataclass

import numpy as np

from rodsweep.drawing import layout, study, style
from rodsweep.reading import accuracy, commandline, intervals, texts
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/balance.py results/balance.h5
  analysis/balance.py results/balance.h5 --scene helix
  analysis/balance.py results/default_steps.h5 --motion"""
FEATURES = (("scene.tip_force_n", "with an end load"), ("scene.tip_torque_nm", "with an end torque"),
            ("scene.tip_motion", "with a moved end"), ("scene.section", "of another section"),
            ("scene.motions", "with moved ends"), ("scene.wind", "in wind"), ("scene.obstacles", "dropped"))
PLAIN = {"", "none", "free", "circle"}    # words of FEATURES that a scene does not have


@dataclass(frozen=True)
class Line:
    """Estimates of one kind of scene and step, one per time step, largest step first."""
    step_s: list
    second_ms: list      # wall time of a simulated second
    error: list          # None for the reference
    iterations: list
    lacking: list        # momentum residual


def main():
    made = study.parser(__doc__, EXAMPLES, tolerances=None, newton=False)
    made.add_argument("--motion", action="store_true", help="the error over all frames, root mean square, not at the end")
    options = made.parse_args()
    with SweepFile(options.file) as file:
        shown = study.of_tasks(file, options)
        if not all(path in file.h5 for path in (accuracy.REST, accuracy.ASSEMBLY, accuracy.DIRECT)):
            raise KeyNotFound(f"{file.path} has no times of steps and solves")
        if not file.has("/steps/momentum_residual"):
            raise KeyNotFound(f"{file.path} has no momentum residuals (/steps/momentum_residual)")
        tasks = np.unique(shown.sims.any_task)
        kinds = accuracy.kinds(file)
        found = [kind for kind in accuracy.KINDS if kind in {kinds[task] for task in tasks}]
        if len(found) < 2:
            raise KeyNotFound(f"{file.path} has only one kind of step in the chosen simulations: sweep time.balance "
                              "or time.integrator")
        panels = {title: _lines(file, of, kinds, found, options.motion) for title, of in _scenes(file, tasks).items()}
        print("\n".join(table(panels)) + "\n")
        if any(len(line.step_s) < 2 for lines in panels.values() for line in lines.values()):
            return  # one time step gives no line to draw
        study.save(file, options, {"balance": figure(shown, panels)})


def _scenes(file, tasks):
    """{title: its tasks}, in the order of the file. The same random values are drawn for all kinds and steps, so the
    first sample tells which tasks have the same scene."""
    keys = [key for key in file.parameters if key.startswith("scene.")]
    codes = np.column_stack([file.parameters[key].codes() for key in keys])
    grid_point = file.point - file.sample
    first = {}
    for task in tasks[np.argsort(file.sample[tasks], kind="stable")]:
        first.setdefault(grid_point[task], tuple(codes[task]))
    scenes = {}
    for task in tasks:
        scenes.setdefault(first[grid_point[task]], []).append(task)
    names = [_name(file, of[0]) for of in scenes.values()]
    titles = [name if names.count(name) == 1 else f"{name} {names[:k + 1].count(name)}" for k, name in enumerate(names)]
    return {title: np.array(of) for title, of in zip(titles, scenes.values())}


def _name(file, task):
    words = [file.parameters["scene.type"].text(task).replace("_", " ")]
    for key, feature in FEATURES:
        if key not in file.parameters:
            continue
        value = file.parameters[key].values[task]
        if np.any(np.nan_to_num(value)) if isinstance(value, np.ndarray) else file.parameters[key].text(task) not in PLAIN:
            words.append(feature)
    return " ".join(words)


def _lines(file, tasks, kinds, found, motion):
    """{kind: Line}"""
    step_s = file.parameters["time.step_s"].values
    finest = step_s[tasks].min()
    best = max((kinds[task] for task in tasks if step_s[task] == finest), key=list(accuracy.KINDS).index)
    exact = {int(file.sample[task]): accuracy.frames(file, task)
             for task in tasks if kinds[task] == best and step_s[task] == finest}
    return {kind: _line(file, [task for task in tasks if kinds[task] == kind and int(file.sample[task]) in exact],
                        exact, finest if kind == best else None, motion) for kind in found}


def _line(file, tasks, exact, reference_s, motion):
    step_s = file.parameters["time.step_s"].values
    line = Line([], [], [], [], [])
    for size in sorted(set(step_s[tasks].tolist()), reverse=True):
        of = [task for task in tasks if step_s[task] == size]
        draws = file.sample[of]
        line.step_s.append(size)
        line.second_ms.append(intervals.median([1e3 * accuracy.step_s(file, task) / size for task in of], draws))
        apart = [accuracy.distances(accuracy.frames(file, task), exact[int(file.sample[task])]) for task in of]
        line.error.append(None if size == reference_s else intervals.median(
            [accuracy.root_mean_square(frames if motion else frames[-1:]) for frames in apart], draws))
        line.iterations.append(intervals.mean([file.rows("/steps/newton_iterations", task).mean() for task in of], draws))
        line.lacking.append(intervals.median(
            [np.nanmedian(file.rows("/steps/momentum_residual", task)[1:]) for task in of], draws))
    return line


def table(panels):
    rows = [["", "time step (s)", "step", "error", "ms per simulated second", "Newton iterations", "momentum residual"]]
    for title, lines in panels.items():
        sizes = sorted({size for line in lines.values() for size in line.step_s}, reverse=True)
        for size, kind in ((size, kind) for size in sizes for kind in lines if size in lines[kind].step_s):
            line, k = lines[kind], lines[kind].step_s.index(size)
            error = texts.short_text(float(line.error[k].value), 2) if line.error[k] else "reference"
            rows.append([title, f"{size:g}", accuracy.KINDS[kind], error,
                         *(texts.short_text(float(values[k].value), 2)
                           for values in (line.second_ms, line.iterations, line.lacking))])
    for k in range(len(rows) - 1, 1, -1):    # what the row above says already
        if rows[k][0] == rows[k - 1][0]:
            rows[k][1] = "" if rows[k][1] == rows[k - 1][1] else rows[k][1]
            rows[k][0] = ""
    return texts.aligned(rows)


def figure(shown, panels):
    kinds = list(next(iter(panels.values())))
    looks = dict(zip(kinds, style.series_styles(len(kinds))))
    points = [error for lines in panels.values() for line in lines.values() for error in line.error if error]
    notes = [f"Medians of {study.sample_text(points, mark='')}. Along a line the time step halves from point to point, "
             f"from {max(next(iter(panels.values()))[kinds[-1]].step_s):g} s on the left to twice the reference's. "
             f"Reference: {accuracy.KINDS[kinds[-1]]}, smallest step.", shown.about()]
    page = layout.Page(shown.width_mm, ["Error"], len(panels), 3 if shown.wide else 1, 44,
                       [look.handle(accuracy.KINDS[kind]) for kind, look in looks.items()], notes, shown.timing_warning(),
                       left_mm=13, gap_mm=9)
    for column, (axes, (title, lines)) in enumerate(zip(page.axes[0], panels.items())):
        for kind, line in lines.items():
            kept = [k for k, size in enumerate(line.step_s) if size > min(line.step_s)]
            axes.plot([float(line.second_ms[k].value) for k in kept], [float(line.error[k].value) for k in kept],
                      **looks[kind].line(), linewidth=0.9, markersize=3)
        axes.set(xscale="log", yscale="log")
        for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            layout.set_ticks(axis, layout.log_ticks(*limits))
        page.title(axes, title)
        page.label_y(axes, column, "error / size of the scene", shared=False)
    page.label_x(0, "wall time per simulated second (ms)")
    return page


if __name__ == "__main__":
    commandline.run(main)
