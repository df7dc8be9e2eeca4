"""Planted trajectories in a file of synthetic.py, with known poses."""

import h5py
import numpy as np

from running import Scripts
from rodsweep.reading import trajectory

HALF = np.sqrt(0.5)
AXES = {"x": (HALF, 0, HALF, 0), "y": (HALF, -HALF, 0, 0), "z": (1, 0, 0, 0)}   # w, x, y, z


def plant(path, segments=6, frames=4, radius=0.05, length=0.2, rods=2, walls=0, along="x", last=None):
    """`rods` straight rods, `segments` in all, along the axis `along`, side by side along z at height y = 1; they rise
    by 0.1 m a frame. The first `walls` segments have no length and no radius. `last`: frames of task 0 (others -1).
    All tasks of the file are alike."""
    each = segments // rods
    lengths = np.full(segments, float(length))
    lengths[:walls] = 0
    offset = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}[along]
    place = np.arange(segments) % each - (each - 1) / 2
    rod = np.arange(segments) // each
    centre = place[:, None] * length * np.array(offset) + rod[:, None] * [0, 0, 0.5] + [0, 1, 0]
    with h5py.File(path, "r+") as h5:
        tasks = len(h5["tasks/state"])
        first_row = np.arange(tasks * frames).reshape(tasks, frames) * segments
        if last is not None:
            first_row[0, last:] = -1
        position = np.stack([centre + [0, 0.1 * k, 0] for _ in range(tasks) for k in range(frames)])
        h5["tasks/segments"][:] = segments
        h5["tasks/first_segment_row"] = np.arange(tasks) * segments
        h5["trajectories/position_m"] = position.reshape(-1, 3)
        h5["trajectories/orientation"] = np.tile(AXES[along], (tasks * frames * segments, 1))
        h5["trajectories/first_row"] = first_row
        h5["trajectories/time_s"] = np.tile(0.04 * np.arange(frames), (tasks, 1))
        columns = {"length_m": lengths, "radius_m": np.where(lengths > 0, radius, 0),
                   "rod": rod.astype(np.int16),
                   "static": (np.arange(segments) % each == 0).astype(np.int8)}
        for name, values in columns.items():
            h5[f"trajectories/segments/{name}"] = np.tile(values, tasks)


def plant_joints(path, pairs, position, force, moment, frames=4):
    """Joints between pairs of segments, in all tasks of plant(): positions [joint, 3] in frame 0, and forces and moments
    [joint, 3] in the others."""
    joints = len(pairs)
    with h5py.File(path, "r+") as h5:
        tasks = len(h5["tasks/state"])
        for name, each in (("joints", 0), ("first_joint_row", joints), ("first_frame_joint", joints * frames)):
            h5[f"tasks/{name}"] = np.arange(tasks) * each + (joints if name == "joints" else 0)
        for side, name in enumerate(("first", "second")):
            h5[f"trajectories/joints/{name}"] = np.tile(np.asarray(pairs)[:, side], tasks)
        h5["trajectories/joint_position_m"] = np.concatenate(
            tasks * [position + np.array([0, 0.1 * frame, 0]) for frame in range(frames)])
        for name, values in (("force_n", force), ("moment_nm", moment)):
            of_frames = np.tile(np.asarray(values, dtype=float), (frames, 1))
            of_frames[:joints] = np.nan
            h5[f"trajectories/joint_{name}"] = np.tile(of_frames, (tasks, 1))


def obstacle(number, kind, **values):
    """The columns of one obstacle."""
    return {f"obstacles[{number}].{kind}.{name}": value for name, value in values.items()}


class Planted(Scripts):
    def plant(self, columns=None, scene="helix", **settings):
        """Three tasks with trajectories and these columns: each a list of three values, or one value for all."""
        self.close()
        self.write(scenes=(scene,), grid={"scene.segments": [6]}, samples=3, solves=False)
        plant(self.path, **settings)
        with h5py.File(self.path, "r+") as h5:
            for name, values in (columns or {}).items():
                values = values if isinstance(values, list) else 3 * [values]
                h5[f"tasks/parameters/scene.{name}"] = np.array(values, dtype=float)

    def shown(self, columns=None, **settings):
        """The Trajectory of the first task."""
        self.plant(columns, **settings)
        return trajectory.of_task(self.opened(), 0)
