"""balance.py: errors against the finest step in balance, their times, refusals."""

import unittest

import h5py
import numpy as np

import running
from rodsweep.reading import accuracy

STEPS, FRAMES, SEGMENTS, SAMPLES = 4, 3, 5, 2
SIZES, KINDS = (0.02, 0.01), (0, 1)
OFF = {(0.02, 0): 0.3, (0.02, 1): 0.2, (0.01, 0): 0.1, (0.01, 1): 0}    # of a rod's length


class Balance(running.Scripts):
    def write(self, sizes=SIZES, **settings):
        super().write(**{"method": "direct", "scenes": ("helix",), "samples": SAMPLES, "steps": STEPS,
                         "grid": {"time.step_s": sizes, "time.balance": KINDS}, **settings})
        with h5py.File(self.path, "a") as h5:
            count = len(h5["tasks/state"])
            planted = np.repeat([OFF[size, kind] for size in sizes for kind in KINDS], SAMPLES)
            position = np.zeros((count, FRAMES, SEGMENTS, 3))
            position[..., 2] = np.linspace(0, 1, SEGMENTS)
            position[:, :-1, :, 0] = 7    # intermediate frames do not count
            position[:, 0, :, 0] = 0
            position[:, -1, :, 0] += np.resize(planted, count)[:, None]
            h5["trajectories/position_m"] = position.reshape(-1, 3)
            h5["trajectories/first_row"] = np.arange(count * FRAMES).reshape(count, FRAMES) * SEGMENTS
            h5["trajectories/time_s"] = np.tile([0, 0.5, 1.0], (count, 1))
            lacking = np.tile([1.0, 0.2, 0.3, 0.1], count)    # the value of the first step does not count
            h5["steps/momentum_residual"] = lacking

    def table(self, **files):
        said = self.run_script("balance.py", "sweep.h5", **files).stdout
        return [" ".join(line.split()) for line in said.split("\n\n")[0].splitlines()]

    def test_errors_are_those_of_the_end_against_the_finest_step_in_balance(self):
        self.write()
        self.assertEqual(self.table(files=True)[1:], ["helix 0.02 the paper's step 0.3 0.15 3 0.3",
                                            "in balance 0.2 0.15 3 0.3",
                                            "0.01 the paper's step 0.1 0.3 3 0.3",
                                            "in balance reference 0.3 3 0.3"])

    def test_scenes_have_panels_of_their_own(self):
        self.write(scenes=("helix", "bending_rod"))
        self.assertEqual([line.split(" 0.02")[0] for line in self.table() if " 0.02 " in line],
                         ["helix", "bending rod"])

    def test_of_one_time_step_there_is_a_table_and_no_figure(self):
        self.write(sizes=SIZES[:1])
        said = self.run_script("balance.py", "sweep.h5").stdout
        self.assertEqual([" ".join(line.split()) for line in said.splitlines()[1:] if line],
                         ["helix 0.02 the paper's step 0.1 0.15 3 0.3", "in balance reference 0.15 3 0.3"])

    def test_a_file_with_one_kind_of_step_is_refused(self):
        running.Scripts.write(self, method="direct", scenes=("helix",), samples=1, grid={"time.step_s": SIZES})
        self.refused("balance.py", "sweep.h5", words="time.balance")


class Times(running.Folder):
    def test_a_step_takes_the_median_of_its_rest_assembly_guess_and_own_solve(self):
        def interrupted(h5):
            h5["timing/steps/rest_s"][0] += 1

        # µs: rest 3, in each of three solves 2 of assembly and 8 of direct, or 1 of the guess and 5, 2.5, 2.5 of CG
        for closed_loop, microseconds in ((False, 33), (True, 22)):
            self.open(scenes=("helix",), guesses=("zero", "previous"), grid={"scene.segments": [10]}, samples=1,
                      closed_loop=closed_loop)
            file = self.changed(interrupted)
            self.assertAlmostEqual(1e6 * accuracy.step_s(file, file.task_count - 1), microseconds, 4)


if __name__ == "__main__":
    unittest.main()
