#!/usr/bin/python3
"""Trajectories of several methods from the same start, side by side: the rods at some times, and their distance.

The script is meant for closed loops whose tasks record frames (record.trajectory_every). It shows the first task that
--scene and --select choose, and all others with the same start. Each panel has the rods' centre lines at one time,
seen in the direction that shows their largest spread; gravity points down. A simulation that ended early (a joint
tore, a value was not a number) is drawn dotted at its last frame. The last panel has the root mean square distance of
the segments from those of the first task. Prints these distances at the times; writes the figure as PDF and PNG.
"""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from rodsweep.drawing import layout, staging, study, style
from rodsweep.reading import commandline, measures, texts, trajectory
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/side_by_side.py results/side_by_side.h5
  analysis/side_by_side.py results/side_by_side.h5 --moments 0.1,0.5,1,5,10 --log-time"""


def arguments():
    made = study.parser(__doc__, EXAMPLES, tolerances=None, newton=False)
    made.add_argument("--moments", metavar="S,…", type=moments, default=moments("0.2,0.5,1,2,4"),
                      help="simulated times in s (default: 0.2,0.5,1,2,4)")
    made.add_argument("--log-time", action="store_true", help="logarithmic time axis of the last panel")
    return made.parse_args()


def moments(text):
    return sorted(float(part) for part in text.split(","))


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        trajectory.recorded(file)
        shown = study.of_tasks(file, options, failed_too=True)
        tasks = shown.sims.tasks()
        first = trajectory.of_task(file, int(tasks[0]))
        start = first.centres(0)
        found = {}
        for task in tasks:
            one = trajectory.of_task(file, int(task))
            if len(one.length) == len(start) and np.allclose(one.centres(0), start):
                found.setdefault(name_of(file, task), one)
        if len(found) < 2:
            raise KeyNotFound(f"no other task of {file.path} starts like task {tasks[0]}: there is nothing to compare")
        apart = {name: distances(first, one) for name, one in found.items()}
        print("\n".join(table(found, apart, options.moments)) + "\n")
        study.save(file, options, {"beside": figure(shown, found, apart, options)})


def name_of(file, task):
    own = file.own_guess[task]
    return file.guesses[own] if own >= 0 else str(measures.without_guess(file, np.array([task]))[0])


def distances(first, other):
    """[frame] root mean square distance [m] of the segments' centres, over the frames that both recorded."""
    return np.array([np.sqrt(np.mean(np.sum((first.centres(k) - other.centres(k)) ** 2, axis=1)))
                     for k in range(min(first.frames(), other.frames()))])


def table(found, apart, at):
    rows = [["distance from the first [m] at"] + [f"{moment:g} s" for moment in at] + ["recorded until"]]
    for name, one in found.items():
        numbers = [f"{apart[name][frame_at(one, moment)]:.3g}" if one.time_s[-1] >= moment - 1e-9 and
                   frame_at(one, moment) < len(apart[name]) else "-" for moment in at]
        rows.append([name] + numbers + [f"{one.time_s[-1]:g} s"])
    return texts.aligned(rows)


def frame_at(one, moment):
    return int(np.argmin(np.abs(one.time_s - moment)))


def figure(shown, found, apart, options):
    looks, reference = style.guess_styles(list(found)), next(iter(found))

    def line(name):
        """The reference is broad, so that other lines on it stay visible."""
        wide = {"linewidth": 3, "alpha": 0.3} if name == reference else {"linewidth": 1.1}
        return {"color": looks[name].colour, **wide}

    first = next(iter(found.values()))
    plane = seen_from(first, staging.upwards(shown.file, int(first.task)))
    notes = ["Centre lines at the same times, gravity downwards. Dotted: last frame of a simulation that ended before. "
             f"Last panel: root mean square distance of the segments from those of {reference}.", shown.about()]
    count = len(options.moments) + 1
    page = layout.Page(shown.width_mm, [""], count, layout.even_columns(count, 3 if shown.wide else 2), 42,
                       [Line2D([], [], label=style.literal(name), **line(name)) for name in found], notes, gap_mm=9, ticks_mm=9)
    *panels, last = page.axes[0]
    lines = {name: [line_of(one, frame_at(one, moment)) @ plane.T for moment in options.moments]
             for name, one in found.items()}
    inside = np.concatenate(lines[reference])
    low, high = inside.min(axis=0), inside.max(axis=0)
    middle, half = (low + high) / 2, 0.75 * (high - low).max()
    for k, (axes, moment) in enumerate(zip(panels, options.moments)):
        for name, one in found.items():
            ended = one.time_s[-1] < moment - 1e-9
            axes.plot(*lines[name][k].T, linestyle=(0, (1, 1)) if ended else "-", **line(name))
        axes.set(xlim=middle[0] + np.array([-half, half]), ylim=middle[1] + np.array([-half, half]))
        axes.set_aspect("equal", adjustable="datalim")
        axes.xaxis.set_major_locator(MaxNLocator(4))
        axes.yaxis.set_major_locator(MaxNLocator(4))
        axes.set_title(f"{moment:g} s")
        axes.set_xlabel("across (m)", labelpad=2)
        page.label_y(axes, k, "height (m)", shared=False)
    for name, one in found.items():
        if np.any(apart[name] > 0):
            time = one.time_s[:len(apart[name])]
            last.plot(time[1:], apart[name][1:], **line(name))
    last.set_yscale("log")
    if options.log_time:
        last.set_xscale("log")
    last.set_title("distance")
    last.set_xlabel("time (s)", labelpad=2)
    last.set_ylabel("m", labelpad=2)
    return page


def line_of(one, frame):
    """Points [.., 3] along the rod: the start of every segment, and the end of the last."""
    low, high = one.ends(frame)
    return np.concatenate([low, high[-1:]])


def seen_from(one, up):
    """Two rows: the horizontal direction of the rod's largest spread, and upwards."""
    points = np.concatenate([one.centres(k) for k in np.unique(np.linspace(0, one.frames() - 1, 50).astype(int))])
    points = points - points.mean(axis=0)
    flat = points - np.outer(points @ up, up)
    right = np.linalg.svd(flat, full_matrices=False)[2][0]
    right *= 1.0 if right[np.argmax(np.abs(right))] > 0 else -1.0
    return np.stack([right, up])


if __name__ == "__main__":
    commandline.run(main)
