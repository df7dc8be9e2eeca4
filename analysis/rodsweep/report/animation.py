"""Recorded trajectories in a form that is small enough for a page: fewer frames, and points as integers.

A rod's segments meet at joints, so both ends at a joint become one point (their mean, as in the length drift). Two
ends are one point if they are on the same rod and nearer than MEETING segment lengths in the first frame. Coordinates
are 16-bit steps through the box around all frames, about 1e-5 of the scene, little endian in base64. Frames are left
out evenly until an animation fits into its share of the page.
"""

import base64
import math

import numpy as np

from rodsweep.drawing import staging
from rodsweep.drawing.looks import HELD, RODS
from rodsweep.reading import groups, obstacles, texts, trajectory
from rodsweep.reading.errors import KeyNotFound

MEETING = 1e-2
MOST_TASKS = 8
MOST_FRAMES = 90
FEWEST_FRAMES = 8
STEPS = 65535
PER_SEGMENT = 10      # bytes
WORDS = 4            # of a title, besides the scene


def animations(file, chosen, room):
    """(animations, number of those that did not fit) of tasks that differ in their settings, within `room`
    (axes.Budget, bytes); ([], 0) if nothing was recorded."""
    tasks = _different(file, chosen)
    found = []
    for left, task in zip(range(len(tasks), 0, -1), tasks):
        made = _animation(file, task, tasks, int(room.share(left).left))
        if made and room.takes(made.pop("bytes")):
            found.append(made)
    return found, len(tasks) - len(found)


def _different(file, chosen):
    """The first task of every scene, gridded setting and guess; at most MOST_TASKS."""
    try:
        trajectory.recorded(file)
    except KeyNotFound:
        return []
    recorded = file.h5["/trajectories/first_row"]
    tasks = [task for task in np.flatnonzero(chosen & file.ok) if (recorded[task] >= 0).sum() > 1]
    if not tasks:
        return []
    tasks = np.array(tasks)
    keys = ["scene.type", *groups.gridded_keys(file, tasks, None), "guess"]
    codes = [file.parameters[key].codes()[tasks] for key in keys if key in file.parameters]
    kinds = np.stack([np.zeros(len(tasks), dtype=int), *codes], axis=1)
    first = np.sort(np.unique(kinds, axis=0, return_index=True)[1])
    if len(first) > MOST_TASKS:     # one of every scene first, then as many as fit
        scenes = np.sort(np.unique(file.scene_types()[tasks[first]], return_index=True)[1])
        rest = np.setdiff1d(np.arange(len(first)), scenes)
        first = first[np.sort(np.concatenate([scenes, rest])[:MOST_TASKS])]
    return tasks[first].tolist()


def _animation(file, task, tasks, room):
    shown = trajectory.of_task(file, task)
    joined, points = _points(shown)
    if points > STEPS:
        return None
    per_frame = 8 * points     # 3 numbers of 2 bytes, 4 letters for 3 bytes
    frames = _frames(shown.frames(), min(MOST_FRAMES, (room - PER_SEGMENT * len(shown.length)) // per_frame))
    if frames is None:
        return None
    try:
        low, high, spread = staging.bounds(shown, frames)
    except KeyNotFound:     # positions that are not numbers
        return None
    up = staging.upwards(file, task)
    touched = obstacles.of_task(file, task)
    extent = float(np.linalg.norm(high - low))
    azimuth, elevation = staging.chosen_view(spread, low, high, up)
    radius = staging.drawn_radius(shown)
    step = float(max(high - low)) / STEPS or 1.0
    place = np.empty((len(frames), points, 3), dtype="<u2")
    share = np.bincount(joined, minlength=points)[:, None]
    for k, frame in enumerate(frames):
        sums = np.zeros((points, 3))
        np.add.at(sums, joined, np.concatenate(shown.ends(frame)))
        place[k] = np.rint((sums / share - low) / step).clip(0, STEPS)
    segments = np.stack([joined[:len(shown.length)], joined[len(shown.length):]], axis=1).astype("<u2")
    rods = shown.rod % len(RODS)
    colour = np.where(shown.static, len(RODS), rods).astype(np.uint8)
    sizes, size = np.unique(radius.astype(np.float32), return_inverse=True)
    return {"task": task, "title": _title(file, task, tasks), "up": up.tolist(), "low": _plain(low), "step": step,
            "centre": _plain((low + high) / 2), "extent": extent, "azimuth": float(azimuth),
            "elevation": float(elevation),
            "floor": staging.floor_level(shown, frames, up, "auto", extent, touched),
            "time_s": _plain(shown.time_s[frames]), "every": frames[1] - frames[0], "recorded": shown.frames(),
            "palette": [*RODS, HELD], "sizes": _plain(sizes), "points": points, "segments": _text(segments),
            "colour": _text(colour), "size": _text(size.astype("<u2")), "place": _text(place),
            "capsules": [{"start": _plain(one.start), "end": _plain(one.end), "radius": one.radius,
                          "velocity": _plain(one.velocity)} for one in touched if isinstance(one, obstacles.Capsule)],
            "bytes": per_frame * len(frames) + PER_SEGMENT * len(shown.length)}


def _points(shown):
    """(index of every end's point, number of points); the first ends of all segments come before the second ones."""
    reach = MEETING * np.median(shown.length[shown.length > 0]) if (shown.length > 0).any() else 1.0
    points, joined = trajectory.meeting(np.concatenate(shown.ends(0)), np.tile(shown.rod, 2), reach)
    return joined, points


def _frames(recorded, most):
    """Evenly chosen frames, with the first; None if too few fit."""
    if most < min(recorded, FEWEST_FRAMES):
        return None
    return list(range(0, recorded, math.ceil(recorded / most)))


def _title(file, task, tasks):
    """A task's scene, and its parameters that differ among the tasks of that scene."""
    scenes = file.scene_types()
    words, alike = [scenes[task].replace("_", " ").capitalize()], [one for one in tasks if scenes[one] == scenes[task]]
    for parameter in file.parameters.values():
        if parameter.applies()[task] and len(np.unique(parameter.codes()[alike])) > 1:
            value = texts.number_text(parameter.values[task]) if parameter.numeric else parameter.text(task)
            words.append(f"{texts.parameter_label(parameter.name, parameter.unit)} {value.replace('_', ' ')}")
    return ", ".join(words[:WORDS + 1]) + f" (task {task})"


def _plain(numbers):
    return [float(f"{number:.6g}") for number in np.ravel(numbers)]


def _text(array):
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")
