"""solvers.py and accuracy.py: errors, costs and the cheapest way, of planted trajectories and times."""

import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "..", "analysis"))
import h5py
import numpy as np

import running
import solvers
from reading import accuracy
from reading.sweepfile import SweepFile

WAYS = [("direct", 20, -1), ("direct", 2, -1), ("xpbd", 6, 50), ("pbd", 6, 5)]   # method, newton, iterations
OFF = (0, 1e-5, 1e-3, 0.2)        # from the reference, in rod lengths
STEP_S = (9e-5, 2e-5, 1e-5, 4e-6)
STEPS, FRAMES, SEGMENTS, SAMPLES = 4, 3, 5, 2


class Solvers(running.Scripts):
    def write(self):
        """Two rods by four ways, a row of /solves per step, and trajectories."""
        count = len(WAYS) * SAMPLES
        super().write(method="direct", scenes=("bending_rod",), samples=SAMPLES, steps=STEPS,
                      grid={"time.newton_iterations": tuple(newton for _, newton, _ in WAYS)})
        rows = np.arange(count) * STEPS
        way = np.repeat(np.arange(len(WAYS)), SAMPLES)
        linear = np.repeat([method == "direct" for method, _, _ in WAYS], SAMPLES)
        times = np.repeat(np.array(STEP_S)[way], STEPS).reshape(count, STEPS)
        times[:, 0] += 1     # a hiccup of the machine
        position = np.zeros((count, FRAMES, SEGMENTS, 3))
        position[..., 2] = np.linspace(0, 1, SEGMENTS)
        position[:, 1, :, 0] += np.array(OFF)[way, None]
        planted = {"tasks/first_solve": rows, "tasks/solves": np.full(count, STEPS),
                   "tasks/parameters/solve/method": np.array([m for m, _, _ in WAYS], dtype="S8")[way],
                   "tasks/parameters/solve/iterations": np.array([i for _, _, i in WAYS])[way],
                   "timing/steps/rest_s": np.where(linear[:, None], times - 1.5e-5, times).ravel(),
                   "timing/solves/assemble_s": np.repeat(np.where(linear, 5e-6, np.nan), STEPS),
                   "timing/solves/direct_s": np.repeat(np.where(linear, 1e-5, np.nan), STEPS),
                   "trajectories/position_m": position.reshape(-1, 3),
                   "trajectories/first_row": np.arange(count * FRAMES).reshape(count, FRAMES) * SEGMENTS}
        with h5py.File(self.path, "a") as h5:
            for name, values in planted.items():
                stored = name.replace("parameters/solve/", "parameters/solve.")
                attributes = dict(h5[stored].attrs) if stored in h5 else {}
                if stored in h5:
                    del h5[stored]
                h5[stored] = values
                h5[stored].attrs.update(attributes)

    def test_errors_are_those_of_the_worst_frame_and_costs_are_medians_over_steps(self):
        self.write()
        with SweepFile(self.path) as file:
            found = accuracy.accuracy(file, np.arange(len(WAYS) * SAMPLES))
        np.testing.assert_allclose(found.error, np.repeat(OFF, SAMPLES), atol=1e-15)
        np.testing.assert_allclose(found.step_s, np.repeat(STEP_S, SAMPLES), rtol=1e-5)
        self.assertEqual(found.reference.tolist(), [True] * SAMPLES + [False] * 3 * SAMPLES)
        self.assertEqual(found.family.tolist(), [m for m, _, _ in WAYS for _ in range(SAMPLES)])
        self.assertEqual(found.effort.tolist(), [20, 20, 2, 2, 50, 50, 5, 5])

    def test_the_cheapest_way_depends_on_the_error_allowed(self):
        self.write()
        said = self.run_script("solvers.py", "sweep.h5", "--rows", "time.step_s", "--columns", "time.step_s",
                               files=True).stdout
        row, = (line.split() for line in said.splitlines() if line.startswith("  time step"))
        self.assertEqual(row[-13:], ["xpbd", "50:", "10", "µs"] * 2 + ["direct", "2:", "20", "µs", "-"])
        self.assertTrue(said.rstrip().endswith("sweep-solvers.png"))

    def test_no_way_is_named_where_none_is_good_enough(self):
        estimate = lambda value: solvers.intervals.median(np.array([float(value)]))
        ways = {"pbd": [("5", estimate(4), estimate(0.2))], "xpbd": [("50", estimate(30), estimate(1e-3))]}
        self.assertEqual(solvers.cheapest(ways, 0.5), (4, "pbd", "5"))
        self.assertEqual(solvers.cheapest(ways, 1e-2), (30, "xpbd", "50"))
        self.assertIsNone(solvers.cheapest(ways, 1e-4))

    def test_files_without_trajectories_or_reference_are_refused(self):
        self.write()
        self.refused("solvers.py", "sweep.h5", "--select", "solve.method=pbd", words="no task of the direct solve")
        with h5py.File(self.path, "a") as h5:
            del h5["trajectories"]
        self.refused("solvers.py", "sweep.h5", words="record.trajectory_every")


if __name__ == "__main__":
    unittest.main()
