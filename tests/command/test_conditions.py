"""`rodsweep query` reads conditions as tests/conditions.json says; RODSWEEP names the program."""

import os
import sys
import unittest

from program import ALL_DONE, USER_ERROR, rodsweep

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "analysis"))
import language  # noqa: E402


class Conditions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.path = language.planted("planted.h5")

    def test_tasks_are_selected_as_the_table_says(self):
        for text, tasks in language.CASES["met"].items():
            with self.subTest(text):
                done = rodsweep("query", self.path, "--where", text, "--columns", "task", "--csv")
                self.assertEqual(done.returncode, ALL_DONE, done.stderr)
                self.assertEqual([int(line) for line in done.stdout.split()[1:]], tasks)

    def test_what_cannot_be_asked_is_refused_with_the_words_of_the_table(self):
        for text, words in language.CASES["refused"].items():
            with self.subTest(text):
                done = rodsweep("query", self.path, "--where", text, "--columns", "task", "--csv")
                self.assertEqual(done.returncode, USER_ERROR, done.stdout)
                self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
