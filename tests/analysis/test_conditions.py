"""rodsweep query, --select, export.py --where and rodsweep.open() read the conditions of tests/conditions.json alike."""

import json
import os
import unittest

import synthetic
import numpy as np
from rodsweep.reading import conditions, tidy
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.task_columns import TaskColumns
from running import Folder

with open(os.path.join(synthetic.ANALYSIS, "..", "tests", "conditions.json"), encoding="utf-8") as text:
    CASES = json.load(text)


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

    def test_tasks_are_selected_as_the_table_says(self):
        for text, tasks in CASES["met"].items():
            with self.subTest(text):
                self.assertEqual(np.flatnonzero(TaskColumns(self.file).select([text])).tolist(), tasks)

    def test_rows_are_selected_as_the_table_says(self):
        for text, tasks in CASES["met"].items():
            with self.subTest(text):
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


if __name__ == "__main__":
    unittest.main()
