#!/usr/bin/python3
"""Shards of a sweep, and the one file that they become: what a single run writes, bit for bit.

Run by CTest in an empty folder, with RODSWEEP and MPIRUN in the environment.
"""

import os
import tempfile
import unittest

import h5py
from test_sweeps import ALL_DONE, RODSWEEP, STOPPED, SweepCase, TASKS_FAILED, USER_ERROR, checksum, data_job, job, rodsweep, status


class Merging(SweepCase):
    def setUp(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(tempfile.mkdtemp(dir="."))

    def shards(self, path, of, numbers=None, ranks=0):
        """Runs them, and returns their files."""
        files = []
        for number in numbers or range(1, of + 1):
            self.assert_exit(rodsweep(ranks, "run", path, "--shard", f"{number}/{of}"), ALL_DONE)
            files.append(f"results/{path.replace('.json', '')}-{number}of{of}.h5")
        return files

    def test_shards_become_what_a_single_run_writes(self):
        for path, ranks in ((job("sweep", samples=5, segments=(6, 40)), 2), (data_job("set", samples=4), 0)):
            with self.subTest(path=path):
                self.assert_exit(rodsweep(0, "run", path, "-o", "single.h5"), ALL_DONE)
                files = self.shards(path, 3, ranks=ranks)
                done = [status(file)["done"] for file in files]
                self.assertEqual(sum(done), status("single.h5")["tasks"])
                self.assertLessEqual(max(done) - min(done), 1)
                merged = rodsweep(0, "merge", *files, "-o", "merged.h5")
                self.assert_exit(merged, ALL_DONE)
                self.assertEqual(merged.stderr, "")
                self.assert_whole("merged.h5")
                self.assert_same_results("single.h5", "merged.h5")
                starts = status("merged.h5")["starts"]
                self.assertEqual([s["tasks"] for s in starts], [*done, 0])
                self.assertIn("--shard 2/3", starts[1]["command"])
                self.assertIn(" merge ", starts[3]["command"])
                self.assertEqual(rodsweep(0, "merge", *files, "-o", "merged.h5").returncode, USER_ERROR)  # never overwritten
                for file in ("single.h5", "merged.h5", *files):
                    os.remove(file)

    def test_a_shard_counts_its_own_tasks(self):
        path = job("counted", samples=5)
        run = rodsweep(2, "run", path, "--shard", "2/4")
        self.assert_exit(run, ALL_DONE)
        self.assertIn("shard 2 of 4 of counted, 3 of 10 tasks, results in results/counted-2of4.h5", run.stderr)
        self.assertIn("shard 2 of 4, 3 of 10 tasks: 3 ok", run.stdout)
        self.assertIn(f"{RODSWEEP} merge results/counted-*of4.h5 -o results/counted.h5", run.stdout)
        self.assertIn("counted, shard 2 of 4: 3 of 3 tasks done (100 %): 3 ok",
                      rodsweep(0, "status", "results/counted-2of4.h5").stdout)
        self.assertEqual(status("results/counted-2of4.h5")["shard"], {"number": 2, "of": 4, "tasks": 3})
        self.shards(path, 4, (1, 3, 4))
        self.assert_exit(rodsweep(0, "merge", *(f"results/counted-{n}of4.h5" for n in range(1, 5)), "-o", "results/counted.h5"),
                         ALL_DONE)
        self.assertEqual(status("results/counted.h5")["shard"], None)

    def test_costs_are_shared_out(self):
        path = job("costs", samples=1, segments=[5] * 4 + [50] * 4)
        files = self.shards(path, 4)
        for file in files:
            with h5py.File(file) as results:
                done = results["tasks/state"][:] == 1
                self.assertEqual(sorted(results["tasks/parameters/scene.segments"][done]), [5, 50])

    def test_what_is_missing_is_left_to_do(self):
        path = job("missing")
        files = self.shards(path, 3, (1, 3))
        self.assert_exit(rodsweep(0, "merge", *files, "-o", "merged.h5"), STOPPED)
        self.assertEqual(status("merged.h5")["pending"], 2)
        self.assert_exit(rodsweep(2, "run", path, "-o", "merged.h5", "--resume"), ALL_DONE)
        self.assert_exit(rodsweep(0, "run", path, "-o", "single.h5"), ALL_DONE)
        self.assert_same_results("single.h5", "merged.h5")

    def test_a_damaged_task_is_left_to_do_or_taken_from_where_it_is_sound(self):
        path = job("damaged")
        self.assert_exit(rodsweep(0, "run", path, "-o", "whole.h5"), ALL_DONE)
        one, two = self.shards(path, 2)
        with h5py.File(one, "r+") as file:
            task = int((file["tasks/state"][:] == 1).nonzero()[0][0])
            row = int(file["tasks/first_step"][task])
            file["steps/joint_gap"][row] += 1
        before = checksum(one)
        merged = rodsweep(0, "merge", one, two, "-o", "merged.h5")
        self.assert_exit(merged, STOPPED)
        self.assertIn(f"left to do: task {task}", merged.stderr)
        self.assert_exit(rodsweep(0, "merge", one, two, "whole.h5", "-o", "all.h5"), ALL_DONE)
        self.assert_same_results("whole.h5", "all.h5")
        self.assertEqual(checksum(one), before)

    def test_results_that_differ_are_told(self):
        path = job("differ", scene={"type": "bending_rod", "segments": 5, "length_m": {"uniform": [1, 5]}, "radius_m": 0.05,
                                    "density_kg_m3": 1000, "youngs_modulus_pa": 1e5, "torsion_modulus_pa": 1e6})
        self.assert_exit(rodsweep(0, "run", path, "-o", "one.h5"), ALL_DONE)
        self.assert_exit(rodsweep(0, "run", path, "-o", "two.h5", "--task-time-limit", "0.000001"), TASKS_FAILED)
        merged = rodsweep(0, "merge", "one.h5", "two.h5", "-o", "merged.h5")
        self.assert_exit(merged, ALL_DONE)
        self.assertIn("3 tasks, the first being 0, differ between files", merged.stderr)
        self.assert_same_results("one.h5", "merged.h5")

    def test_files_of_different_jobs_are_refused(self):
        files = [*self.shards(job("one"), 1), *self.shards(job("other", seed=6), 1)]
        refused = rodsweep(0, "merge", *files, "-o", "merged.h5")
        self.assert_exit(refused, USER_ERROR)
        self.assertIn("is of another job than", refused.stderr)
        self.assertFalse(os.path.exists("merged.h5"))

    def test_a_shard_that_is_none_is_refused(self):
        for text in ("0/2", "3/2", "2", "1/2x", "a/b"):
            with self.subTest(text=text):
                refused = rodsweep(0, "run", job(), "--shard", text)
                self.assertNotEqual(refused.returncode, ALL_DONE)
                self.assertIn("is no I/N", refused.stderr)

    def test_more_shards_than_tasks_leave_some_with_nothing(self):
        path = job("few", samples=1)
        self.assert_exit(rodsweep(0, "merge", *self.shards(path, 4), "-o", "merged.h5"), ALL_DONE)


if __name__ == "__main__":
    unittest.main()
