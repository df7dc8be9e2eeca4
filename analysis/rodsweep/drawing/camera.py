"""A perspective camera that shows all given spheres as large as possible.

Camera coordinates of a point p are c = (p . right, p . up, p . forward). Let e be the eye and t the tangent of half
the horizontal angle of view. A sphere of radius r is right of the left edge of the picture if c_x - e_x + t (c_z -
e_z) >= r sqrt(1 + t^2). Each of the four edges gives such a bound on e, and the strictest bound over all spheres
counts. The eye nearest to the scene meets the two horizontal or the two vertical bounds with equality. Only minima are
kept, so spheres can be added frame by frame.
"""

from dataclasses import dataclass

import numpy as np

ANGLE_DEG = 26     # of view, along the longer side of the picture
MARGIN = 0.05      # free space at each edge, as a share of half the picture


@dataclass(frozen=True)
class Camera:
    eye: np.ndarray
    right: np.ndarray
    up: np.ndarray
    forward: np.ndarray
    tangents: tuple    # of half the angles of view, across and upwards
    size: tuple        # pixels

    def project(self, points):
        """Pixel coordinates [point, 2], from the upper left corner, and depth along the line of sight [point]."""
        away = np.asarray(points) - self.eye
        x, y, depth = away @ self.right, away @ self.up, away @ self.forward
        width, height = self.size
        across, upwards = self.tangents
        return np.stack([width / 2 * (1 + x / (depth * across)), height / 2 * (1 - y / (depth * upwards))], -1), depth


class Framing:
    """Collects spheres and gives a camera that shows all of them. `towards_eye`: from the scene to the viewer."""

    def __init__(self, towards_eye, up, size):
        self.forward = -np.asarray(towards_eye) / np.linalg.norm(towards_eye)
        right = np.cross(self.forward, up)
        self.right = right / np.linalg.norm(right)
        self.up = np.cross(self.right, self.forward)
        self.size = size
        half = np.tan(np.radians(ANGLE_DEG / 2))
        self.tangents = tuple(half * side / max(size) for side in size)
        self.bounds = np.full((2, 2), np.inf)   # [across or upwards, which edge]

    def add(self, points, radius):
        points = np.asarray(points)
        z = points @ self.forward
        for k, (direction, tangent) in enumerate(zip((self.right, self.up), self.tangents)):
            t = (1 - MARGIN) * tangent
            along, reach = points @ direction, t * z - radius * np.hypot(1, t)
            self.bounds[k] = np.minimum(self.bounds[k], [np.min(along + reach), np.min(reach - along)])

    def camera(self):
        low, high = self.bounds.T
        depth = np.min((low + high) / (2 * (1 - MARGIN) * np.array(self.tangents)))
        across, upwards = (low - high) / 2
        eye = across * self.right + upwards * self.up + depth * self.forward
        return Camera(eye, self.right, self.up, self.forward, self.tangents, self.size)


def direction(azimuth_deg, elevation_deg, up):
    """From the scene to the eye. Azimuth: 0 is the front, 90 the side to the right of it; elevation: 90 is above."""
    right, back = horizontal(up)
    azimuth, elevation = np.radians([azimuth_deg, elevation_deg])
    return np.cos(elevation) * (np.sin(azimuth) * right + np.cos(azimuth) * back) + np.sin(elevation) * np.asarray(up)


def horizontal(up):
    """Unit vectors to the right and towards the eye in a front view: x and z for up y, x and -y for up z, -y and z for
    up x."""
    right = np.array([0.0, -1, 0]) if abs(up[0]) > 0.9 else np.array([1.0, 0, 0])
    return right, np.cross(right, up)
