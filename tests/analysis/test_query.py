"""query.py: tasks and columns, their format and order; errors. On a running sweep: tests/command."""

import json
import unittest

import synthetic
import numpy as np
from running import Scripts

PREVIOUS = "cg_ratio.previous"


class Query(Scripts):
    def plant(self, **settings):
        self.write(**{"scenes": ("helix",), "grid": {"scene.segments": [10, 20]}, "samples": 2, **settings})
        with synthetic.h5py.File(self.path, "r+") as h5:
            sums = h5["tasks/iterations_sum"][:]
            h5["tasks/cg_ratio"] = sums / np.maximum(1, sums[:, :1])
            h5["tasks/cg_ratio"].attrs.update({"unit": "1", "meaning": "iterations over those of the zero guess"})

    def query(self, *words):
        return self.run_script("query.py", "sweep.h5", *words)

    def rows(self, *words):
        return json.loads(self.query(*words, "--json").stdout)

    def test_the_table_shows_what_is_swept_the_outcome_and_the_ratios(self):
        self.plant()
        said = self.query()
        head, *rows = said.stdout.splitlines()
        self.assertEqual(head.split(), ["task", "scene.segments", "scene.youngs_modulus_pa", "outcome",
                                        *(f"cg_ratio.{guess}" for guess in synthetic.GUESSES[1:])])
        self.assertEqual(len(rows), 4)
        self.assertIn("4 of 4 tasks", said.stderr)
        self.assertAlmostEqual(self.rows()[0][PREVIOUS], 0.5, delta=0.01)

    def test_rows_are_chosen_sorted_and_limited(self):
        self.plant()
        words = ("scene.segments>=20", "--where", "task<3", "--columns", "task", "--csv")
        self.assertEqual(self.query(*words).stdout, "task\n2\n")
        self.assertEqual(self.rows("outcome=diverged"), [])    # no match is not an error
        rows = self.rows("--sort", "scene.youngs_modulus_pa", "--descending", "--limit", "3")
        self.assertEqual([row["task"] for row in rows], [1, 3, 0])
        self.assertEqual(list(self.rows("--columns", f"task,{PREVIOUS}@1e-3")[0]), ["task", f"{PREVIOUS}@1e-3"])

    def test_pending_tasks_show_no_results(self):
        self.plant(pending=(1, 2, 3))
        rows = self.rows()
        self.assertEqual([row["outcome"] for row in rows], ["ok", "pending", "pending", "pending"])
        self.assertEqual([row[PREVIOUS] is None for row in rows], [False, True, True, True])
        self.assertIn("1 of 4 tasks", self.query("state=done").stderr)

    def test_closed_loops_show_whose_guess_advances_the_rods_and_jobs_without_guesses_their_tasks(self):
        self.plant(closed_loop=True)
        rows = self.rows("own_guess=quadratic")
        self.assertEqual([row["task"] for row in rows], [2, 6, 10, 14])
        self.assertEqual(rows[0]["steps_done"], 2)
        self.write(scenes=("helix",), method="direct")
        self.assertEqual(len(self.rows()), 12)

    def test_all_columns_are_listed_with_meaning_and_unit(self):
        self.plant()
        said = self.query("--columns", "help").stdout
        self.assertRegex(said, r"scene\.youngs_modulus_pa .*\[Pa\]\n")
        self.assertRegex(said, r"(?s)cg_ratio\.GUESS\[@TOLERANCE\].*zero, previous, quadratic.* 1e-2\n")

    def test_data_of_a_user_are_named_on_a_line_of_standard_error(self):
        self.plant()
        with synthetic.h5py.File(self.path, "r+") as h5:
            h5["tasks/mine"] = np.arange(9)
        said = self.query("--csv")
        self.assertEqual(said.stderr, "query.py: sweep.h5: ignored /tasks/mine: not a row per task, solve or step\n")
        self.assertNotIn("mine", said.stdout)

    def test_mistakes_are_one_line_and_exit_code_2(self):
        self.plant()
        for words, *arguments in (("did you mean scene.segments?", "scene.segmant=3"),
                                  ("did you mean outcome?", "--columns", "task,outcom"),
                                  ("segmants", "--sort", "segmants")):
            self.refused("query.py", "sweep.h5", *arguments, words=words)


if __name__ == "__main__":
    unittest.main()
