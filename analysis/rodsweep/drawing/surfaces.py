"""Obstacles as triangles, for programs that draw surfaces."""

import numpy as np

from rodsweep.reading import obstacles

AROUND = 32     # corners of the polygon for a circle


def surface(obstacle, centre, extent):
    """Points [point, 3] and triangles [triangle, 3] of an obstacle's surface. A half-space is the disc under a scene
    of this centre and extent."""
    if isinstance(obstacle, obstacles.HalfSpace):
        middle, radius = obstacle.disc(centre, extent)
        return revolved([radius, 0], [0, 0], middle, obstacle.normal)
    along = obstacle.end - obstacle.start
    length = np.linalg.norm(along)
    axis = along / length if length > 0 else np.array([0.0, 0, 1])
    turn = np.linspace(-np.pi / 2, np.pi / 2, AROUND // 2 + 1)
    turn = np.insert(turn, len(turn) // 2, 0)   # the equator belongs to both half spheres
    height = obstacle.radius * np.sin(turn) + length * (np.arange(len(turn)) >= len(turn) // 2)
    return revolved(obstacle.radius * np.cos(turn), height, obstacle.start, axis)


def revolved(radii, heights, foot, axis):
    """Points and triangles of a profile [radius, height] rotated around an axis (unit vector)."""
    across = np.linalg.svd(axis[None])[2][1]
    turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)[:, None]
    circle = np.cos(turn) * across + np.sin(turn) * np.cross(axis, across)
    points = foot + np.concatenate([r * circle + h * axis for r, h in zip(radii, heights)])
    first = np.arange(AROUND)
    after = (first + 1) % AROUND
    strip = np.concatenate([np.stack([first, after, AROUND + after], -1),
                            np.stack([first, AROUND + after, AROUND + first], -1)])
    return points, np.concatenate([AROUND * k + strip for k in range(len(radii) - 1)])


def joined(surfaces):
    """Several surfaces as one."""
    before = np.cumsum([0, *(len(points) for points, _ in surfaces)])
    return (np.concatenate([points for points, _ in surfaces]),
            np.concatenate([triangles + first for (_, triangles), first in zip(surfaces, before)]))
