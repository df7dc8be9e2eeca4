"""balance.py, integrators.py, side_by_side.py: planted distances of trajectories, their table; the time of a step."""

import running
import h5py
import numpy as np
import side_by_side
import trajectories
from rodsweep.reading import accuracy, trajectory
from rodsweep.reading.sweepfile import SweepFile

SEGMENTS, SAMPLES = 5, 2
BALANCE = {"time.step_s": (0.02, 0.01), "time.balance": (0, 1)}
INTEGRATORS = {"time.step_s": (0.04, 0.02, 0.01, 0.005), "time.integrator": ("euler", "bdf2")}


class Errors(running.Scripts):
    def write(self, grid, off, middle=0, **settings):
        """Straight rods of length 1 in three frames: `middle` to the side, and at the end by a value of `off`, one for every
        combination of the grid."""
        super().write(**{"method": "direct", "scenes": ("helix",), "samples": SAMPLES, "steps": 4, "grid": grid, **settings})
        with h5py.File(self.path, "a") as h5:
            count = len(h5["tasks/state"])
            position = np.zeros((count, 3, SEGMENTS, 3))
            position[..., 2] = np.linspace(0, 1, SEGMENTS)
            position[:, 1, :, 0] = middle
            position[:, 2, :, 0] = np.resize(np.repeat(off, SAMPLES), count)[:, None]
            h5["trajectories/position_m"] = position.reshape(-1, 3)
            h5["trajectories/first_row"] = np.arange(count * 3).reshape(count, 3) * SEGMENTS
            h5["trajectories/time_s"] = np.tile([0, 0.5, 1.0], (count, 1))
            h5["steps/momentum_residual"] = np.tile([1.0, 0.2, 0.3, 0.1], count)    # that of the first step does not count

    def write_integrators(self, **grid):
        """Off by the step (euler) or 50 of its squares (bdf2); the reference, the smallest step of bdf2, is not off."""
        grid = {**INTEGRATORS, **grid}
        sizes, kinds = grid.values()
        self.write(grid, [0 if kind == "bdf2" and size == min(sizes) else size if kind == "euler" else 50 * size ** 2
                          for size in sizes for kind in kinds])

    def table(self, script, *arguments, files=False):
        said = self.run_script(script, "sweep.h5", *arguments, files=files).stdout
        return [" ".join(line.split()) for line in said.split("\n\n")[0].splitlines()]

    def test_balance_has_errors_of_the_end_against_the_finest_step_in_balance(self):
        self.write(BALANCE, [0.3, 0.2, 0.1, 0], middle=7)
        self.assertEqual(self.table("balance.py", files=True)[1:],
                         ["helix 0.02 step of Shao et al. 0.3 0.15 3 0.2", "Euler in balance 0.2 0.15 3 0.2",
                          "0.01 step of Shao et al. 0.1 0.3 3 0.2", "Euler in balance reference 0.3 3 0.2"])
        self.write(BALANCE, [0.3, 0.2, 0.1, 0], scenes=("helix", "bending_rod"))
        self.assertEqual([line.split(" 0.02")[0] for line in self.table("balance.py") if " 0.02 " in line],
                         ["helix", "bending rod"])

    def test_balance_of_one_time_step_is_a_table_and_no_figure(self):
        self.write({**BALANCE, "time.step_s": (0.02,)}, [0.1, 0])
        said = self.run_script("balance.py", "sweep.h5").stdout
        self.assertEqual([" ".join(line.split()) for line in said.splitlines()[1:] if line],
                         ["helix 0.02 step of Shao et al. 0.1 0.15 3 0.2", "Euler in balance reference 0.15 3 0.2"])

    def test_integrators_have_root_mean_squares_over_frames_against_the_smallest_step_of_bdf2(self):
        self.write_integrators()
        root, sizes = np.sqrt(2), INTEGRATORS["time.step_s"]    # one of two frames is off
        expected = ["error at a step of (s) 0.04 0.02 0.01 0.005 order",
                    " ".join(["helix, bdf2", *(f"{50 * size ** 2 / root:.2g}" for size in sizes[:3]), "- 2.00"]),
                    " ".join(["helix, euler", *(f"{size / root:.2g}" for size in sizes), "1.00"])]
        for choice in ((), ("--energy-step", "0.01")):
            self.assertEqual(self.table("integrators.py", "--columns", "scene.type", *choice, files=not choice), expected)

    def test_integrators_in_balance_are_against_the_best_kind_of_step_too(self):
        self.write({**INTEGRATORS, "time.balance": (1,)},
                   [0 if kind == "bdf2" and size == 0.005 else size for size in INTEGRATORS["time.step_s"]
                    for kind in INTEGRATORS["time.integrator"]])
        rows = {line.split(" 0.0")[0]: line.split() for line in self.table("integrators.py", "--columns", "scene.type")}
        self.assertEqual(rows["helix, bdf2 in balance"][-2:], ["-", "1.00"])
        self.assertEqual(rows["helix, euler in balance"][-2:], [f"{0.005 / np.sqrt(2):.2g}", "1.00"])
        said = self.run_script("integrators.py", "sweep.h5", "--energy-step", "0.3", code=2).stderr
        self.assertIn("--energy-step 0.3: the steps are 0.005, 0.01, 0.02, 0.04", said)

    def test_files_without_several_steps_or_trajectories_are_refused(self):
        self.write_integrators(**{"time.step_s": (0.02,), "time.integrator": ("bdf2",)})
        self.refused("integrators.py", "sweep.h5", words="time.step_s")
        super().write(method="direct", scenes=("helix",), samples=1, grid={"time.step_s": (0.02, 0.01)})
        self.refused("integrators.py", "sweep.h5", words="record.trajectory_every")


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


class SideBySide(running.Scripts):
    def plant(self, parts=0.0, **settings):
        """Three closed loops from one start; the second method moves away by `parts` per frame."""
        self.write(scenes=("helix",), grid={"scene.segments": [6]}, samples=1, guesses=("zero", "previous", "quadratic"),
                   closed_loop=True, solves=False)
        trajectories.plant(self.path, rods=1, **settings)
        with h5py.File(self.path, "r+") as h5:
            for frame in range(4):
                row = h5["trajectories/first_row"][1, frame]
                h5["trajectories/position_m"][row:row + 6] += [0, 0, parts * frame]

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

    def test_a_view_is_the_plane_of_the_motion_and_several_trajectories_are_one_where_the_shorter_stays(self):
        self.plant(last=2)
        with SweepFile(self.path) as file:
            parts = [trajectory.of_task(file, task) for task in (0, 1)]
            plane = side_by_side.seen_from(parts[1], np.array([0, 1.0, 0]))
            np.testing.assert_allclose(plane, [[1, 0, 0], [0, 1, 0]], atol=1e-12)
            both = trajectory.Beside(parts, [0, 0, 2])
            self.assertEqual((both.frames(), both.rod.tolist()), (4, [0] * 6 + [1] * 6))
            np.testing.assert_allclose(both.centres(3)[:6], parts[0].centres(1))
            np.testing.assert_allclose(both.centres(3)[6:], parts[1].centres(3) + [0, 0, 2])
            low, high = both.ends(0)
            np.testing.assert_allclose(high - low, np.tile([0.2, 0, 0], (12, 1)), atol=1e-7)
