"""export.py: rows as in rodsweep.open() (their numbers: test_results.py); options, compressed output, refusals."""

import csv
import gzip
import io
import os
import unittest
import unittest.mock

import synthetic
import numpy as np
import pandas
import rodsweep
from rodsweep.reading.tidy import Column
from rodsweep.writing import tables
from running import Scripts


class Export(Scripts):
    def rows(self, *arguments):
        name = os.path.join(self.folder, "out.csv")
        self.run_script("export.py", "sweep.h5", *arguments, "-o", name, "--force")
        with open(name, encoding="utf-8", newline="") as text:
            return list(csv.DictReader(text))

    def test_every_level_has_the_rows_that_rodsweep_open_hands_out(self):
        def text(said):
            return pandas.read_csv(io.StringIO(said))

        plant = synthetic.Plant()
        plant.reached = lambda guess, tolerance, newton, segments, draw: guess != "previous" or tolerance > 1e-3
        incomplete = {"failed": {3: "diverged"}, "pending": (4,), "counts_in_rows": True, "plant": plant}
        for settings, levels in ((incomplete, 3), ({"closed_loop": True, "scenes": ("helix",)}, 3),
                                 ({"method": "direct"}, 2)):
            self.write(**settings)
            with rodsweep.open("sweep.h5") as results:
                for level in ("tasks", "steps", "solves")[:levels]:
                    with self.subTest(level=level, **settings):
                        rows = self.run_script("export.py", "sweep.h5", "--level", level).stdout
                        frame = getattr(results, level)().to_csv(index=False)
                        pandas.testing.assert_frame_equal(text(rows), text(frame), check_dtype=False)
                        self.assertNotIn(",-1,", rows)

    def test_conditions_are_on_any_column_and_columns_come_in_the_given_order(self):
        self.write(scenes=("helix",), counts_in_rows=True)
        rows = self.rows("--level", "solves", "--columns", "guess,task", "--where", "newton=0", "--where",
                         "guess=quadratic,previous", "--where", "scene.segments=15:40")
        self.assertEqual(list(rows[0]), ["guess", "task"])
        self.assertEqual(len(rows), 8 * 2 * 2)
        self.assertEqual({row["guess"] for row in rows}, {"previous", "quadratic"})
        self.assertEqual(self.rows("--where", "outcome=diverged"), [])
        tolerances = self.rows("--where", "tolerance<=1e-3", "--where", "guess!=zero", "--where", "iterations_sum>=100")
        self.assertEqual({row["tolerance"] for row in tolerances},
                         {"0.001", "0.0001", "1e-05", "1e-06", "1e-07", "1e-08"})
        self.assertGreaterEqual(min(int(row["iterations_sum"]) for row in tolerances), 100)
        solves = self.rows("--level", "solves", "--tolerance", "1e-2,1e-4")
        self.assertEqual([name for name in solves[0] if name.startswith("iterations")],
                         ["iterations_1e-2", "iterations_1e-4"])

    def test_rows_of_a_step_that_newton_left_early_are_left_out(self):
        self.write(scenes=("helix",))
        with synthetic.h5py.File(self.path, "r+") as h5:
            h5["solves/newton"][2] = -1
        self.assertEqual(len(self.rows("--level", "solves", "--guess", "zero")), 12 * 6 - 1)

    def test_numbers_come_back_as_they_are_in_the_file(self):
        self.write(scenes=("helix",))
        values = np.random.Generator(np.random.PCG64(2)).normal(size=24)
        with synthetic.h5py.File(self.path, "r+") as h5:
            h5["steps/joint_gap"][:] = values
            h5["steps/joint_gap"][3] = np.nan
        found = [row["joint_gap"] for row in self.rows("--level", "steps")]
        self.assertEqual(found[3], "")
        self.assertEqual([float(text) for text in found[:3] + found[4:]], [*values[:3], *values[4:]])

    def test_a_name_that_ends_in_gz_is_compressed_and_standard_output_has_the_same(self):
        self.write(scenes=("helix",))
        said = self.run_script("export.py", "sweep.h5", "-o", "out.csv.gz").stdout
        self.assertEqual(said, f"{12 * 4 * 8} rows: out.csv.gz\n")
        with gzip.open(os.path.join(self.folder, "out.csv.gz"), "rt", encoding="utf-8", newline="") as text:
            compressed = text.read()
        self.assertEqual(len(list(csv.DictReader(io.StringIO(compressed)))), 12 * 4 * 8)
        self.assertEqual(self.run_script("export.py", "sweep.h5").stdout, compressed)

    def test_a_file_without_rows_or_columns_that_later_versions_have_is_read(self):
        self.write(scenes=("helix",), solves=False)
        with synthetic.h5py.File(self.path, "r+") as h5:
            h5["tasks/matvecs_sum"] = h5["tasks/iterations_sum"][:] * 2
        self.assertEqual({float(row["matvecs_sum"]) / float(row["iterations_sum"]) for row in self.rows()}, {2.0})
        self.refused("export.py", "sweep.h5", "--level", "solves", words="no rows of solves")

    def test_texts_are_quoted_and_missing_whole_numbers_are_empty(self):
        out = io.BytesIO()
        columns = {"a,b": np.array(['say "hi", you', "two\nlines", ""]), "near": np.array([3, -1, 0], dtype=np.int16),
                   "far": np.array([2 ** 62, 0, -1]), "single": np.array([0.1, np.nan, 1e-30], dtype=np.float32)}
        tables.write_csv(out, list(columns), [{name: Column(values) for name, values in columns.items()}])
        self.assertEqual(list(csv.reader(io.StringIO(out.getvalue().decode(), newline=""))),
                         [list(columns), ['say "hi", you', "3", str(2 ** 62), "0.1"], ["two\nlines", "", "0", ""],
                          ["", "0", "", "1e-30"]])

    def test_parquet_holds_the_rows_of_the_csv_and_needs_pyarrow(self):
        self.write(scenes=("helix",), failed={3: "diverged"})
        with unittest.mock.patch.object(pandas.DataFrame, "to_parquet", side_effect=ImportError):
            self.refused("export.py", "sweep.h5", "-o", "out.parquet", words="pip install pyarrow")
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("out")], [])
        for level in ("tasks", "solves", "steps"):
            with unittest.mock.patch.object(pandas.DataFrame, "to_parquet", autospec=True) as written:
                self.run_script("export.py", "sweep.h5", "--level", level, "-o", "out.parquet", "--force")
            frame = written.call_args.args[0]
            read = pandas.read_csv(io.StringIO(self.run_script("export.py", "sweep.h5", "--level", level).stdout))
            pandas.testing.assert_frame_equal(frame.astype(read.dtypes), read)

    def test_a_terminal_shows_the_first_rows_and_how_many_there_are(self):
        self.write(scenes=("helix",), samples=1)
        whole = self.run_script("export.py", "sweep.h5")
        self.assertEqual(whole.stderr, "")
        with unittest.mock.patch("export.at_terminal", return_value=True):
            for level, rows in (("tasks", 96), ("steps", 6)):
                shown = self.run_script("export.py", "sweep.h5", "--level", level)
                self.assertEqual(len(shown.stdout.splitlines()), 1 + min(rows, 20))
                self.assertEqual(shown.stderr, "the first 20 of 96 rows; -o FILE writes all\n" if rows > 20 else "")
                if level == "tasks":
                    self.assertEqual(shown.stdout.splitlines(), whole.stdout.splitlines()[:21])

    def test_nothing_is_overwritten_and_mistakes_are_one_line(self):
        self.write(scenes=("helix",))
        self.run_script("export.py", "sweep.h5", "-o", "out.csv")
        for words, *arguments in (("out.csv already exists", "-o", "out.csv"),
                                  ("sweep.h5 already exists", "-o", "sweep.h5", "--force"),
                                  ("did you mean iterations_sum?", "--columns", "iterationssum"),
                                  ("did you mean quadratic?", "--where", "guess=quadratc"),
                                  ("did you mean time.newton_iterations?\n", "--where", "newton=0"),
                                  (" more (export.py --list and results.columns()", "--columns", "nope"),
                                  ("named twice", "--columns", "task,task"),
                                  ("COLUMN=VALUE", "--where", "newton"), ('"x"', "--where", "sample=x", "-o", "x.csv"),
                                  ("No such file", "--columns", "task", "-o", "none/out.csv")):
            self.refused("export.py", "sweep.h5", *arguments, words=words)
        self.assertEqual(sorted(os.listdir(self.folder)), ["out.csv", "sweep.h5"])
        self.assertIn("iterations_sum\n", self.run_script("export.py", "sweep.h5", "--list").stdout)


if __name__ == "__main__":
    unittest.main()
