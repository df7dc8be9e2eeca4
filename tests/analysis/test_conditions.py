"""rodsweep query, --select, export.py --where and rodsweep.open() read the conditions of tests/conditions.json alike; the
table, order and errors of query.py. On a running sweep: tests/command."""

import json
import os

import synthetic
import numpy as np
from rodsweep.reading import conditions, tidy
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.task_columns import TaskColumns
from running import Folder, Scripts

with open(os.path.join(synthetic.ANALYSIS, "..", "tests", "conditions.json"), encoding="utf-8") as text:
    CASES = json.load(text)
PREVIOUS = "cg_ratio.previous"


class Conditions(Folder):
    def setUp(self):
        """Six tasks whose parameters include the columns of the table."""
        def plant(h5):
            for name, column in CASES["columns"].items():
                (kind, values), = column.items()
                dtype, absent = {"whole": (np.int64, -1), "real": (np.float64, np.nan), "text": ("S32", "")}[kind]
                item = h5.create_dataset(f"tasks/parameters/{name}",
                                         data=np.array([absent if v is None else v for v in values], dtype=dtype))
                item.attrs.update({"unit": "", "meaning": f"the {name}", "swept": False})

        super().setUp()
        self.open(scenes=("helix",), samples=2, steps=1, newton=1)
        self.changed(plant)
        self.table = tidy.Tidy(self.file, "steps", np.arange(6), [], [])

    def test_tasks_and_rows_are_selected_as_the_table_says(self):
        for text, tasks in CASES["met"].items():
            with self.subTest(text):
                self.assertEqual(np.flatnonzero(TaskColumns(self.file).select([text])).tolist(), tasks)
                blocks = self.table.blocks(["task"], [self.table.condition(text)])
                self.assertEqual([task for block in blocks for task in block["task"].array()], tasks)

    def test_what_cannot_be_asked_is_refused_with_the_words_of_the_table(self):
        for text, words in CASES["refused"].items():
            for reader in (TaskColumns(self.file), self.table):
                with self.subTest(text), self.assertRaises(KeyNotFound) as refused:
                    reader.condition(text)
                self.assertIn(words, str(refused.exception))

    def test_every_column_of_the_tasks_chooses_rows_too(self):
        table = TaskColumns(self.file)
        for text in ("state=done", "segments=10", "sample=1", "iterations_sum.previous@1e-3>0"):
            tasks = np.flatnonzero(table.select([text])).tolist()
            for level in ("tasks", "solves", "steps"):
                with self.subTest(text, level=level):
                    rows = tidy.Tidy(self.file, level, np.arange(6), range(4), range(8))
                    blocks = rows.blocks(["task"], [rows.condition(text)])
                    self.assertEqual(sorted({task for block in blocks for task in block["task"].array()}), tasks)

    def test_a_result_that_no_task_has_is_an_answer(self):
        for text in ("outcome=diverged", "state=pending", "iterations_sum.previous<0"):
            table = TaskColumns(self.file)
            self.assertFalse(table.met(table.condition(text)).any())
            self.assertEqual(list(self.table.blocks(["task"], [self.table.condition(text)])), [])
            with self.assertRaisesRegex(KeyNotFound, f"no task meets {text}"):
                table.select([text])

    def test_a_word_that_a_column_never_holds_is_refused_with_the_nearest(self):
        columns = {"guess": conditions.Column(False, ("zero", "a, b", "quadratic"))}
        self.assertEqual(conditions.parse("guess=a, b", columns).texts, ("a, b",))
        with self.assertRaisesRegex(KeyNotFound, "'quadratc' is not in the file; did you mean quadratic?"):
            conditions.parse("guess=zero,quadratc", columns)

    def test_a_vector_is_its_text_or_one_of_its_components(self):
        def plant(h5):
            item = h5.create_dataset("tasks/parameters/scene.gravity_m_s2", data=[[0, -9.81, 0]] * 5 + [[0, 0, 0]])
            item.attrs.update({"unit": "m/s^2", "meaning": "gravity", "swept": True})
        file = self.changed(plant)
        for text, count in (("scene.gravity_m_s2.y<0", 5), ("scene.gravity_m_s2.y=-9.81", 5),
                            ("scene.gravity_m_s2=(0, -9.81, 0)", 5), ("scene.gravity_m_s2=(0, 0, 0)", 1)):
            self.assertEqual(TaskColumns(file).select([text]).sum(), count, text)


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
