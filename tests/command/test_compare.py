#!/usr/bin/python3
"""rodsweep compare on sweeps that overlap, that differ on purpose, that are equal. Most of it runs in this process, since
a new Python takes a second or two to start."""

import csv
import io
import json
import os
import sys
import unittest

TESTS = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path[:0] = [os.path.join(TESTS, "..", "analysis"), os.path.join(TESTS, "analysis")]
import numpy as np
import running
from program import ALL_DONE, DAMAGED, DATA, DIFFER, ROD, USER_ERROR, Case, changed, rodsweep, sweep
from rodsweep.reading import intervals
from rodsweep.reading.sweepfile import SweepFile

MANY = {"samples": 8, "scene": {**ROD, "segments": 8}}


class Compare(Case):
    def compare(self, a, b, *words, code=ALL_DONE):
        done = running.run("compare.py", a, b, *words)
        self.assertEqual(done.code, code, f"{done.stdout}\n{done.stderr}")
        return done.stdout

    def found(self, a, b, *words, code=ALL_DONE):
        return json.loads(self.compare(a, b, *words, "--json", code=code))

    @staticmethod
    def counts(found):
        return tuple(found["tasks"][key] for key in ("both", "only_a", "only_b", "compared", "differing"))

    def by_parameters(self, a, b, *words):
        """Compares by parameters; the tasks must differ."""
        return self.compare(a, b, "--by", "parameters", *words, code=DIFFER)

    def test_a_sweep_is_the_same_as_itself_made_again(self):
        sweep()
        self.said("run", "jobs/small.json", "-o", "again.h5")
        found = self.found(sweep(), "again.h5")
        self.assertEqual((found["keys"], self.counts(found)), ([], (4, 0, 0, 4, 0)))
        said = self.compare(sweep(), "again.h5")
        self.assertEqual(self.said("compare", sweep(), "again.h5"), said)
        self.assertNotIn("outcomes", said)
        self.assertRegex(said, r"CG ratio at 1e-2.*\n +guess +A +B +B - A +95 % +tasks\n"
                               r"  previous +0\.\d+ +0\.\d+ +\+0 +- +4\n")
        self.assertRegex(said, r"times, medians\n.*\n  whole task ")

    def test_damage_in_either_file_is_no_difference(self):
        def flip(path, row, value):
            def change(h5):
                h5[path][row] = value
            return change
        for name, path, row, value in (("value", "/steps/joint_gap", 7, 5.0), ("sum", "/tasks/checksum", 1, 7),
                                       ("rows", "/tasks/steps", 1, 5)):
            damaged = changed(f"{name}.h5", flip(path, row, value))
            for pair in ((sweep(), damaged), (damaged, sweep())):
                with self.subTest(of=name, pair=pair):
                    done = running.run("compare.py", *pair, "--json")
                    self.assertEqual(done.code, DAMAGED, done.stderr)
                    self.assertEqual(json.loads(done.stdout)["damaged"], [1])
                    self.assertIn("task 1 contradict each other", done.stderr)
        refused = running.run("compare.py", sweep(), changed("state.h5", flip("/tasks/state", 2, 9)))
        self.assertEqual(refused.code, USER_ERROR)
        self.assertIn("state.h5 is damaged: /tasks/state of task 2 is 9; must be 0 or 1", refused.stderr)

    def test_sweeps_overlap_in_what_both_have(self):
        other = sweep("wider", samples=3, scene={**ROD, "segments": {"grid": [11, 8]}},
                      guesses=["previous", "linear", "zero"], record={"solves": "summary"})
        found = self.found(sweep(), other)
        self.assertEqual(self.counts(found), (2, 2, 4, 2, 0))
        self.assertEqual({key["key"] for key in found["keys"]},
                         {"samples", "scene.segments", 'guesses.{"oracle": {"error": 0.1, "label": "oracle 0.1"}}',
                          "guesses.linear", "record.solves"})
        self.assertIn("/solves/iterations", found["left_out"])
        self.assertEqual({row["guess"] for row in found["cg_ratio"]}, {"previous"})
        self.assertIn("/solves (12 columns)", self.compare(sweep(), other))

    def test_what_differs_is_counted_by_column_and_makes_exit_code_8(self):
        a, b = sweep(), sweep("iterations", time={"step_s": 0.02, "steps": 6, "newton_iterations": 2})
        self.compare(a, b, code=USER_ERROR)
        found = json.loads(self.by_parameters(a, b, "--json"))
        self.assertEqual((found["tasks"]["compared"], found["tasks"]["differing"]), (4, 4))
        self.assertEqual(found["keys"], [{"key": "time.newton_iterations", "a": 3, "b": 2}])
        columns = {row["column"]: row for row in found["columns"]}
        residual = columns["/steps/newton_residual"]
        with SweepFile(a) as one, SweepFile(b) as other:
            differ = one.h5["steps/newton_residual"][:] - other.h5["steps/newton_residual"][:]
        self.assertEqual((residual["tasks"], residual["values"]), (4, np.count_nonzero(differ)))
        self.assertEqual(residual["largest"], np.abs(differ).max())
        self.assertNotIn("/steps/time_s", columns)
        said = self.by_parameters(a, b, "--tasks")
        self.assertIn("  time.newton_iterations: 3 in A, 2 in B\n", said)
        self.assertIn("  task 0 (of B 0): /steps/", said)
        rows = list(csv.DictReader(io.StringIO(self.by_parameters(a, b, "--tasks", "--csv"))))
        self.assertEqual([row["task_a"] for row in rows], ["0", "1", "2", "3"])
        self.assertIn("/steps/newton_residual", rows[0]["columns"].split())

    def test_outcomes_that_changed_are_told(self):
        hard = {"evaluation": "closed_loop", "guesses": ["zero", "previous"]}
        a = sweep("easy", **hard, solve={"preconditioner": "none", "tolerance": 1e-2})
        b = sweep("hard", **hard, solve={"preconditioner": "none", "tolerance": 1e-2, "max_iterations": 2})
        self.assertRegex(self.by_parameters(a, b),
                         r"outcomes: 8 .*\n  task 0 \(of B 0\): ok in A, iteration_limit in B\n")

    def test_a_loop_is_known_by_its_guess_wherever_the_job_lists_it(self):
        def loops(name, *before, sizes):
            return sweep(name, evaluation="closed_loop", samples=2,
                         guesses=[*before, {"subspace": {"size": {"grid": sizes}, "label": "subspace"}}])
        a, b = loops("loops", "zero", sizes=[2, 3]), loops("turned", "linear", "zero", sizes=[3, 2, 4])
        both, only_a, *_, differing = self.counts(self.found(a, b, "--by", "parameters"))
        self.assertEqual((both, only_a, differing), (16, 0, 0))

    def test_intervals_are_those_of_the_analysis(self):
        a = sweep("none", **MANY, solve={"preconditioner": "none"})
        b = sweep("jacobi", **MANY, solve={"preconditioner": "jacobi"})
        found = json.loads(self.by_parameters(a, b, "--json"))
        with SweepFile(a) as one, SweepFile(b) as other:
            for row in found["cg_ratio"]:
                g, t = one.guesses.index(row["guess"]), one.tolerance_index(row["tolerance"])
                ratios = [np.array([file.results("cg_ratio", [task])[0][g, t] for task in range(8)])
                          for file in (one, other)]
                paired = intervals.mean((ratios[1] - ratios[0])[:, None], one.sample)
                self.assertEqual(row["tasks"], 8)
                for name, value in (("a", ratios[0].mean()), ("b", ratios[1].mean()), ("difference", paired.value[0]),
                                    ("low", paired.low[0]), ("high", paired.high[0])):
                    self.assertAlmostEqual(row[name], float(value), 12)
        rows = list(csv.DictReader(io.StringIO(self.by_parameters(a, b, "--csv"))))
        self.assertEqual([float(row["low"]) for row in rows], [row["low"] for row in found["cg_ratio"]])

    def test_pending_tasks_are_left_out(self):
        def clear(h5):
            h5["tasks/state"][1] = 0
        part = changed("part.h5", clear)
        self.assertEqual(self.counts(self.found(sweep(), part))[3:], (3, 0))
        self.assertRegex(self.compare(sweep(), part), r"results: 3 .*1 more .*3 .*, 0 differ\n")

    def test_a_rerun_is_compared_with_its_sweep_and_a_data_set_with_a_larger_one(self):
        self.said("rerun", sweep(), 2, "-o", "one.h5")
        both, only_a, *_, differing = self.counts(self.found(sweep(), "one.h5"))
        self.assertEqual((both, only_a, differing), (1, 3, 0))
        found = self.found(sweep("data", **DATA), sweep("more", **DATA, samples=3))
        self.assertEqual((found["tasks"]["both"], found["tasks"]["only_b"], found["cg_ratio"]), (4, 2, []))

    def test_other_machines_are_told_beside_the_times(self):
        def move(h5):
            h5["runs/host"][0] = b"elsewhere"
        self.assertRegex(self.compare(sweep(), changed("elsewhere.h5", move)), r"times, .*: \S+ and elsewhere\n")

    def test_files_that_share_no_task_are_refused(self):
        said = rodsweep("compare", sweep(), sweep("seeded", seed=9))
        self.assertEqual(said.returncode, USER_ERROR)
        self.assertIn("--by parameters", said.stderr)
        self.assertIn("seed: 3 in A, 9 in B", said.stdout)
        self.compare(sweep(), sweep(), "--by", "name", code=USER_ERROR)


if __name__ == "__main__":
    unittest.main()
