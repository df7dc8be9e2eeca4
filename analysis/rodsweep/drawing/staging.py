"""The view of a trajectory: the upward direction, the floor and the eye.

Only sums and extremes over the frames are kept, so memory use does not grow with their number.
"""

from dataclasses import dataclass

import numpy as np

from rodsweep.drawing import camera
from rodsweep.reading import obstacles
from rodsweep.reading.errors import KeyNotFound

VIEWS = {"front": (0, 4), "side": (90, 4), "top": (0, 89.9)}   # azimuth and elevation in degrees
TURN_DEG = 28           # rotation of the default view away from the broad side
GAP = 0.015             # from the lowest point to the floor, as a share of the scene's extent
WALL_RADII = 2.2        # radius of the plate that stands for a wall (a held segment without length), in rod radii
HAIR = 1e-4             # by which a floor covers the plates of walls on it, as a share of the scene's extent
GROUND_DEG = 10         # from the vertical: a wall stands on the floor if its rod is this upright


@dataclass(frozen=True)
class Stage:
    camera: camera.Camera
    up: np.ndarray
    floor: float          # height along `up`; None: no floor
    centre: np.ndarray    # of the scene
    extent: float         # diagonal of its bounding box
    solids: list          # Capsules among the obstacles
    slopes: list          # HalfSpaces among them that are not a floor; of the floors, only the highest is drawn


def upwards(file, task):
    """The axis that points most against gravity; y without gravity."""
    gravity = file.parameters.get("scene.gravity_m_s2")
    against = -gravity.values[task] if gravity is not None and gravity.values.ndim == 2 else np.zeros(3)
    up = np.zeros(3)
    largest = int(np.argmax(np.abs(against))) if np.any(against) else 1
    up[largest] = -1.0 if against[largest] < 0 else 1.0
    return up


def drawn_radius(trajectory):
    """Radius of every segment's spheres. A wall has no length and no radius; it is drawn wider than its rod."""
    radius = trajectory.radius.copy()
    for wall in np.flatnonzero(trajectory.length <= 0):
        radius[wall] = WALL_RADII * trajectory.radius[trajectory.rod == trajectory.rod[wall]].max()
    return radius


def staged(trajectory, frames, up, view, size, floor="auto", touched=()):
    """A Stage that shows all segments in all of these frames, obstacles near them, and their shadows on the floor.

    view: None, a name of VIEWS or (azimuth, elevation) in degrees; floor: "auto", "none" or a height [m]; touched:
    obstacles.of_task()."""
    low, high, spread = bounds(trajectory, frames)
    angles = VIEWS.get(view, view) if view else chosen_view(spread, low, high, up)
    framing = camera.Framing(camera.direction(*angles, up), up, size)
    solids = [obstacle for obstacle in touched if isinstance(obstacle, obstacles.Capsule)]
    slopes = [obstacle for obstacle in touched if isinstance(obstacle, obstacles.HalfSpace) and
              not obstacle.is_floor(up)]
    centre, extent = (low + high) / 2, float(np.linalg.norm(high - low))
    times = np.unique(trajectory.time_s[list(frames)][[0, -1]])
    still = [(solid.at(time).spheres(centre, extent), solid.radius) for solid in solids for time in times]
    still += [(rim(slope.at(time), centre, extent), 0.0) for slope in slopes for time in times]
    still = [(points, reach) for points, reach in still if len(points)]
    for points, reach in still:
        low, high = np.minimum(low, points.min(axis=0) - reach), np.maximum(high, points.max(axis=0) + reach)
    level = floor_level(trajectory, frames, up, floor, extent, touched, still)
    radius = drawn_radius(trajectory)
    moving = ((points, radius) for frame in frames for points in trajectory.ends(frame))
    for points, reach in (*still, *moving):
        framing.add(points, reach)
        if level is not None:
            framing.add(points + (level - points @ up)[:, None] * up, reach)
    return Stage(framing.camera(), up, level, centre, extent, solids, slopes)


def bounds(trajectory, frames):
    """Corners of the box around all segments in these frames, and the mean spread of their centres [3, 3]."""
    radius = drawn_radius(trajectory)[:, None]
    low, high, spread, count = np.full(3, np.inf), np.full(3, -np.inf), np.zeros((3, 3)), 0
    for frame in frames:
        points = trajectory.centres(frame)
        reach = radius + trajectory.length[:, None] / 2
        low, high = np.minimum(low, (points - reach).min(axis=0)), np.maximum(high, (points + reach).max(axis=0))
        middle = points - points.mean(axis=0)
        spread, count = spread + middle.T @ middle, count + len(points)
    if not np.isfinite(low).all() or not np.isfinite(high).all():
        raise KeyNotFound(f"task {trajectory.task} has positions that are not numbers in these frames: choose others "
                          "with --frame")
    return low, high, spread / count


def rim(slope, centre, extent):
    """Points [.., 3] on the rim of a slope's disc."""
    middle, radius = slope.disc(centre, extent)
    across, along = np.linalg.svd(slope.normal[None])[2][1:]
    turn = np.linspace(0, 2 * np.pi, obstacles.PIECES)[:, None]
    return middle + radius * (np.cos(turn) * across + np.sin(turn) * along)


def floor_level(trajectory, frames, up, floor, extent, touched=(), still=()):
    """Height along `up`, or None. "auto": the obstacles' floor; else where rods stand, if nothing is lower; else a
    little under the lowest point. still: (points, radius) of the drawn obstacles."""
    if floor != "auto":
        return None if floor == "none" else float(floor)
    given = obstacles.floor(touched, up)
    if given is not None:
        return given
    radius = drawn_radius(trajectory)
    ends = ((points, radius) for frame in frames for points in trajectory.ends(frame))
    lowest = min(float(np.min(points @ up - reach)) for points, reach in (*still, *ends))
    walls = (trajectory.length <= 0) & (trajectory.axes(frames[0]) @ up > np.cos(np.radians(GROUND_DEG)))
    under = np.where(walls, trajectory.centres(frames[0]) @ up, np.inf).min()
    return under + HAIR * extent if under - radius.max() <= lowest else lowest - GAP * extent


def chosen_view(spread, low, high, up):
    """Azimuth and elevation: slightly rotated from the broad side; the flatter the scene, the higher the eye."""
    right, back = camera.horizontal(up)
    plane = np.stack([right, back])
    values, vectors = np.linalg.eigh(plane @ spread @ plane.T)
    azimuth = TURN_DEG
    if values[1] > 1.7 * max(values[0], 0):
        normal = vectors[:, 0] if vectors[1, 0] >= 0 else -vectors[:, 0]
        azimuth += np.degrees(np.arctan2(normal[0], normal[1]))
    box = high - low
    wide, tall = np.linalg.norm(plane @ box), abs(up @ box)
    return azimuth, 12 + 20 * max(0.0, 1 - tall / wide)
