#!/usr/bin/python3
"""rodsweep compare from outside: sweeps that overlap, that differ on purpose, that are the same."""

import csv
import io
import json
import os
import shutil
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "analysis"))
import h5py
import numpy as np
from program import ALL_DONE, DATA, ROD, TASKS_FAILED, USER_ERROR, rodsweep, sweep
from rodsweep.reading import intervals
from rodsweep.reading.sweepfile import SweepFile

MANY = {"samples": 8, "scene": {**ROD, "segments": 8}}


class Case(unittest.TestCase):
    def compare(self, a, b, *words, code=ALL_DONE):
        said = rodsweep("compare", a, b, *words)
        self.assertEqual(said.returncode, code, f"{said.stdout}\n{said.stderr}")
        return said

    def found(self, a, b, *words, code=ALL_DONE):
        return json.loads(self.compare(a, b, *words, "--json", code=code).stdout)


class Compare(Case):
    def test_a_sweep_is_the_same_as_itself_made_again(self):
        again = "again.h5"
        sweep()
        self.assertEqual(rodsweep("run", "jobs/small.json", "-o", again).returncode, ALL_DONE)
        said = self.compare(sweep(), again).stdout
        self.assertIn("jobs: the same\ntasks: 4 in both, 0 in A alone, 0 in B alone\n"
                      "results: 4 compared, 4 the same to the last bit, 0 differ\n", said)
        self.assertNotIn("outcomes", said)
        self.assertRegex(said, r"CG ratio at 1e-2, mean of tasks that are ok in both\n"
                               r" +guess +A +B +B - A +95 % +tasks\n  previous +0\.\d+ +0\.\d+ +\+0 +- +4\n")
        self.assertRegex(said, r"times, medians\n.*\n  whole task ")

    def test_sweeps_overlap_in_what_both_have(self):
        other = sweep("wider", samples=3, scene={**ROD, "segments": {"grid": [11, 8]}},
                      guesses=["previous", "linear", "zero"], record={"solves": "summary"})
        found = self.found(sweep(), other)
        self.assertEqual({key: found["tasks"][key] for key in ("both", "only_a", "only_b", "compared", "differing")},
                         {"both": 2, "only_a": 2, "only_b": 4, "compared": 2, "differing": 0})
        self.assertEqual({key["key"] for key in found["keys"]},
                         {"samples", "scene.segments", 'guesses.{"oracle": {"error": 0.1, "label": "oracle 0.1"}}', "guesses.linear", "record.solves"})
        self.assertIn("/solves/iterations", found["left_out"])
        self.assertEqual({row["guess"] for row in found["cg_ratio"]}, {"previous"})
        self.assertIn("not compared, since it is not in both or of another length: /solves (12 columns)\n",
                      self.compare(sweep(), other).stdout)

    def test_what_differs_is_counted_by_column_and_makes_exit_code_3(self):
        a, b = sweep(), sweep("iterations", time={"step_s": 0.02, "steps": 6, "newton_iterations": 2})
        self.compare(a, b, code=USER_ERROR)
        found = self.found(a, b, "--by", "parameters", code=TASKS_FAILED)
        self.assertEqual((found["tasks"]["compared"], found["tasks"]["differing"]), (4, 4))
        self.assertEqual(found["keys"], [{"key": "time.newton_iterations", "a": 3, "b": 2}])
        columns = {row["column"]: row for row in found["columns"]}
        residual = columns["/steps/newton_residual"]
        with SweepFile(a) as one, SweepFile(b) as other:
            differ = one.h5["steps/newton_residual"][:] - other.h5["steps/newton_residual"][:]
        self.assertEqual((residual["tasks"], residual["values"]), (4, np.count_nonzero(differ)))
        self.assertEqual(residual["largest"], np.abs(differ).max())
        self.assertNotIn("/steps/time_s", columns)
        said = self.compare(a, b, "--by", "parameters", "--tasks", code=TASKS_FAILED).stdout
        self.assertIn("jobs: differ in 1 key\n  time.newton_iterations: 3 in A, 2 in B\n", said)
        self.assertIn("tasks that differ\n  task 0 (of B 0): /steps/", said)
        rows = list(csv.DictReader(io.StringIO(self.compare(a, b, "--by", "parameters", "--tasks", "--csv",
                                                            code=TASKS_FAILED).stdout)))
        self.assertEqual([row["task_a"] for row in rows], ["0", "1", "2", "3"])
        self.assertIn("/steps/newton_residual", rows[0]["columns"].split())

    def test_outcomes_that_changed_are_told(self):
        hard = {"evaluation": "closed_loop", "guesses": ["zero", "previous"]}
        a = sweep("easy", **hard, solve={"preconditioner": "none", "tolerance": 1e-2})
        b = sweep("hard", **hard, solve={"preconditioner": "none", "tolerance": 1e-2, "max_iterations": 2})
        said = self.compare(a, b, "--by", "parameters", code=TASKS_FAILED).stdout
        self.assertIn("outcomes: 8 changed\n  task 0 (of B 0): ok in A, iteration_limit in B\n", said)

    def test_a_loop_is_known_by_its_guess_wherever_the_job_lists_it(self):
        def loops(name, *before, sizes):
            return sweep(name, evaluation="closed_loop", samples=2,
                         guesses=[*before, {"subspace": {"size": {"grid": sizes}, "label": "subspace"}}])
        found = self.found(loops("loops", "zero", sizes=[2, 3]), loops("turned", "linear", "zero", sizes=[3, 2, 4]),
                           "--by", "parameters")["tasks"]
        self.assertEqual((found["both"], found["only_a"], found["differing"]), (16, 0, 0))

    def test_intervals_are_those_of_the_analysis(self):
        a = sweep("none", **MANY, solve={"preconditioner": "none"})
        b = sweep("jacobi", **MANY, solve={"preconditioner": "jacobi"})
        found = self.found(a, b, "--by", "parameters", code=TASKS_FAILED)
        with SweepFile(a) as one, SweepFile(b) as other:
            for row in found["cg_ratio"]:
                g, t = one.guesses.index(row["guess"]), one.tolerance_index(row["tolerance"])
                ratios = [np.array([file.results("cg_ratio", [task])[0][g, t] for task in range(8)]) for file in (one, other)]
                paired = intervals.mean((ratios[1] - ratios[0])[:, None], one.sample)
                self.assertEqual(row["tasks"], 8)
                self.assertAlmostEqual(row["a"], ratios[0].mean(), 12)
                self.assertAlmostEqual(row["b"], ratios[1].mean(), 12)
                self.assertAlmostEqual(row["difference"], float(paired.value[0]), 12)
                self.assertAlmostEqual(row["low"], float(paired.low[0]), 12)
                self.assertAlmostEqual(row["high"], float(paired.high[0]), 12)
        rows = list(csv.DictReader(io.StringIO(self.compare(a, b, "--by", "parameters", "--csv", code=TASKS_FAILED).stdout)))
        self.assertEqual([float(row["low"]) for row in rows], [row["low"] for row in found["cg_ratio"]])

    def test_pending_tasks_are_left_out(self):
        shutil.copy(sweep(), "part.h5")
        with h5py.File("part.h5", "r+") as h5:
            h5["tasks/state"][1] = 0
        said = self.compare(sweep(), "part.h5")
        self.assertIn("results: 3 compared (1 more not done in both), 3 the same to the last bit, 0 differ\n", said.stdout)

    def test_a_rerun_is_compared_with_its_sweep_and_a_data_set_with_a_larger_one(self):
        self.assertEqual(rodsweep("rerun", sweep(), 2, "-o", "one.h5").returncode, ALL_DONE)
        found = self.found(sweep(), "one.h5")
        self.assertEqual((found["tasks"]["both"], found["tasks"]["only_a"], found["tasks"]["differing"]), (1, 3, 0))
        found = self.found(sweep("data", **DATA), sweep("more", **DATA, samples=3))
        self.assertEqual((found["tasks"]["both"], found["tasks"]["only_b"], found["cg_ratio"]), (4, 2, []))

    def test_other_machines_are_told_beside_the_times(self):
        shutil.copy(sweep(), "elsewhere.h5")
        with h5py.File("elsewhere.h5", "r+") as h5:
            h5["runs/host"][0] = b"elsewhere"
        self.assertRegex(self.compare(sweep(), "elsewhere.h5").stdout, r"times, medians; other machines: \S+ and elsewhere\n")

    def test_files_that_share_no_task_or_are_none_are_refused(self):
        said = self.compare(sweep(), sweep("seeded", seed=9), code=USER_ERROR)
        self.assertIn("no task is in both files, so nothing was compared; --by parameters matches tasks though the jobs "
                      "differ", said.stderr)
        self.assertIn("seed: 3 in A, 9 in B", said.stdout)
        said = self.compare(sweep(), "nowhere.h5", code=USER_ERROR)
        self.assertIn("nowhere.h5: there is no such file", said.stderr)
        self.compare(sweep(), sweep(), "--by", "name", code=USER_ERROR)


if __name__ == "__main__":
    unittest.main()
