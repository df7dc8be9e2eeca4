#!/usr/bin/python3
"""Shards of a sweep and their merged file, which equals that of a single run bit for bit.

Run by CTest in an empty folder, with RODSWEEP and MPIRUN in the environment.
"""

import os
import tempfile
import unittest

import h5py
from program import STOPPED, SweepCase, TASKS_FAILED, USER_ERROR, checksum, data_job, job, status


class Merging(SweepCase):
    def setUp(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(tempfile.mkdtemp(dir="."))

    def shards(self, path, of, numbers=None, ranks=0):
        """Runs the shards; returns their files."""
        files = []
        for number in numbers or range(1, of + 1):
            self.rodsweep(ranks, "run", path, "--shard", f"{number}/{of}")
            files.append(f"results/{path.replace('.json', '')}-{number}of{of}.h5")
        return files

    def test_shards_become_what_a_single_run_writes(self):
        for path, ranks in ((job("sweep", samples=5, segments=(6, 40)), 2), (data_job("set", samples=4), 0)):
            with self.subTest(path=path):
                self.rodsweep(0, "run", path, "-o", "single.h5")
                files = self.shards(path, 3, ranks=ranks)
                done = [status(file)["done"] for file in files]
                self.assertEqual(sum(done), status("single.h5")["tasks"])
                self.assertLessEqual(max(done) - min(done), 1)
                merged = self.rodsweep(0, "merge", *files, "-o", "merged.h5")
                self.assertEqual(merged.stderr, "")
                self.assert_whole("merged.h5")
                self.assert_same_results("single.h5", "merged.h5")
                starts = status("merged.h5")["runs"]
                self.assertEqual([s["tasks"] for s in starts], [*done, 0])
                self.assertIn("--shard 2/3", starts[1]["command"])
                self.assertIn(" merge ", starts[3]["command"])
                self.rodsweep(0, "merge", *files, "-o", "merged.h5", code=USER_ERROR)  # not overwritten
                for file in ("single.h5", "merged.h5", *files):
                    os.remove(file)

    def test_a_shard_counts_its_own_tasks(self):
        path = job("counted", samples=5)
        run = self.rodsweep(2, "run", path, "--shard", "2/4")
        self.assertRegex(run.stderr, r"2 of 4 .*3 of 10 tasks.*results/counted-2of4\.h5")
        self.assertRegex(self.rodsweep(0, "status", "results/counted-2of4.h5").stdout, r"2 of 4: 3 of 3 tasks")
        self.assertEqual(status("results/counted-2of4.h5")["shard"], {"number": 2, "of": 4, "tasks": 3})
        self.assert_refused_once(2, "run", path, "--shard", "1/4", "-o", "results/counted-2of4.h5", "--resume",
                                 says="results/counted-2of4.h5 holds shard 2/4, not 1/4")
        others = self.shards(path, 4, (1, 3, 4))
        self.rodsweep(0, "merge", *others, "results/counted-2of4.h5", "-o", "results/counted.h5")
        self.assertEqual(status("results/counted.h5")["shard"], None)

    def test_what_is_missing_is_left_to_do(self):
        path = job("missing")
        files = self.shards(path, 3, (1, 3))
        self.rodsweep(0, "merge", *files, "-o", "merged.h5", code=STOPPED)
        self.assertEqual(status("merged.h5")["pending"], 2)
        self.rodsweep(2, "run", path, "-o", "merged.h5", "--resume")
        self.rodsweep(0, "run", path, "-o", "single.h5")
        self.assert_same_results("single.h5", "merged.h5")

    def test_a_damaged_task_is_left_to_do_or_taken_from_where_it_is_sound(self):
        path = job("damaged")
        self.rodsweep(0, "run", path, "-o", "whole.h5")
        one, two = self.shards(path, 2)
        with h5py.File(one, "r+") as file:
            task = int((file["tasks/state"][:] == 1).nonzero()[0][0])
            row = int(file["tasks/first_step"][task])
            file["steps/joint_gap"][row] += 1
        before = checksum(one)
        merged = self.rodsweep(0, "merge", one, two, "-o", "merged.h5", code=STOPPED)
        self.assertIn(f"task {task}", merged.stderr)
        self.rodsweep(0, "merge", one, two, "whole.h5", "-o", "all.h5")
        self.assert_same_results("whole.h5", "all.h5")
        self.assertEqual(checksum(one), before)

    def test_results_that_differ_are_told(self):
        path = job("differ", scene={"type": "bending_rod", "segments": 5, "length_m": {"uniform": [1, 5]}, "radius_m": 0.05,
                                    "density_kg_m3": 1000, "youngs_modulus_pa": 1e5, "torsion_modulus_pa": 1e6})
        self.rodsweep(0, "run", path, "-o", "one.h5")
        self.rodsweep(0, "run", path, "-o", "two.h5", "--task-time-limit", "0.000001", code=TASKS_FAILED)
        merged = self.rodsweep(0, "merge", "one.h5", "two.h5", "-o", "merged.h5")
        self.assertRegex(merged.stderr, r"differ .*\b3 tasks \(first: 0\)")
        self.assert_same_results("one.h5", "merged.h5")

    def test_files_of_different_jobs_are_refused(self):
        files = [*self.shards(job("one"), 1), *self.shards(job("other", seed=6), 1)]
        self.assert_refused_once(0, "merge", *files, "-o", "merged.h5", says=files)
        self.assertFalse(os.path.exists("merged.h5"))

    def test_a_shard_that_is_none_is_refused(self):
        """For all invalid shards see tests/runner/command/test_command_line.cpp."""
        refused = self.rodsweep(0, "run", job(), "--shard", "3/2", code=USER_ERROR)
        self.assertIn("3/2", refused.stderr)

    def test_more_shards_than_tasks_leave_some_with_nothing(self):
        path = job("few", samples=1)
        self.rodsweep(0, "merge", *self.shards(path, 4), "-o", "merged.h5")


if __name__ == "__main__":
    unittest.main()
