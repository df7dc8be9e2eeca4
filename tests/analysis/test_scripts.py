"""spatial.py, front.py and summary.py as a user runs them: files made, numbers printed, plain errors with exit code 2."""

import csv
import io
import json
import os
import subprocess
import unittest

import synthetic
import front
import h5py
import numpy as np
from running import Scripts


class Front(Scripts):
    def test_costs_and_ratios_are_those_planted_and_what_is_beaten_in_both_is_off_the_line(self):
        self.write(scenes=("helix",), guesses=("zero", "previous", "quadratic"))
        printed = self.run_script("front.py", "sweep.h5", "--tolerance", "1e-2", files=True).stdout
        rows = {line.split()[0]: line.split()[1:] for line in printed.splitlines() if line.startswith("  ")}
        self.assertAlmostEqual(float(rows["previous"][1]), 0.5, delta=0.01)
        self.assertAlmostEqual(float(rows["CG"][2]), 1, delta=0.05)
        self.assertEqual(printed.split()[-2:], ["figures/sweep-front.pdf", "figures/sweep-front.png"])
        np.testing.assert_array_equal(front.unbeaten(np.array([3, 1, 2, 4.]), np.array([.2, .5, .6, .3])), [1, 0])

    def test_a_file_without_times_is_refused(self):
        self.write(solves=False)
        self.refused("front.py", "sweep.h5", words="has no times")


class Spatial(Scripts):
    def test_figures_go_beside_the_file_as_pdf_and_png_and_their_paths_are_printed(self):
        self.write(scenes=("helix",), guesses=("zero", "previous"))
        printed = self.run_script("spatial.py", "sweep.h5", files=True).stdout.split()
        self.assertEqual(printed, [f"figures/sweep-{name}.{ending}" for name in ("cg-ratio", "speedup", "time")
                                   for ending in ("pdf", "png")])

    def test_an_overview_is_the_only_figure(self):
        self.write(scenes=("helix",), guesses=("zero", "previous"))
        printed = self.run_script("spatial.py", "sweep.h5", "--overview", "--format", "png", files=True).stdout
        self.assertEqual(printed, "figures/sweep-overview.png\n")

    def test_the_same_figure_twice_is_the_same_file(self):
        self.write(scenes=("helix",), samples=2, solves=False)
        contents = []
        for folder in ("a", "b"):
            self.run_script("spatial.py", "sweep.h5", "--tolerance", "1e-2", "-o", folder, files=True)
            with open(os.path.join(self.folder, folder, "sweep-cg-ratio.pdf"), "rb") as figure:
                contents.append(figure.read())
        self.assertEqual(*contents)

    def test_choices_are_part_of_the_name(self):
        self.write(samples=2, solves=False)
        done = self.run_script("spatial.py", "sweep.h5", "--scene", "helix", "--newton", "all", "--width", "84",
                               "-o", "out", "--x", "scene.youngs_modulus_pa", "--select", "scene.segments=10")
        self.assertEqual(done.stdout.split()[0],
                         "out/sweep-helix-cg-ratio-by-youngs_modulus_pa-all-newton-84mm.pdf")
        self.assertIn("CG ratios only", done.stderr)

    def test_mistakes_are_one_line_and_exit_code_2(self):
        self.refused("spatial.py", "none.h5", words="none.h5: there is no such file")
        with open(os.path.join(self.folder, "notes.txt"), "w") as notes:
            notes.write("hello")
        self.refused("spatial.py", "notes.txt", words="not an HDF5 file")
        self.write()
        self.refused("spatial.py", "sweep.h5", "--x", "segmnts", words="did you mean scene.segments?")
        self.refused("spatial.py", "sweep.h5", "--scene", "helx", words="did you mean helix?")
        self.refused("spatial.py", "sweep.h5", "--tolerance", "0.5", words="tolerance '0.5' is not in the file")
        self.refused("spatial.py", "sweep.h5", "--guess", "zero", words="only the zero guess is left")
        self.write(guesses=("previous", "quadratic"))
        self.refused("spatial.py", "sweep.h5", words="no zero guess")
        self.write(method="direct")
        self.refused("spatial.py", "sweep.h5", words="no guesses to compare")
        self.write(pending=range(24))
        self.refused("spatial.py", "sweep.h5",
                     words="no simulation to show yet: 0 of 24 tasks ok, none failed, 24 pending")

    def test_help_shows_examples(self):
        command = [os.path.join(synthetic.ANALYSIS, "spatial.py"), "--help"]
        said = subprocess.run(command, capture_output=True, text=True, check=True, cwd=self.folder).stdout
        for words in ("--tolerance", "--x", "--scene", "-o", "analysis/spatial.py results/demo.h5"):
            self.assertIn(words, said)


class Summary(Scripts):
    def test_the_table_has_the_planted_numbers(self):
        self.write(scenes=("helix",), failed={3: "diverged"}, pending=(4,))
        said = self.run_script("summary.py", "sweep.h5").stdout
        for words in ("10 of 12 tasks ok, failed: 1 diverged, 1 pending", "task 3: diverged: planted",
                      "paired evaluation; preconditioner jacobi; residual test: ‖b − Ax‖₂", "Helix, n = 10",
                      "first Newton iteration (j = 0)", "Solved to tolerance 1e-2"):
            self.assertIn(words, said)
        rows = {line.split()[0]: line.split() for line in said.splitlines() if line.startswith("  previous")}
        self.assertIn("2.00", rows["previous"])

    def test_columns_are_aligned(self):
        self.write(scenes=("helix",))
        table = self.run_script("summary.py", "sweep.h5").stdout.split("\n\n")[2].splitlines()
        beside = next(k for k, line in enumerate(table) if line.startswith("  the same"))
        for part in (table[:beside], table[beside:]):
            self.assertEqual(len({len(line) for line in part}), 1, part)

    def test_beside_the_ratio_stand_products_and_all_newton_iterations(self):
        self.write(scenes=("helix",))
        with h5py.File("sweep.h5", "a") as h5:
            for which in ("", "_all"):
                spent = h5[f"tasks/iterations_sum{which}"][:]
                spent[:, 2] += spent[:, 0]      # quadratic's own products are as many as CG from zero takes
                h5[f"tasks/matvecs_sum{which}"] = spent
        lines = self.run_script("summary.py", "sweep.h5").stdout.splitlines()
        begin = next(k for k, line in enumerate(lines) if line.startswith("  the same"))
        self.assertEqual(lines[begin].split()[3:9], ["1e-1", "products", "1e-1", "all", "j", "1e-1"])
        quadratic = lines[begin + 2].split()
        self.assertEqual(quadratic[:2], ["quadratic", "1.25"])
        self.assertEqual([float(value) for value in quadratic[2:4]], [0.68, 1.68])   # (1 + 2 * .9) / 3 of all, and 1 more

    def test_csv_and_json_hold_the_same_numbers(self):
        self.write(failed={3: "diverged"}, samples=5)
        rows = list(csv.DictReader(io.StringIO(self.run_script("summary.py", "sweep.h5", "--csv").stdout)))
        whole = json.loads(self.run_script("summary.py", "sweep.h5", "--json").stdout)
        counts = {row["quantity"]: float(row["value"]) for row in rows if row["quantity"].startswith("tasks")}
        self.assertEqual(counts, {"tasks": 30, "tasks_ok": 29, "tasks_pending": 0, "tasks_diverged": 1,
                                  "tasks_timed_oversubscribed": 0})
        self.assertEqual(whole["tasks"], {"total": 30, "ok": 29, "pending": 0, "failed": {"diverged": 1}})
        numbers = [row for row in rows if not row["quantity"].startswith("tasks")]
        self.assertEqual([row["quantity"] for row in numbers], [n["quantity"] for n in whole["numbers"]])
        for row, number in zip(numbers, whole["numbers"]):
            self.assertEqual(float(row["value"] or "nan"), number["value"])
        found = {(n["scene"], n["quantity"], n["guess"], n["tolerance"]): n for n in whole["numbers"]}
        ratio = found["helix", "cg_ratio", "quadratic", 0.001]
        self.assertAlmostEqual(ratio["value"], 0.25, delta=0.003)
        self.assertLessEqual(ratio["low"], ratio["value"])
        self.assertEqual(ratio["simulations"], 15)
        self.assertAlmostEqual(found["helix", "speedup_over_direct_cg", "oracle(0.1)", None]["value"], 8 / 2, places=4)
        self.assertAlmostEqual(found["helix", "length_drift_largest", None, None]["value"], 1e-3)

    def test_a_block_for_every_value_of_a_key(self):
        self.write(scenes=("helix",))
        said = self.run_script("summary.py", "sweep.h5", "--by", "scene.segments").stdout
        for segments in (10, 20, 40):
            self.assertIn(f"Helix, scene.segments = {segments}, n = 4", said)

    def test_unreached_tolerances_are_marked_and_counted(self):
        plant = synthetic.Plant()
        plant.reached = lambda guess, tolerance, newton, segments, draw: guess != "previous" or tolerance > 1e-3
        self.write(scenes=("helix",), plant=plant, steps=2, samples=5)
        said = self.run_script("summary.py", "sweep.h5").stdout
        self.assertIn("0.50]*", said)
        self.assertIn("at 1e-3: previous 30", said)
        self.assertNotIn("at 1e-2", said)

    def test_oversubscribed_times_are_warned_of(self):
        self.write(scenes=("helix",), oversubscribed=True)
        self.assertIn("WARNING: Not valid as timings", self.run_script("summary.py", "sweep.h5").stdout)

    def test_a_reader_that_closes_its_end_of_a_pipe_is_no_error(self):
        self.write(scenes=("helix",), solves=False)
        summary_py = os.path.join(synthetic.ANALYSIS, "summary.py")
        done = subprocess.run(["bash", "-c", f"{summary_py} sweep.h5 --csv | true; echo ${{PIPESTATUS[0]}}"], text=True,
                              capture_output=True, check=True, cwd=self.folder)
        self.assertEqual((done.stdout, done.stderr), ("0\n", ""))

    def test_a_direct_only_file_has_its_steps(self):
        self.write(method="direct")
        said = self.run_script("summary.py", "sweep.h5").stdout
        self.assertIn("advanced by the direct solve, no guesses", said)
        self.assertIn("length drift", said)
        self.assertNotIn("CG ratio", said)

    def test_a_sweep_that_has_just_begun(self):
        self.write(pending=range(24))
        self.assertIn("No simulation is complete yet.", self.run_script("summary.py", "sweep.h5").stdout)
        self.run_script("summary.py", "sweep.h5", "--csv")
        self.run_script("summary.py", "sweep.h5", "--json")

    def test_a_closed_loop_has_the_drift_of_every_guess(self):
        self.write(scenes=("helix",), closed_loop=True)
        said = self.run_script("summary.py", "sweep.h5").stdout
        self.assertIn("closed-loop evaluation", said)
        self.assertIn("Helix, quadratic", said)

    def test_mistakes_are_one_line_and_exit_code_2(self):
        self.refused("summary.py", "none.h5", words="there is no such file")
        self.write()
        self.refused("summary.py", "sweep.h5", "--by", "scene.length", words="did you mean scene.length_m?")
        self.refused("summary.py", "sweep.h5", "--select", "scene.segments=7", words="known: 10, 20, 40")
        self.refused("summary.py", "sweep.h5", "--tolerance", "x", words="--tolerance x: write numbers")


if __name__ == "__main__":
    unittest.main()
