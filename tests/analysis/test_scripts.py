"""spatial.py, front.py and summary.py as run by a user: files, printed numbers, plain errors with exit code 2."""

import csv
import io
import json
import os
import subprocess

import synthetic
import front
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


class Spatial(Scripts):
    def test_figures_go_beside_the_file_as_pdf_and_png_and_their_paths_are_printed(self):
        self.write(scenes=("helix",), guesses=("zero", "previous"))
        printed = self.run_script("spatial.py", "sweep.h5", files=True).stdout.split()
        self.assertEqual(printed, [f"figures/sweep-{name}.{ending}" for name in ("cg-ratio", "speedup", "time")
                                   for ending in ("pdf", "png")])

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
        self.assertIn("CG ratios", done.stderr)


class Summary(Scripts):
    def summary(self, *arguments):
        return self.run_script("summary.py", "sweep.h5", *arguments).stdout

    def prose(self):
        """The summary without the ends of lines."""
        return " ".join(self.summary().split())

    def test_the_table_has_the_planted_numbers(self):
        self.write(scenes=("helix",), failed={3: "diverged"}, pending=(4,))
        said = self.summary()
        for words in ("10 of 12 tasks ok, failed: 1 diverged, 1 pending", "task 3: diverged: planted", "paired",
                      "jacobi", "‖b − Ax‖₂", "Helix, 10 simulations", "(j = 0)", "tolerance 1e-2"):
            self.assertIn(words, said)
        rows = {line.split()[0]: line.split() for line in said.splitlines() if line.startswith("  previous")}
        self.assertIn("2.00", rows["previous"])
        table = said.split("\n\n")[2].splitlines()    # the table with aligned columns
        beside = next(k for k, line in enumerate(table) if line.startswith("  the same"))
        for part in (table[:beside], table[beside:]):
            self.assertEqual(len({len(line) for line in part}), 1, part)

    def test_beside_the_ratio_stand_products_and_all_newton_iterations(self):
        self.write(scenes=("helix",))
        self.changed(synthetic.spend_on_quadratic)
        said = self.summary()
        self.assertLessEqual(max(len(line) for part in said.split("\n\n")[:2] for line in part.splitlines()), 120)
        lines = said.splitlines()
        begin = next(k for k, line in enumerate(lines) if line.startswith("  the same"))
        self.assertEqual(lines[begin].split()[3:9], ["1e-1", "products", "1e-1", "all", "j", "1e-1"])
        self.assertEqual(lines[begin + 2].split()[:4], ["quadratic", "1.25", "0.68", "1.68"])   # (1 + 2 * .9) / 3, plus 1

    def test_a_guess_has_no_times_in_simulations_where_a_solve_missed_the_tolerance(self):
        plant = synthetic.Plant(reached=lambda guess, tolerance, newton, segments, draw: (
            guess != "quadratic" or draw > 0 or tolerance > 1e-2))
        self.write(scenes=("helix",), plant=plant, samples=6)
        said = self.prose()
        for words in ("WARNING: 18 of 432 solves missed the tolerance (quadratic 18). A simulation has no times", "0.25]*",
                      "at 1e-2: quadratic 6"):
            self.assertIn(words, said)
        self.assertNotIn("at 1e-1", said)
        numbers = json.loads(self.summary("--json"))
        self.assertEqual(numbers["solves"], {"timed": 432, "missed": 18})
        of = {(n["quantity"], n["guess"]): n["simulations"] for n in numbers["numbers"]}
        for quantity in ("speedup_cg", "speedup_guess_cg", "speedup_step", "speedup_over_direct_cg", "cg_us"):
            self.assertEqual([of[quantity, guess] for guess in ("previous", "quadratic")], [18, 15], quantity)

    def test_where_cg_from_zero_missed_the_tolerance_there_is_no_speedup(self):
        self.write(scenes=("helix",), plant=synthetic.Plant(reached=synthetic.unless("zero", 1)))
        lines = self.summary().splitlines()
        begin = next(k for k, line in enumerate(lines) if line.startswith("Helix") and "solve µs" in line)
        self.assertEqual([line.split()[2:] for line in lines[begin + 1:begin + 3]],
                         [["-", "-", "-", "-"], ["10.0", "-", "-", "-"]])

    def test_tasks_whose_steps_end_far_from_the_newton_tolerance_are_named(self):
        self.write(scenes=("helix",))
        self.assertNotIn("Newton residual over", self.summary())
        rows = [2 * 7, 2 * 2 + 1, 2 * 1]    # two steps a task
        self.changed(("steps/newton_residual", rows, [0.024, 1.1e-5, 0.9e-5]))
        self.assertIn("WARNING: 2 of 24 steps, in 2 of 12 tasks, end with a Newton residual over 10,000 times "
                      "newton_tolerance: task 7 (0.024 in step 0), task 2 (1.1e-05 in step 1). More", self.prose())

    def test_csv_and_json_hold_the_same_numbers(self):
        self.write(failed={3: "diverged"}, samples=5)
        rows = list(csv.DictReader(io.StringIO(self.summary("--csv"))))
        whole = json.loads(self.summary("--json"))
        counts = {row["quantity"]: float(row["value"]) for row in rows if row["quantity"].startswith("tasks")}
        self.assertEqual(counts, {"tasks": 30, "tasks_ok": 29, "tasks_pending": 0, "tasks_diverged": 1,
                                  "tasks_timed_oversubscribed": 0})
        self.assertEqual(whole["tasks"], {"total": 30, "ok": 29, "pending": 0, "failed": {"diverged": 1}})
        numbers = [row for row in rows if not row["quantity"].startswith(("tasks", "solves_"))]
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

    def test_what_is_said_of_other_sweeps(self):
        blocks = [f"Helix, scene.segments = {segments}, 4 simulations" for segments in (10, 20, 40)]
        for settings, arguments, words, *absent in (
                ({"scenes": ("helix",)}, ("--by", "scene.segments"), blocks),
                ({"scenes": ("helix",), "oversubscribed": True}, (), ["WARNING"]),
                ({"scenes": ("helix",), "closed_loop": True}, (), ["closed-loop evaluation", "Helix, quadratic"]),
                ({"method": "direct"}, (), ["direct solve, no guesses", "length drift"], "CG ratio"),
                ({"pending": range(24)}, (), ["No simulation is complete yet"])):
            with self.subTest(words=words):
                self.write(**settings)
                said = self.summary(*arguments)
                for one in words:
                    self.assertIn(one, said)
                for one in absent:
                    self.assertNotIn(one, said)
        self.summary("--csv")    # no simulations
        self.summary("--json")

    def test_a_reader_that_closes_its_end_of_a_pipe_is_no_error(self):
        self.write(scenes=("helix",), solves=False)
        summary_py = os.path.join(synthetic.ANALYSIS, "summary.py")
        done = subprocess.run(["bash", "-c", f"{summary_py} sweep.h5 --csv | true; echo ${{PIPESTATUS[0]}}"], text=True,
                              capture_output=True, check=True, cwd=self.folder)
        self.assertEqual((done.stdout, done.stderr), ("0\n", ""))


class Mistakes(Scripts):
    def test_they_are_one_line_and_exit_code_2(self):
        self.write()
        plane = ("--x", "time.step_s", "--y", "scene.segments")
        for script, words, *arguments in (
                ("spatial.py", "did you mean scene.segments?", "--x", "segmnts"),
                ("spatial.py", "did you mean helix?", "--scene", "helx"),
                ("spatial.py", "'0.5'", "--tolerance", "0.5"),
                ("spatial.py", "only the zero guess", "--guess", "zero"),
                ("summary.py", "did you mean scene.length_m?", "--by", "scene.length"),
                ("summary.py", "known: 10, 20, 40", "--select", "scene.segments=7"),
                ("summary.py", "--tolerance x: ", "--tolerance", "x"),
                ("query.py", "did you mean scene.segments?", "scene.segmant=3"),
                ("query.py", "did you mean outcome?", "--columns", "task,outcom"),
                ("query.py", "segmants", "--sort", "segmants"),
                ("heatmap.py", "two parameters", "--x", "tolerance", "--y", "tolerance"),
                ("heatmap.py", "solve.tolerance", *plane[:2], "--y", "tolerance", "--measure", "speedup-cg"),
                ("heatmap.py", "did you mean scene.segments?", *plane[:2], "--y", "scene.segmnts"),
                ("heatmap.py", "one tolerance", *plane, "--tolerance", "1e-1,1e-2"),
                ("report.py", "did you mean scene.segments?", "--x", "scene.segmnts"),
                ("report.py", "guess 'subspace'", "--guess", "subspace")):
            with self.subTest(script=script, arguments=arguments):
                self.refused(script, "sweep.h5", *arguments, words=words)
        for words, settings in (("no zero guess", {"guesses": ("previous", "quadratic")}),
                                ("no guesses", {"method": "direct"}),
                                ("0 of 24 tasks ok, none failed, 24 pending", {"pending": range(24)})):
            self.write(**settings)
            self.refused("spatial.py", "sweep.h5", words=words)
