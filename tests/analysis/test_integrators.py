"""integrators.py: errors against the smallest step of bdf2, their order, and refusals."""

import unittest

import h5py
import numpy as np

import running

FRAMES, SEGMENTS, SAMPLES = 3, 5, 2
SIZES, KINDS = (0.04, 0.02, 0.01, 0.005), ("euler", "bdf2")


class Integrators(running.Scripts):
    def write(self, sizes=SIZES, **settings):
        """The last frame is off by the step (euler) or 50 of its squares (bdf2), in lengths of the rod; the reference,
        the smallest step of bdf2, is not off."""
        super().write(**{"method": "direct", "scenes": ("helix",), "samples": SAMPLES, "steps": 4,
                         "grid": {"time.step_s": sizes, "time.integrator": KINDS}, **settings})
        with h5py.File(self.path, "a") as h5:
            count = len(h5["tasks/state"])
            off = [0 if kind == "bdf2" and size == min(sizes) else size if kind == "euler" else 50 * size ** 2
                   for size in sizes for kind in KINDS]
            position = np.zeros((count, FRAMES, SEGMENTS, 3))
            position[..., 2] = np.linspace(0, 1, SEGMENTS)
            position[:, -1, :, 0] = np.resize(np.repeat(off, SAMPLES), count)[:, None]
            h5["trajectories/position_m"] = position.reshape(-1, 3)
            h5["trajectories/first_row"] = np.arange(count * FRAMES).reshape(count, FRAMES) * SEGMENTS
            h5["trajectories/time_s"] = np.tile([0, 0.5, 1.0], (count, 1))

    def table(self, *arguments):
        said = self.run_script("integrators.py", "sweep.h5", "--columns", "scene.type", *arguments, files=True).stdout
        return [" ".join(line.split()) for line in said.split("\n\n")[0].splitlines()]

    def test_errors_are_root_mean_squares_over_frames_against_the_smallest_step_of_bdf2(self):
        self.write()
        root = np.sqrt(2)    # one of two frames is off
        self.assertEqual(self.table(), [
            "error at a step of (s) 0.04 0.02 0.01 0.005 order",
            " ".join(["helix, bdf2", *(f"{50 * size ** 2 / root:.2g}" for size in SIZES[:3]), "- 2.00"]),
            " ".join(["helix, euler", *(f"{size / root:.2g}" for size in SIZES), "1.00"])])

    def test_the_step_of_the_energies_can_be_chosen(self):
        self.write()
        self.assertEqual(len(self.table("--energy-step", "0.01")), 3)

    def test_a_file_with_one_step_or_without_trajectories_is_refused(self):
        self.write(sizes=SIZES[:1], grid={"time.step_s": SIZES[:1], "time.integrator": KINDS[1:]})
        self.refused("integrators.py", "sweep.h5", words="time.step_s")
        running.Scripts.write(self, method="direct", scenes=("helix",), samples=1, grid={"time.step_s": SIZES})
        self.refused("integrators.py", "sweep.h5", words="record.trajectory_every")


if __name__ == "__main__":
    unittest.main()
