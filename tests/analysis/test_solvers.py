"""solvers.py and accuracy.py: errors, costs and the cheapest method for planted trajectories and times."""

import unittest

import ways
import h5py
import numpy as np
from rodsweep.reading import accuracy, intervals
from rodsweep.reading.sweepfile import SweepFile
from ways import OFF, SAMPLES, STEP_S, WAYS


def point(way, time_us, error):
    estimate = lambda value: intervals.median(np.array([float(value)]))
    return accuracy.Point(way, estimate(time_us), estimate(error))


class Solvers(ways.Planted):
    def accuracy(self, **settings):
        self.write(**settings)
        file = self.opened()
        return file, accuracy.accuracy(file, np.arange(file.task_count))

    def test_errors_are_those_of_the_worst_frame_and_costs_are_medians_over_steps(self):
        _, found = self.accuracy()
        np.testing.assert_allclose(found.error, np.repeat(OFF, SAMPLES), atol=1e-15)
        np.testing.assert_allclose(found.step_s, np.repeat(STEP_S, SAMPLES), rtol=1e-5)
        self.assertEqual(found.reference.tolist(), [True] * SAMPLES + [False] * (len(WAYS) - 1) * SAMPLES)
        self.assertEqual(found.ways, [way for way in WAYS for _ in range(SAMPLES)])

    def test_every_scene_has_its_own_reference_also_where_a_vector_is_none_of_its_keys(self):
        self.write(scenes=("bending_rod", "net"))
        with h5py.File(self.path, "a") as h5:
            count = len(h5["tasks/state"])
            wind = np.where(np.arange(count)[:, None] < count // 2, np.nan, [8.0, 0, 0])
            h5["tasks/parameters/scene.wind.mean_m_s"] = wind
        with SweepFile(self.path) as file:
            found = accuracy.accuracy(file, np.arange(count))
        np.testing.assert_allclose(found.error, np.tile(np.repeat(OFF, SAMPLES), 2), atol=1e-15)
        self.assertEqual(found.reference.sum(), 2 * SAMPLES)

    def test_a_way_that_failed_once_has_no_point_and_a_failed_reference_is_none(self):
        failed = WAYS.index(accuracy.Way("xpbd", iterations=50))
        file, found = self.accuracy(failed={SAMPLES * failed + 1: "torn", 1: "diverged"})
        everything = np.ones(file.task_count, dtype=bool)
        self.assertEqual(found.reference.tolist()[:2 * SAMPLES], [True, False, False, True])
        self.assertEqual({p.way for p in accuracy.points(file, found, everything)}, set(WAYS[1:]) - {WAYS[failed]})

    def test_points_of_a_family_go_from_the_least_effort_to_the_most(self):
        file, found = self.accuracy()
        points = accuracy.points(file, found, np.ones(file.task_count, dtype=bool))
        self.assertEqual([p.way for p in points], WAYS[1:-2] + [WAYS[-1], WAYS[-2]])   # 1e-1 before 1e-2
        self.assertEqual([(p.way.family, p.way.effort) for p in points[:4]],
                         [("direct", 2), ("xpbd", 50), ("pbd", 5), ("CG jacobi from zero", 1e-2)])

    def test_the_cheapest_way_depends_on_the_error_allowed(self):
        self.write()
        said = self.run_script("solvers.py", "sweep.h5", "--rows", "time.step_s", "--columns", "time.step_s",
                               files=True).stdout
        row, = (line.split() for line in said.splitlines() if line.startswith("  time step"))
        self.assertEqual(row[-13:], ["xpbd", "50:", "10", "µs"] * 2 + ["direct", "2:", "20", "µs", "-"])
        self.assertTrue(said.rstrip().endswith("sweep-solvers.png"))

    def test_no_way_is_the_cheapest_where_none_is_good_enough_and_none_is_kept_that_costs_more_and_is_no_better(self):
        pbd, xpbd = point(WAYS[3], 4, 0.2), point(WAYS[2], 30, 1e-3)
        self.assertEqual(accuracy.cheapest([xpbd, pbd], 0.5), pbd)
        self.assertEqual(accuracy.cheapest([xpbd, pbd], 1e-2), xpbd)
        self.assertIsNone(accuracy.cheapest([xpbd, pbd], 1e-4))
        slow, good, worse, same = (point(WAYS[k], *values)
                                   for k, values in enumerate([(9, 1e-9), (4, 1e-5), (5, 1e-3), (20, 1e-12)]))
        self.assertEqual(accuracy.envelope([slow, worse, same, good], 1e-8), [good, slow])

    def test_files_without_trajectories_or_reference_are_refused(self):
        self.write()
        self.refused("solvers.py", "sweep.h5", "--select", "solve.method=pbd", words="direct solve")
        with h5py.File(self.path, "a") as h5:
            del h5["trajectories"]
        self.refused("solvers.py", "sweep.h5", words="record.trajectory_every")


if __name__ == "__main__":
    unittest.main()
