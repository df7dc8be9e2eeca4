#!/usr/bin/python3
"""Pictures and films of a recorded trajectory: segments as tubes, obstacles, soft shadows.

Without --movie, the script writes a PNG of the last frame, of the frames of --frame, or of every N-th with --every N.
The job must record frames (record.trajectory_every); if not, `rodsweep rerun FILE TASK` makes a file of one task that
has them. POV-Ray draws the pictures; --movie mp4 needs ffmpeg. `jobs/studies.py pictures` installs both. The camera shows all
segments in all drawn frames. The script prints the paths and does not replace existing files without --force.
"""

import os
from collections import deque
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from rodsweep.drawing import colourbar, movie, povray, staging, tints
from rodsweep.reading import commandline, obstacles, trajectory
from rodsweep.reading.commandline import whole_number
from rodsweep.reading.errors import KeyNotFound, require_program
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.writing import outputs

EXAMPLES = """examples:
  analysis/render.py results/net.h5
  analysis/render.py results/net.h5 --task 3 --frame 0 10 -1 --view 30,20 --size 1600x1200 -o pictures
  analysis/render.py results/helix.h5 --select scene.segments=50 --movie mp4 --every 2 -o helix.mp4
  analysis/render.py results/ring.h5 --movie gif --size 400x300 --colour along
  analysis/render.py results/hang.h5 --colour tension
  analysis/render.py results/side_by_side.h5 --task 0 --beside 1 2 3 --movie mp4"""
SAMPLES = 4   # small pictures that give a GIF its colours


def arguments():
    made = commandline.parser(__doc__, EXAMPLES, tolerances=None, newton=False)
    trajectory.add_task_argument(made)
    made.add_argument("--beside", metavar="N", type=int, nargs="+", default=[],
                      help="tasks to draw beside it, each in its own colour, e.g. other methods on the same scene")
    made.add_argument("--apart", metavar="X,Y,Z", type=vector, default=np.array([0, 0, 1.0]),
                      help="offset from each task to the next in m (default: 0,0,1)")
    made.add_argument("-o", "--output", metavar="PATH", help="file of one picture or film, folder of several pictures "
                                                             "(default: in figures/ beside the file)")
    which = made.add_mutually_exclusive_group()
    which.add_argument("--frame", metavar="K", type=int, nargs="+", help="frames to draw; -1 is the last (default: -1)")
    which.add_argument("--every", metavar="N", type=whole_number, help="frames 0, N, 2 N …")
    made.add_argument("--movie", choices=["mp4", "gif"], help="make a film of all frames, or of those of --every")
    made.add_argument("--rate", metavar="F", type=whole_number, default=25,
                      help="frames per second of a film (default: 25)")
    made.add_argument("--size", metavar="WxH", type=pixels, default=(800, 600), help="pixels (default: 800x600)")
    made.add_argument("--view", metavar="VIEW", type=view, help="front, side, top or AZIMUTH,ELEVATION in degrees "
                                                               "(default: chosen from the shape of the scene)")
    made.add_argument("--colour", choices=tints.CHOICES, default="rod",
                      help="what colours show: the rod (default), the position along it, the radius, or what a segment "
                           "bears, with a colour bar: tension (positive if it is pulled), bending moment, torsion, or the "
                           "axial stress at the surface of a solid circle or a tube; needs record.forces in the job")
    made.add_argument("--floor", metavar="HEIGHT", type=height, default="auto",
                      help="height of the floor in m, none, or auto (default): the scene's own floor, else the foot of "
                           "trees, else a little under the lowest point")
    made.add_argument("--fine", action="store_true", help="smooth edges of rods thinner than a pixel; three "
                                                          "times slower")
    made.add_argument("-j", "--jobs", metavar="J", type=whole_number, default=os.cpu_count() or 1,
                      help="frames drawn in parallel (default: one per core)")
    outputs.add_force(made)
    return made.parse_args()


def main():
    options = arguments()
    if options.movie and options.frame:
        raise KeyNotFound("--movie shows all frames, or those of --every N: remove --frame")
    if options.movie == "mp4" and any(side % 2 for side in options.size):
        raise KeyNotFound("--size of an MP4 must be even: its colours have half the resolution")
    require_program("povray", "it draws the pictures")
    if options.movie == "mp4":
        require_program("ffmpeg", "--movie mp4 needs it, gif does not")
    with SweepFile(options.file) as file:
        shown = trajectory.chosen(file, options)
        if options.beside:
            shown = trajectory.Beside([shown, *(trajectory.of_task(file, task) for task in options.beside)], options.apart)
        frames = chosen_frames(shown, options)
        paths = names(options, shown.task, frames)
        for path in paths:
            outputs.check(path, options)
        draw = Drawing(shown, file, frames, options)
        if options.movie:
            write_movie(draw, frames, paths[0], options)
        else:
            for path, picture in zip(paths, draw.pictures(frames)):
                with outputs.whole(path) as part, open(part, "wb") as out:
                    out.write(picture)
        print("\n".join(paths))


class Drawing:
    """Pictures of one trajectory with the same camera, lights and colours; a colour bar is at the bottom."""

    def __init__(self, shown, file, frames, options):
        self.shown, self.jobs, self.fine = shown, options.jobs, options.fine
        self.colours = tints.colours(shown, options.colour, frames)
        width, height = options.size
        self.bar = None
        if self.colours.scale:
            self.bar = colourbar.strip(self.colours.scale, self.colours.palette[:-1], (width, colourbar.height(height)))
            height -= self.bar.height
        self.size = width, height
        self.stage = staging.staged(shown, frames, staging.upwards(file, shown.task), options.view, self.size,
                                    options.floor, obstacles.of_task(file, shown.task))

    def pictures(self, frames, shrink=1):
        """Pictures in order; `jobs` are drawn in parallel, so memory use is bounded."""
        size = tuple(max(1, side // shrink) for side in self.size)
        threads = self.jobs if len(frames) == 1 else 1
        with ThreadPoolExecutor(self.jobs) as pool:
            waiting = deque()
            for frame in frames:
                text = povray.scene(self.shown, self.stage, self.colours, frame)
                waiting.append(pool.submit(self.picture, text, size, threads))
                if len(waiting) > self.jobs:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()

    def picture(self, text, size, threads):
        picture = povray.picture(text, size, threads, self.fine)
        return colourbar.under(picture, self.bar) if self.bar else picture


def write_movie(draw, frames, path, options):
    with outputs.whole(path) as part:
        if options.movie == "mp4":
            movie.write_mp4(part, draw.pictures(frames), options.rate)
        else:
            some = frames[np.unique(np.linspace(0, len(frames) - 1, SAMPLES).astype(int))]
            movie.write_gif(part, draw.pictures(frames), options.rate, list(draw.pictures(some, shrink=2)))


def chosen_frames(shown, options):
    """Sorted frame numbers."""
    count = shown.frames()
    if options.movie or options.every:
        return np.arange(0, count, options.every or 1)
    chosen = options.frame or [-1]
    for frame in chosen:
        if not -count <= frame < count:
            raise KeyNotFound(f"task {shown.task} has frames 0 to {count - 1}, not {frame}")
    return np.array(sorted({frame % count for frame in chosen}))


def names(options, task, frames):
    """A path per picture, or the path of the film."""
    stem = f"{os.path.splitext(os.path.basename(options.file))[0]}-task{task}"
    folder = os.path.join(os.path.dirname(options.file), "figures")
    if options.movie:
        return [options.output or os.path.join(folder, f"{stem}.{options.movie}")]
    if options.output and len(frames) == 1:
        return [options.output]
    return [os.path.join(options.output or folder, f"{stem}-frame{frame:04d}.png") for frame in frames]


def pixels(text):
    size = tuple(whole_number(side) for side in text.lower().split("x"))
    if len(size) != 2:
        raise ValueError
    return size


def view(text):
    if text in staging.VIEWS:
        return text
    azimuth, elevation = (float(angle) for angle in text.split(","))
    if not abs(elevation) < 90:
        raise ValueError
    return azimuth, elevation


def vector(text):
    values = [float(part) for part in text.split(",")]
    if len(values) != 3:
        raise ValueError
    return np.array(values)


def height(text):
    return text if text in ("auto", "none") else float(text)


if __name__ == "__main__":
    commandline.run(main)
