"""analysis/results/check.py: numbers in a text against its tables, and those of this repository."""

import os
import subprocess
import sys
import tempfile
import unittest

RESULTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "analysis", "results")
TABLE = """results/x.h5: job x

CG ratio, first Newton iteration

Bending rod, n = 300                 1e-1               1e-2
  previous              0.25 [0.23, 0.27]  0.46 [0.44, 0.48]
  pod 10                0.07 [0.06, 0.08]  0.10 [0.09, 0.11]

Helix, of a very long title
                                     1e-1               1e-2
  pod 10                0.19 [0.06, 0.08]  0.34 [0.09, 0.11]

Time per solve

Bending rod, n = 300  guess µs  solve µs
  pod 10                  2.00     1,234

                        n  failed
Bending rod, one a step
  pod 10               10       2
Bending rod, six a step
  pod 10               10       3
"""


class Texts(unittest.TestCase):
    def check(self, text):
        with tempfile.TemporaryDirectory() as folder:
            for name, content in (("x.txt", TABLE), ("README.md", text)):
                with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                    file.write(content)
            return self.run_on(os.path.join(folder, "README.md"))

    @staticmethod
    def run_on(*arguments):
        return subprocess.run([sys.executable, os.path.join(RESULTS, "check.py"), *arguments], text=True,
                              capture_output=True, check=False)

    def test_numbers_as_rounded_in_the_text(self):
        done = self.check("""`pod` leaves .1<!--= x; CG ratio; Bending rod; pod 10; 1e-2 --> and
**.34**<!--= x; CG ratio; Helix; pod 10; 1e-2 --> [.09<!--= x; *; Helix; pod 10; 1e-2; 2 -->, .11], 3<!--= x; *; Bending rod, six; pod 10; failed --> fail in
1234<!--= x; Time per solve; Bending rod; pod 10; solve µs --> µs, 1.2e3<!--= x; Time; Bending; pod 10; solve µs -->""")
        self.assertEqual((done.returncode, done.stdout), (0, "all numbers are those of their tables\n"))

    def test_what_parts_is_named_with_its_line(self):
        done = self.check("\n`pod` leaves .11<!--= x; CG ratio; Bending rod; pod 10; 1e-2 -->")
        self.assertEqual(done.returncode, 1)
        self.assertIn("README.md:2: .11, but 0.10 in x.txt", done.stdout)

    def test_update_puts_the_tables_numbers_in_with_as_many_digits_and_leaves_the_rest(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "README.md")
            with open(os.path.join(folder, "x.txt"), "w", encoding="utf-8") as file:
                file.write(TABLE)
            marks = [f"<!--= x; {where} -->" for where in (
                "CG ratio; Bending rod; pod 10; 1e-2", "CG ratio; Helix; pod 10; 1e-2",
                "Time; Bending; pod 10; solve µs", "Time; Bending; pod 10; solve µs", "Time; Bending; pod 10; guess µs")]
            text = "**.33**{} one .34{}, 1,111{} µs or 7e2{}; −.5{} and 12 alone"
            with open(path, "w", encoding="utf-8") as file:
                file.write(text.format(*marks))
            self.assertEqual(self.run_on("--update", path).returncode, 1)
            with open(path, encoding="utf-8") as file:
                self.assertEqual(file.read(), "**.10**{} one .34{}, 1,234{} µs or 1e3{}; 2.0{} and 12 alone".format(*marks))
            self.assertEqual(self.run_on(path).returncode, 0)

    def test_whole_tables_by_their_rows_and_columns(self):
        text = """<!--== x; CG ratio; {row}; {column}; 1e-1, 1e-2 -->
| 1e-1, 1e-2 | pod 10 | last<!--@ previous --> |
|---|---|---|
| rods<!--@ Bending rod --> | .07 **.10** [.09, .11] | .25 .46, `not 3` |
| Helix | .19 .34 | - |
"""
        done = self.check(text)
        self.assertEqual((done.returncode, done.stdout), (0, "all numbers are those of their tables\n"))
        done = self.check(text.replace("**.10**", "**.11**"))
        self.assertIn("README.md:4: .11, but 0.10 in x.txt: x; CG ratio; Bending rod; pod 10; 1e-2", done.stdout)
        done = self.check(text.replace(".19 .34", ".19"))
        self.assertIn("README.md:5: 1 numbers for 2 columns in '.19'", done.stdout)

    def test_a_bar_in_a_comment_of_a_table_is_escaped_as_github_wants_it(self):
        text = """| a | b |
|---|---|
| .10<!--= x; Steps \\|C\\|; Ring; pod 10; 1e-2 --> | |
"""
        self.assertIn("a section 'Steps |C|'", self.check(text).stdout)

    def test_what_no_table_has_is_named(self):
        for source, words in (("x; CG ratio; Bending rod; pod 9; 1e-2", "a row 'pod 9'"),
                              ("x; CG ratio; Bending rod; pod 10; 1e-3", "a column '1e-3'"),
                              ("x; CG ratio; Ring; pod 10; 1e-2", "a block 'Ring'"),
                              ("x; Steps; Ring; pod 10; 1e-2", "a section 'Steps'")):
            done = self.check(f"1<!--= {source} -->")
            self.assertEqual(done.returncode, 1)
            self.assertIn(words, done.stdout)

    def test_the_texts_of_this_repository(self):
        for text in ("README.md", "../../README.md", "../../docs/claims.md"):
            done = self.run_on(os.path.join(RESULTS, text))
            self.assertEqual((done.returncode, done.stdout), (0, "all numbers are those of their tables\n"))


if __name__ == "__main__":
    unittest.main()
