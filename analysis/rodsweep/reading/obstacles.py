"""Obstacles of a task: balls, capsules and half-spaces, in metres, at time 0; at(time_s) gives them at a later time.

Obstacles of a job are columns of /tasks/parameters, scene.obstacles[k].KIND.KEY. They are NaN if the task has no
obstacle, or one of another kind, at index k. Some scenes have their own floor y = 0. Rods without contact pass through
all obstacles, so their tasks have none.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from rodsweep.reading import constants

PIECES = 33       # spheres that approximate a capsule in the search for its near parts
LEVEL = 1e-9      # 1 - cosine of the angle up to which a plane is horizontal
DISC = 0.5        # radius of the visible part of a plane, as a share of the scene's extent


def at_rest():
    return field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True)
class Capsule:
    """All points nearer to a line than the radius; a ball if both ends are equal."""
    start: np.ndarray
    end: np.ndarray
    radius: float
    velocity: np.ndarray = at_rest()   # [m/s]

    def at(self, time_s):
        way = time_s * self.velocity
        return replace(self, start=self.start + way, end=self.end + way)

    def spheres(self, centre, extent):
        """Centres [sphere, 3] along the line within `extent` of a point; none if the radius is larger than `extent`."""
        points = np.linspace(self.start, self.end, PIECES)
        return points[(np.linalg.norm(points - centre, axis=1) <= extent) & (self.radius <= extent)]


@dataclass(frozen=True)
class HalfSpace:
    """All points x with (x - point).normal <= 0."""
    point: np.ndarray
    normal: np.ndarray   # unit vector out of the solid
    velocity: np.ndarray = at_rest()   # [m/s]

    def at(self, time_s):
        return replace(self, point=self.point + time_s * self.velocity)

    def disc(self, centre, extent):
        """Centre and radius of the visible part of its surface under a scene."""
        return centre - (centre - self.point) @ self.normal * self.normal, DISC * extent

    def is_floor(self, up):
        """Whether it is level and at rest."""
        return self.normal @ up >= 1 - LEVEL and not self.velocity.any()


def of_task(file, task):
    """Obstacles in the order of the job; the scene's own floor comes first."""
    if value(file, "scene.contact.friction", task) is None:
        return []
    found = [HalfSpace(np.zeros(3), np.array([0.0, 1, 0]))] if file.scene_types()[task] in constants.WITH_FLOOR else []
    place = 0
    while (obstacle := at_place(file, place, task)) is not None:
        found.append(obstacle)
        place += 1
    return found


def at_place(file, place, task):
    """The obstacle at an index of the task's list, None after its end."""
    def of(key):
        return value(file, f"scene.obstacles[{place}].{key}", task)

    def moving(kind):   # older files have no velocities
        velocity = of(f"{kind}.velocity_m_s")
        return {} if velocity is None else {"velocity": velocity}

    if (normal := of("half_space.normal")) is not None:
        return HalfSpace(of("half_space.point_m"), normal / np.linalg.norm(normal), **moving("half_space"))
    if (radius := of("ball.radius_m")) is not None:
        return Capsule(of("ball.centre_m"), of("ball.centre_m"), radius, **moving("ball"))
    if (radius := of("capsule.radius_m")) is not None:
        return Capsule(of("capsule.from_m"), of("capsule.to_m"), radius, **moving("capsule"))
    return None


def value(file, name, task):
    """A parameter's value for a task; None if it does not apply."""
    parameter = file.parameters.get(name)
    return parameter.values[task] if parameter is not None and parameter.applies()[task] else None


def floor(obstacles, up):
    """Height along `up` of the highest level surface at rest, None if there is none."""
    return max((obstacle.point @ up for obstacle in obstacles if isinstance(obstacle, HalfSpace) and
                obstacle.is_floor(up)), default=None)
