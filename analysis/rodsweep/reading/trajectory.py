"""The recorded trajectory of a task: its segments and their positions in every frame.

A segment is a cylinder along its local z with length, radius and centre x. Its orientation is the unit quaternion q =
(w, x, y, z), and its axis in the world is the third column of q's rotation matrix. Lengths are in metres. A frame is
read when it is needed, so memory use does not grow with their number. Raises KeyNotFound if the file lacks data.
"""

from dataclasses import dataclass

import h5py
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from rodsweep.reading import commandline, internal_forces, obstacles
from rodsweep.reading.errors import KeyNotFound

SEGMENTS = "/trajectories/segments"
NEAR = 1e-3   # points this close, as a share of the shortest segment's length, are one


@dataclass(frozen=True)
class Trajectory:
    h5: h5py.File
    task: int
    first_segment: int      # row in /trajectories/segments
    first_row: np.ndarray   # [frame] row in /trajectories
    time_s: np.ndarray      # [frame]
    length: np.ndarray      # [segment]
    radius: np.ndarray      # [segment] radius and length are 0 for a wall that holds the rod
    rod: np.ndarray         # [segment]
    static: np.ndarray      # [segment] held by a clamp
    wall: float             # [m] thickness of the wall of a tube, infinite for a solid circle; None: another section

    def frames(self):
        return len(self.first_row)

    def centres(self, frame):
        """[segment, 3]"""
        return self._rows("position_m", frame)

    def axes(self, frame):
        """[segment, 3] unit vectors along the segments."""
        return axis(self._rows("orientation", frame))

    def ends(self, frame):
        """Both ends of every segment's centre line, [segment, 3] each."""
        centre, half = self.centres(frame), 0.5 * self.length[:, None] * self.axes(frame)
        return centre - half, centre + half

    def joint_segments(self):
        """[joint, 2] numbers of the segments that a joint connects, as the program recorded them."""
        joints = self._joints()
        first = int(self.h5["/tasks/first_joint_row"][self.task])
        return np.stack([self.h5[f"/trajectories/joints/{name}"][first:first + joints] for name in ("first", "second")],
                        axis=1)

    def joint_positions(self, frame):
        """[joint, 3] m"""
        return self._joint_rows("joint_position_m", frame)

    def joint_forces(self, frame):
        """[joint, 3] N, of the second segment on the first, in the world; NaN in the first frame."""
        return self._joint_rows("joint_force_n", frame)

    def joint_moments(self, frame):
        """[joint, 3] N m, of the second segment on the first, about the joint, in the world; NaN in the first frame."""
        return self._joint_rows("joint_moment_nm", frame)

    def tensions(self, frame):
        """[joint] N: the force of a joint in the direction from its first segment's centre to its second's; NaN where
        the centres coincide."""
        first, second = self.centres(frame)[self.joint_segments().T]
        apart = np.linalg.norm(second - first, axis=1)
        along = np.einsum("ji,ji->j", self.joint_forces(frame), second - first)
        return np.divide(along, apart, out=np.full(len(apart), np.nan), where=apart > 0)

    def internal_forces(self, frame):
        """{"tension": [segment], …} of every segment (rodsweep.reading.internal_forces)."""
        return internal_forces.of_segments(self, frame)

    def has_forces(self):
        return "/trajectories/joint_force_n" in self.h5

    def _joints(self):
        if not self.has_forces():
            raise KeyNotFound(f"{self.h5.filename} has no forces of joints: set record.forces in the job to true")
        return int(self.h5["/tasks/joints"][self.task])

    def _joint_rows(self, name, frame):
        joints = self._joints()
        row = int(self.h5["/tasks/first_frame_joint"][self.task]) + range(self.frames())[frame] * joints
        return self.h5[f"/trajectories/{name}"][row:row + joints]

    def _rows(self, name, frame):
        row = self.first_row[frame]
        return self.h5[f"/trajectories/{name}"][row:row + len(self.length)]


class Beside:
    """Several trajectories as one, each shifted by `apart` [3] from the one before; each is a separate rod. A
    trajectory that ended early keeps its last frame."""

    def __init__(self, parts, apart):
        self.parts, self.shift = parts, [k * np.asarray(apart) for k in range(len(parts))]
        self.task = parts[0].task
        self.time_s = max((part.time_s for part in parts), key=len)
        self.length, self.radius, self.static = (np.concatenate([getattr(part, name) for part in parts])
                                                 for name in ("length", "radius", "static"))
        self.rod = np.repeat(np.arange(len(parts)), [len(part.length) for part in parts])

    def frames(self):
        return len(self.time_s)

    def _joined(self, of, frame):
        return np.concatenate([of(part, min(frame, part.frames() - 1)) for part in self.parts])

    def centres(self, frame):
        shift = np.concatenate([np.broadcast_to(by, (len(part.length), 3)) for part, by in zip(self.parts, self.shift)])
        return self._joined(Trajectory.centres, frame) + shift

    def axes(self, frame):
        return self._joined(Trajectory.axes, frame)

    ends = Trajectory.ends

    def internal_forces(self, frame):
        found = [part.internal_forces(min(frame, part.frames() - 1)) for part in self.parts]
        return {name: np.concatenate([values[name] for values in found]) for name in found[0]
                if all(name in values for values in found)}


def axis(orientation):
    """Third column of the rotation matrices of unit quaternions (w, x, y, z)."""
    w, x, y, z = np.moveaxis(orientation, -1, 0)
    return np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=-1)


def meeting(points, rod, reach):
    """(number of places, the place of each point): points of one rod that are at most `reach` apart are one place."""
    near = cKDTree(points).query_pairs(reach, output_type="ndarray").reshape(-1, 2)
    near = near[rod[near[:, 0]] == rod[near[:, 1]]]
    links = coo_matrix((np.ones(len(near)), tuple(near.T)), shape=(len(points), len(points)))
    return connected_components(links, directed=False)


def joints(trajectory):
    """[joint, 2] numbers of segments of one rod that share an end or the middle in the first frame. If several meet,
    all are joined to the first of them."""
    points = np.concatenate([*trajectory.ends(0), trajectory.centres(0)])
    count = len(trajectory.length)
    near = NEAR * trajectory.length[trajectory.length > 0].min(initial=np.inf)
    _, point = meeting(points, np.tile(trajectory.rod, 3), near if np.isfinite(near) else 0)
    segment = np.arange(len(points)) % count
    order = np.lexsort((segment, point))
    first = np.r_[True, np.diff(point[order]) > 0]
    hub = segment[order][np.flatnonzero(first)[np.cumsum(first) - 1]]
    found = np.stack([hub, segment[order]], axis=1)[hub != segment[order]]
    return np.unique(found, axis=0)


def of_task(file, task):
    """The recorded frames of a complete task; a failed task has those before its failure."""
    recorded(file)
    if not 0 <= task < file.task_count:
        raise KeyNotFound(f"{file.path} has tasks 0 to {file.task_count - 1}, not {task}")
    if not file.complete[task]:
        raise KeyNotFound(f"task {task} of {file.path} is not complete yet")
    first_row = file.h5["/trajectories/first_row"][task]
    there = first_row >= 0
    if not there.any():
        raise KeyNotFound(f"task {task} of {file.path} recorded no frame: {file.outcome[task]}")
    first = int(file.h5["/tasks/first_segment_row"][task])
    rows = slice(first, first + int(file.h5["/tasks/segments"][task]))
    length, radius, rod, static = (file.h5[f"{SEGMENTS}/{name}"][rows]
                                   for name in ("length_m", "radius_m", "rod", "static"))
    return Trajectory(file.h5, task, first, first_row[there], file.h5["/trajectories/time_s"][task][there], length,
                      radius, rod, static == 1, wall(file, task))


def wall(file, task):
    """Trajectory.wall of a task."""
    kind = obstacles.value(file, "scene.section.type", task)
    return np.inf if kind is None else obstacles.value(file, "scene.section.wall_m", task)


def recorded(file):
    """Raises KeyNotFound for a file without frames, or without the lengths and radii of the segments."""
    again = f"`rodsweep rerun {file.path} TASK` makes a file of one task with them"
    if not file.has("/trajectories/position_m"):
        raise KeyNotFound(f"{file.path} has no trajectories: set record.trajectory_every in the job; "
                          f"{again}")
    if not file.has(f"{SEGMENTS}/radius_m"):
        raise KeyNotFound(f"{file.path} has no lengths and radii of its segments ({SEGMENTS} is missing: an older "
                          f"rodsweep wrote it); {again}")


def add_task_argument(made):
    made.add_argument("--task", metavar="N", type=int, help="task to show (default: the first that --scene, --select "
                                                            "and --guess choose)")


def chosen(file, options):
    """The trajectory of --task, or of the first complete task that --scene, --select and --guess choose."""
    recorded(file)
    if options.task is not None:
        return of_task(file, options.task)
    left = commandline.chosen_tasks(file, options) & file.complete
    if options.guess:
        left &= np.isin(file.own_guess, commandline.chosen_guesses(file, options))
    if not left.any():
        raise KeyNotFound(f"no complete task of {file.path} is chosen" +
                          ("; --guess chooses tasks of closed loops, which have their own guess" if options.guess
                           else ""))
    return of_task(file, int(np.flatnonzero(left)[0]))
