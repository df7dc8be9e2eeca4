"""--select, export.py --where and rodsweep.open() read conditions on tasks and rows as in tests/conditions.json."""

import json
import os
import unittest

import synthetic
import numpy as np
from rodsweep.reading import conditions, tidy
from rodsweep.reading.errors import KeyNotFound
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
                if tasks:
                    self.assertEqual(np.flatnonzero(self.file.select([text])).tolist(), tasks)
                else:
                    with self.assertRaisesRegex(KeyNotFound, "no task meets"):
                        self.file.select([text])

    def test_rows_are_selected_as_the_table_says(self):
        for text, tasks in CASES["met"].items():
            with self.subTest(text):
                blocks = self.table.blocks(["task"], [self.table.condition(text)])
                self.assertEqual([task for block in blocks for task in block["task"].array()], tasks)

    def test_what_cannot_be_asked_is_refused_with_the_words_of_the_table(self):
        for text, words in CASES["refused"].items():
            for reader in (lambda: self.file.select([text]), lambda: self.table.condition(text)):
                with self.subTest(text), self.assertRaises(KeyNotFound) as refused:
                    reader()
                self.assertIn(words, str(refused.exception))

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
            self.assertEqual(file.select([text]).sum(), count, text)


if __name__ == "__main__":
    unittest.main()
