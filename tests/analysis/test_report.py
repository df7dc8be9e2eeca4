"""The report: sentences and tables have summary.py's numbers, charts have the planted ones, faults are reported."""

import base64
import html.parser
import json
import os
import re
import unittest
import unittest.mock

import synthetic
import numpy as np

import trajectories
from running import Scripts
from rodsweep.report import page


class Tables(html.parser.HTMLParser):
    """The rows of all tables of a page as lists of texts, and all text outside scripts and styles."""

    def __init__(self, text):
        super().__init__()
        self.tables, self.words, self.cell, self.silent = [], [], None, False
        self.feed(text)

    def handle_starttag(self, tag, _):
        self.silent = tag in ("script", "style") or self.silent and tag not in ("script", "style")
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.cell = []

    def handle_endtag(self, tag):
        if tag in ("script", "style"):
            self.silent = False
        elif tag in ("td", "th"):
            self.tables[-1][-1].append(" ".join("".join(self.cell).split()))
            self.cell = None

    def handle_data(self, data):
        if self.cell is not None:
            self.cell.append(data)
        if not self.silent:
            self.words.append(data)

    def text(self):
        return " ".join(" ".join(self.words).split())


class Report(Scripts):
    def report(self, *arguments, **settings):
        """The page of a planted file: its text and its data."""
        self.write(**settings)
        return self.made(*arguments)

    def made(self, *arguments):
        self.run_script("report.py", self.path, *arguments, "-o", "page.html", "--force")
        with open("page.html", encoding="utf-8") as file:
            text = file.read()
        data = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S).group(1)
        return text, json.loads(data)


class Numbers(Report):
    def test_sentences_and_table_are_the_numbers_of_the_summary(self):
        text, _ = self.report(samples=7, scenes=("helix",))
        numbers = json.loads(self.run_script("summary.py", self.path, "--json").stdout)["numbers"]

        def written(quantity, guess, tolerance=None):
            one = next(n for n in numbers if (n["quantity"], n["guess"], n["tolerance"]) == (quantity, guess, tolerance))
            return f"{one['value']:.2f} [{one['low']:.2f}, {one['high']:.2f}]"

        parsed = Tables(text)
        rows = {row[0]: row for row in parsed.tables[0][1:]}
        self.assertEqual(list(rows), ["oracle(0.1)", "quadratic", "previous", "zero", "direct"])    # by iterations
        for guess in ("previous", "quadratic", "oracle(0.1)"):
            self.assertEqual(rows[guess][1], written("cg_ratio", guess, 0.01))
            self.assertEqual(rows[guess][4], written("speedup_guess_cg", guess))
            self.assertEqual(rows[guess][6], written("speedup_step", guess))
        self.assertEqual(rows["direct"][4], written("speedup_guess_cg", "direct"))
        said = parsed.text()
        self.assertIn(f"left with quadratic {written('cg_ratio', 'quadratic', 0.01)[5:]}", said)    # never an oracle
        self.assertIn("the fewest of 2 guesses", said)
        self.assertIn(f"CG with the fastest guess has {written('speedup_over_direct_guess_cg', 'quadratic')} times", said)

    def test_bars_are_the_inverse_of_the_speedups_beside_them(self):
        text, _ = self.report(samples=7, scenes=("helix",))
        bars = re.findall(r'<svg class="bar".*?</svg>', text)
        long = [sum(map(float, re.findall(r' width="([\d.]+)" y', bar))) / 120 for bar in bars]    # of zero: 120 pixels
        np.testing.assert_allclose(long, [1 / float(row[4].split()[0]) for row in Tables(text).tables[0][1:]], atol=0.01)
        self.assertIn("CG from zero takes 20.0 µs a solve (median)", Tables(text).text())

    def test_products_stand_beside_iterations(self):
        self.write(scenes=("helix",), samples=7)
        self.changed(synthetic.spend_on_quadratic)
        text, (data, ) = self.made()
        rows = {row[0]: row for row in Tables(text).tables[0]}
        self.assertEqual([word.split()[0] for word in rows["Guess"][3:6]], ["Products", "CG", "Products"])
        self.assertEqual(rows["quadratic"][3:6], ["1.25", "0.68", "1.68"])    # (1 + 2 * .9) / 3, plus 1
        self.assertIn("those of the guess included, 1.25 are left; the fewest, 0.50, with previous.", Tables(text).text())
        measures = [measure["name"] for measure in data["families"][0]["measures"]]
        self.assertEqual(measures[:4], ["ratio", "iterations", "products_ratio", "products"])

    def test_charts_hold_the_planted_values_for_both_choices_of_newton_iterations(self):
        _, (data, ) = self.report(samples=7)
        family, = data["families"]
        labels = [line["label"] for line in family["lines"]]
        self.assertEqual(labels, [*synthetic.GUESSES, "direct"])
        axis = next(axis for axis in family["axes"] if axis["key"] == "scene.segments")
        self.assertEqual([(panel["scene"], panel["x"]) for panel in axis["panels"]],
                         [("bending_rod", [10, 20, 40]), ("helix", [10, 20, 40])])
        value, low, high, count = (np.array(part, dtype=float) for part in axis["panels"][0]["values"]["ratio"])
        shape = (2, 3, 4, len(data["tolerances"]))     # Newton iterations, points, guesses, tolerances
        for number, quality in enumerate((1, 0.5, 0.25, 0.1)):
            np.testing.assert_allclose(value.reshape(shape)[0, :, number], quality, atol=0.01)
        later = (0.5 + 2 * 0.9) / 3
        np.testing.assert_allclose(value.reshape(shape)[1, :, 1], later, atol=0.01)
        self.assertTrue((low <= value + 1e-3).all() and (value <= high + 1e-3).all() and (count == 7))
        speed = np.array(axis["panels"][1]["values"]["speedup_cg"][0], dtype=float).reshape(2, 3, len(labels))
        np.testing.assert_allclose(speed[0, :, 2], 4, rtol=1e-3)
        np.testing.assert_allclose(speed[0, :, -1], np.array([10, 20, 40]) / 8, rtol=1e-3)
        newton = {measure["name"]: measure["newton"] for measure in family["measures"]}    # [""]: there is no choice
        self.assertEqual((newton["ratio"], newton["iterations"], newton["speedup_step"]), (["first", "all"], [""], [""]))

    def test_without_guesses_there_are_steps_and_where_nothing_is_swept_the_charts_are_over_the_scene(self):
        text, (data, ) = self.report(method="direct", solves=False)
        family, = data["families"]
        self.assertEqual(family["name"], "methods")
        self.assertIn("length_drift", [measure["name"] for measure in family["measures"]])
        self.assertNotIn("CG from zero with", Tables(text).text())
        _, (data, ) = self.report(scenes=("helix",), grid={}, random={}, samples=1)
        axis, = data["families"][0]["axes"]
        self.assertEqual((axis["key"], [panel["text"] for panel in axis["panels"]]), ("scene.type", [["helix"]]))

    def test_closed_loops_have_the_steps_of_each_guess_in_their_charts(self):
        plant = synthetic.Plant(length_drift=lambda step, steps, draw, guess: -{"zero": 1e-3, "previous": 2e-3}[guess] * step)
        _, (data, ) = self.report(closed_loop=True, guesses=("zero", "previous"), plant=plant)
        drift = data["families"][0]["axes"][0]["panels"][0]["values"]["length_drift"][0]
        np.testing.assert_allclose(drift, [1e-3, 2e-3] * 3, rtol=1e-3)

    def test_only_some_tolerances_guesses_scenes_and_axes(self):
        _, (data, ) = self.report("--tolerance", "1e-3", "--guess", "zero,quadratic", "--scene", "helix", "--x",
                                  "scene.youngs_modulus_pa", samples=6)
        family, = data["families"]
        self.assertEqual(data["tolerances"], ["1e-3"])
        self.assertEqual([line["label"] for line in family["lines"]], ["zero", "quadratic", "direct"])
        self.assertEqual([axis["key"] for axis in family["axes"]], ["scene.youngs_modulus_pa"])
        self.assertEqual({panel["scene"] for panel in family["axes"][0]["panels"]}, {"helix"})


class Honesty(Report):
    def said(self, *arguments, **settings):
        return Tables(self.report(*arguments, **settings)[0]).text()

    def test_what_is_unfinished_failed_unsound_or_of_no_use_is_said(self):
        useless = synthetic.Plant(quality={"zero": 1.0, "previous": 1.5})
        missing = synthetic.Plant(reached=synthetic.unless("quadratic", 1))
        none_reached, large = synthetic.Plant(reached=lambda *_: False), synthetic.Plant(residual=1e-4)
        undirected = synthetic.Plant(direct_s=np.nan)    # as with "reference": "cg"
        for settings, words, *absent in (
                ({}, ["measured, with a direct solve for comparison."], "Half finished"),
                ({"pending": (1, 2)}, ["Half finished. 2 of 24 tasks"]),
                ({"pending": range(24)}, ["No simulation is complete yet"]),
                ({"failed": {0: "diverged", 5: "timed_out"}},
                 ["2 tasks, which are left out", "task 0: diverged – planted", "task 5: timed_out – planted"]),
                ({"oversubscribed": True}, ["more MPI ranks than cores", "Nothing is said about the clock"], "fastest"),
                ({"plant": missing},
                 ["Not all solves converged. 144 of 576 solves missed the tolerance (quadratic 144)",
                  "left with previous", "the fewest of 1 guess.", "speed of CG from zero with previous"],
                 "left with quadratic", "zero with quadratic"),
                ({"plant": none_reached}, ["Not all solves converged. 576 of 576", "No guess reached 1e-2"], "×", "nan"),
                ({"plant": synthetic.Plant(residual=1e-8)},
                 ["48 of 48 steps, in 24 of 24 tasks, end with a Newton residual over newton_tolerance: task 0 (1e-08 in "
                  "step 0)", "More newton_iterations"], "Not all steps converged"),
                ({"plant": large},
                 ["Not all steps converged. 48 of 48 steps, in 24 of 24 tasks", "task 0 (0.0001 in step 0)", "and 19 more"]),
                ({"plant": useless, "guesses": ("zero", "previous")}, ["no guess saves any", "no guess wins time"]),
                ({"guesses": ("previous", "quadratic")}, ["no zero guess"]),
                ({"solves": False}, ["nothing is said about the clock", "Each guess was tried on the same systems and its "
                                     "iterations were counted."], "×"),
                ({"plant": undirected, "closed_loop": True},
                 ["Each guess advanced its own simulations and its iterations and time were measured."], "direct solve for")):
            with self.subTest(words=words):
                said = self.said(**settings)
                for one in words:
                    self.assertIn(one, said)
                for one in absent:
                    self.assertNotIn(one, said)

    def test_what_does_not_fit_is_named(self):
        with unittest.mock.patch("report.ESTIMATES", 700):
            text, (data, ) = self.report(samples=6)
        self.assertEqual([axis["key"] for axis in data["families"][0]["axes"]], ["scene.segments"])
        self.assertIn(": scene.youngs_modulus_pa, scene.type, scene.length_m", Tables(text).text())


class Words(Report):
    def test_guesses_and_rows_of_steps_are_explained(self):
        said = Tables(self.report()[0]).text()
        for words in ("previous The solution of the same Newton iteration", "direct A block factorisation of the matrix",
                      "Newton residual What remains of the joints' equations", "Length drift Change of the total length"):
            self.assertIn(words, said)
        self.assertIn("What the methods are direct", Tables(self.report(method="direct", solves=False)[0]).text())

    def test_steps_in_balance_that_lack_forces_are_named(self):
        self.assertIn("1 of 48 steps, in 1 of 24 tasks, end with a momentum residual over momentum_tolerance: task 1 (0.2 in "
                      "step 1)", self.with_a_lack_of_forces("cg"))
        self.assertNotIn("a momentum residual over", self.with_a_lack_of_forces("xpbd"))    # never balances

    def with_a_lack_of_forces(self, method):
        self.write()
        rows = self.opened().steps.sum()
        self.changed(("steps/momentum_residual", None, np.where(np.arange(rows) == 3, 0.2, 1e-5)),
                     ("tasks/parameters/time.balance", None, np.ones(24, dtype=int)),
                     ("tasks/parameters/time.momentum_tolerance", None, np.full(24, 1e-4)),
                     ("tasks/parameters/solve.method", slice(None), method))
        return Tables(self.made()[0]).text()


class Page(Report):
    def test_it_is_one_file_that_asks_for_nothing(self):
        text, _ = self.report()
        self.assertEqual(re.findall(r'(?:src|href)="(?!#|data:)[^"]*"', text), [])
        self.assertIn("default-src 'none'", text)
        self.assertLess(len(text), 1_500_000)

    def test_texts_of_a_file_are_texts(self):
        self.assertEqual(page.embedded(["</script>", "\u2028"]), r'["\u003c/script>","\u2028"]')
        evil = "x<script>alert(1)</script>"
        plant = synthetic.Plant(quality={"zero": 1.0, evil: 0.5})
        text, (data, ) = self.report(guesses=("zero", evil), plant=plant, scenes=("helix",))
        self.assertNotIn(evil, text)
        self.assertEqual(data["families"][0]["lines"][1]["label"], evil)
        self.assertIn(evil, Tables(text).text())

    def test_rods_are_points_between_segments_in_fewer_frames(self):
        self.write(scenes=("helix",), grid={}, samples=1)
        trajectories.plant(self.path, frames=300)
        _, (data, ) = self.made()
        film, = data["animations"]
        self.assertEqual((film["points"], film["every"], len(film["time_s"])), (8, 4, 75))     # two rods of three segments
        place = np.frombuffer(base64.b64decode(film["place"]), dtype="<u2").reshape(75, 8, 3) * film["step"] + film["low"]
        np.testing.assert_allclose(place[:, 0, 1], 1 + 0.4 * np.arange(75), atol=1e-3)
        np.testing.assert_allclose(sorted(place[0, :, 0]), sorted(2 * [-0.3, -0.1, 0.1, 0.3]), atol=1e-3)

    def test_films_show_what_the_job_varies_and_stay_within_their_room(self):
        self.write(samples=2)
        trajectories.plant(self.path, frames=40)
        _, (data, ) = self.made()
        self.assertEqual([film["task"] for film in data["animations"]], [0, 2, 4, 6, 8, 10])
        self.assertEqual(data["animations"][0]["title"], "Bending rod, number of segments N 10 (task 0)")
        with unittest.mock.patch("report.ANIMATIONS", 10_000):
            _, (data, ) = self.made()
        self.assertTrue(all(8 <= len(film["time_s"]) for film in data["animations"]))
        self.assertLess(len(data["animations"][0]["time_s"]), 40)
        self.assertLess(sum(len(film["place"]) for film in data["animations"]), 10_000)
        with unittest.mock.patch("report.ANIMATIONS", 300):
            self.assertEqual(self.made()[1][0]["animations"], [])


class Commands(Report):
    def test_it_lies_beside_its_file_and_is_replaced_only_if_asked(self):
        self.write()
        self.assertEqual(self.run_script("report.py", "sweep.h5").stdout, "sweep.html\n")
        self.refused("report.py", "sweep.h5", words="already exists")
        self.refused("report.py", "sweep.h5", "-o", "sweep.h5", "--force", words="give another name")
        self.run_script("report.py", "sweep.h5", "--force")

    def test_several_files_are_one_page_with_a_table_of_all(self):
        self.write()
        synthetic.Sweep(scenes=("helix",), steps=2).write("other.h5")
        rows = Tables(self.made("other.h5")[0]).tables[0]
        self.assertEqual([row[1] for row in rows[1:]], ["Bending rod", "Helix", "Helix"])
        self.assertEqual([row[3] for row in rows[1:]], ["quadratic"] * 3)

    def test_files_that_are_no_sweeps_are_refused_or_skipped(self):
        self.write()
        synthetic.Sweep(attributes={"program": "other"}).write("model.h5")
        self.refused("report.py", "sweep.h5", "model.h5", "-o", "page.html", words="model.h5")
        self.assertFalse(os.path.exists("page.html"))
        done = self.run_script("report.py", "sweep.h5", "model.h5", "-o", "page.html", "--skip")
        self.assertIn("left out: model.h5 is an HDF5 file", done.stderr)
        self.assertIn("nothing to report", self.run_script("report.py", "model.h5", "--skip", code=2).stderr)
