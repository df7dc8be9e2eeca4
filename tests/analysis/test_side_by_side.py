"""side_by_side.py: planted trajectories that separate by a known distance; render.py --beside."""

import unittest

import synthetic  # noqa: F401  (makes analysis/ importable)
import h5py
import numpy as np
import side_by_side
import trajectories
from rodsweep.reading import trajectory
from rodsweep.reading.sweepfile import SweepFile
from running import Scripts


class Planted(Scripts):
    def plant(self, parts=0.0, **settings):
        """Three closed loops from one start; the second method moves away by `parts` per frame."""
        self.write(scenes=("helix",), grid={"scene.segments": [6]}, samples=1, guesses=("zero", "previous", "quadratic"),
                   closed_loop=True, solves=False)
        trajectories.plant(self.path, rods=1, **settings)
        with h5py.File(self.path, "r+") as h5:
            for frame in range(4):
                row = h5["trajectories/first_row"][1, frame]
                h5["trajectories/position_m"][row:row + 6] += [0, 0, parts * frame]


class Figures(Planted):
    def test_the_distance_is_that_planted_and_a_task_that_ended_has_none(self):
        self.plant(parts=0.1, last=2)
        printed = self.run_script("side_by_side.py", "sweep.h5", "--moments", "0,0.04,0.12", files=True).stdout
        rows = {line.split()[0]: line.split()[1:] for line in printed.splitlines()[1:4]}
        self.assertEqual(rows["zero"][:3], ["0", "0", "-"])          # ended after two frames
        self.assertEqual(rows["previous"][:2], ["0", "0.1"])
        self.assertEqual(printed.split()[-2:], ["figures/sweep-beside.pdf", "figures/sweep-beside.png"])

    def test_what_starts_elsewhere_does_not_stand_beside(self):
        self.plant()
        with h5py.File(self.path, "r+") as h5:
            for task in (1, 2):
                row = h5["trajectories/first_row"][task, 0]
                h5["trajectories/position_m"][row:row + 6] += 1
        self.refused("side_by_side.py", "sweep.h5", words="task 0")

    def test_a_view_is_the_plane_of_the_motion(self):
        self.plant()
        with SweepFile(self.path) as file:
            plane = side_by_side.seen_from(trajectory.of_task(file, 0), np.array([0, 1.0, 0]))
        np.testing.assert_allclose(plane, [[1, 0, 0], [0, 1, 0]], atol=1e-12)


class Beside(Planted):
    def test_several_trajectories_are_one_with_a_rod_each_apart_and_the_shorter_stays(self):
        self.plant(last=2)
        with SweepFile(self.path) as file:
            parts = [trajectory.of_task(file, task) for task in (0, 1)]
            both = trajectory.Beside(parts, [0, 0, 2])
            self.assertEqual(both.frames(), 4)
            self.assertEqual(both.rod.tolist(), [0] * 6 + [1] * 6)
            np.testing.assert_allclose(both.centres(3)[:6], parts[0].centres(1))
            np.testing.assert_allclose(both.centres(3)[6:], parts[1].centres(3) + [0, 0, 2])
            low, high = both.ends(0)
            np.testing.assert_allclose(high - low, np.tile([0.2, 0, 0], (12, 1)), atol=1e-7)


if __name__ == "__main__":
    unittest.main()
