"""export.py: rows, sums, choices and empty fields against the planted file; compressed output; plain refusals."""

import csv
import gzip
import io
import os
import unittest
import unittest.mock

import synthetic
import numpy as np
import pandas
from rodsweep.reading.tidy import Column
from rodsweep.writing import tables
from running import Scripts


class Export(Scripts):
    def rows(self, *arguments):
        name = os.path.join(self.folder, "out.csv")
        self.run_script("export.py", "sweep.h5", *arguments, "-o", name, "--force")
        with open(name, encoding="utf-8", newline="") as text:
            return list(csv.DictReader(text))

    def test_a_row_per_task_guess_and_tolerance_with_the_sums_of_the_file(self):
        self.write(failed={3: "diverged"}, pending=(4,), counts_in_rows=True)
        rows = self.rows()
        self.assertEqual(len(rows), 23 * 4 * 8)
        with synthetic.h5py.File(self.path) as h5:
            done = h5["tasks/state"][:] == 1
            self.assertEqual(sum(int(row["iterations_sum"]) for row in rows), h5["tasks/iterations_sum"][:][done].sum())
        self.assertEqual({row["outcome"] for row in rows if row["task"] == "3"}, {"diverged"})
        self.assertNotIn("4", {row["task"] for row in rows})
        one, = [row for row in rows if row["task"] == "8" and row["guess"] == "previous" and row["tolerance"] == "0.01"]
        self.assertEqual((one["iterations_sum"], one["scene.segments"], one["scene.type"], one["sample"]),
                         (str(2 * 404), "40", "bending_rod", "0"))
        self.assertNotIn("solve.norm", one)    # the same for every task

    def test_a_row_per_solve_and_guess_with_empty_fields_for_what_was_not_reached(self):
        plant = synthetic.Plant()
        plant.reached = lambda guess, tolerance, newton, segments, draw: guess != "previous" or tolerance > 1e-3
        self.write(plant=plant, scenes=("helix",), counts_in_rows=True)
        rows = self.rows("--level", "solves", "--tolerance", "1e-2,1e-4")
        self.assertEqual(len(rows), 12 * 2 * 3 * 4)
        self.assertEqual([name for name in rows[0] if name.startswith("iterations")], ["iterations_1e-2",
                                                                                       "iterations_1e-4"])
        for row in rows:
            self.assertEqual(row["iterations_1e-4"] == "", row["guess"] == "previous")
        zero = [int(row["iterations_1e-2"]) for row in rows if row["guess"] == "zero" and row["scene.segments"] == "10"]
        self.assertEqual(set(zero), {202})
        self.assertAlmostEqual(float(rows[0]["direct_s"]), 8e-6)

    def test_in_a_closed_loop_a_row_belongs_to_its_own_guess(self):
        self.write(scenes=("helix",), closed_loop=True)
        rows = self.rows("--columns", "task,guess,iterations_sum", "--tolerance", "1e-2")
        self.assertEqual([row["guess"] for row in rows[:48]], ["zero"] * 12 + ["previous"] * 12 + ["quadratic"] * 12 +
                         ["oracle(0.1)"] * 12)
        self.assertEqual(len(rows), 48)

    def test_a_row_per_step_with_components(self):
        self.write(scenes=("helix",), pending=(0,))
        rows = self.rows("--level", "steps")
        self.assertEqual(len(rows), 11 * 2)
        self.assertEqual([rows[0][f"momentum_kg_m_s_{k}"] for k in "xyz"], ["3.0", "0.0", "4.0"])
        self.assertAlmostEqual(min(float(row["length_drift"]) for row in rows), -1e-3)

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
        self.refused("export.py", "sweep.h5", "--where", "guess=quadratc", words="did you mean quadratic?")

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

    def test_direct_simulations_have_rows_without_guesses(self):
        self.write(method="direct")
        self.assertEqual(len(self.rows()), 24)
        self.assertEqual(len(self.rows("--level", "steps")), 48)

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

    def test_nothing_is_overwritten_and_mistakes_are_one_line(self):
        self.write(scenes=("helix",))
        self.run_script("export.py", "sweep.h5", "-o", "out.csv")
        self.refused("export.py", "sweep.h5", "-o", "out.csv", words="out.csv is there already; give another name")
        self.refused("export.py", "sweep.h5", "-o", "sweep.h5", "--force", words="sweep.h5 is there already")
        self.refused("export.py", "sweep.h5", "--columns", "iterationssum", words="did you mean iterations_sum?")
        self.refused("export.py", "sweep.h5", "--where", "newton=0", words="did you mean time.newton_iterations?\n")
        self.refused("export.py", "sweep.h5", "--columns", "nope", words=" more (export.py --list and results.columns()")
        self.refused("export.py", "sweep.h5", "--columns", "task,task", words="a column is named twice")
        self.refused("export.py", "sweep.h5", "--where", "newton", words="write COLUMN=VALUE")
        self.refused("export.py", "sweep.h5", "--where", "sample=x", "-o", "x.csv", words='numbers, and "x" is none')
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("x.csv")], [])
        self.refused("export.py", "sweep.h5", "--columns", "task", "-o", "none/out.csv", words="No such file")
        self.assertIn("iterations_sum\n", self.run_script("export.py", "sweep.h5", "--list").stdout)


if __name__ == "__main__":
    unittest.main()
