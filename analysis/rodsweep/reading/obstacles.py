"""What the rods of a task touch besides each other: balls, capsules and half-spaces, in metres, at time 0; at(time_s)
is where they have gone by then.

Obstacles of a job are columns of /tasks/parameters, scene.obstacles[k].KIND.KEY, NaN where a task's list has something
else or nothing in that place; falling_rods and coiling_rod have a floor y = 0 of their own. Rods without contact pass
through all of them: such a task has none.
"""

from dataclasses import dataclass, field, replace

import numpy as np

FLOORED = ("falling_rods", "coiling_rod")   # scenes with a floor of their own (solver/scene/scenes.cpp)
PIECES = 33       # spheres that stand for a capsule where one asks what is near
LEVEL = 1e-9      # 1 - cosine of the angle up to which a plane is horizontal
DISC = 0.5        # radius of the part of a plane that is shown, of the scene's extent


def at_rest():
    return field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True)
class Capsule:
    """All points nearer than the radius to a line; a ball where both ends are one."""
    start: np.ndarray
    end: np.ndarray
    radius: float
    velocity: np.ndarray = at_rest()   # [m/s]

    def at(self, time_s):
        way = time_s * self.velocity
        return replace(self, start=self.start + way, end=self.end + way)

    def spheres(self, centre, extent):
        """Centres [sphere, 3] along the line, those within `extent` of a point; none of a radius beyond `extent`."""
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
        """Centre and radius of the part of its surface that is shown under a scene."""
        return centre - (centre - self.point) @ self.normal * self.normal, DISC * extent

    def is_floor(self, up):
        """Level, and at rest."""
        return self.normal @ up >= 1 - LEVEL and not self.velocity.any()


def of_task(file, task):
    """In the order of the job, the scene's own floor first."""
    if value(file, "scene.contact.friction", task) is None:
        return []
    found = [HalfSpace(np.zeros(3), np.array([0.0, 1, 0]))] if file.scene_types()[task] in FLOORED else []
    place = 0
    while (obstacle := at_place(file, place, task)) is not None:
        found.append(obstacle)
        place += 1
    return found


def at_place(file, place, task):
    """The obstacle at a place of the task's list, None behind its end."""
    def of(key):
        return value(file, f"scene.obstacles[{place}].{key}", task)

    def moving(kind):   # files of before have no velocities
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
    """A parameter's value for a task; None where it has none."""
    parameter = file.parameters.get(name)
    return parameter.values[task] if parameter is not None and parameter.applies()[task] else None


def floor(obstacles, up):
    """Height along `up` of the highest level surface at rest, None where there is none."""
    return max((obstacle.point @ up for obstacle in obstacles if isinstance(obstacle, HalfSpace) and
                obstacle.is_floor(up)), default=None)
