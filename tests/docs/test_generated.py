"""docs/tools/pages.py: numbers of tables in pages; the pages of this repository are current."""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

TOOLS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs", "tools")
sys.path.insert(0, TOOLS)
import pages  # noqa: E402
import origins  # noqa: E402
import scores  # noqa: E402    puts analysis/ into sys.path
from rodsweep.reading.errors import SweepFileError  # noqa: E402
from rodsweep.reading.job_paths import checksum  # noqa: E402
from rodsweep.scoring import answers, scenes, settings  # noqa: E402

TABLE = """results/x.h5: job x

CG ratio, first Newton iteration

Bending rod, n = 300                 1e-1               1e-2
  previous              0.25 [0.23, 0.27]  0.46 [0.44, 0.48]
  last 9                0.07 [0.06, 0.08]  0.10 [0.09, 0.11]

Helix, of a very long title
                                     1e-1               1e-2
  last 9                0.19 [0.06, 0.08]  0.34 [0.09, 0.11]

Time per solve

Bending rod, n = 300  guess µs  solve µs
  last 9                  2.00     1,234

                        n  failed
Bending rod, one a step
  last 9               10       2
Bending rod, six a step
  last 9               10       3
"""


class Pages(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.write("x.txt", TABLE)

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def page(self, template):
        return pages.rendered(self.write("page.md.j2", template), self.folder)

    def refused(self, template):
        with self.assertRaises(pages.NotFound) as refused:
            self.page(template)
        return str(refused.exception)

    def score(self, text):
        """A helix on which the direct solve is the fastest, and a net on which CG from zero may be as fast; at 1 % no kind
        keeps to the error."""
        noise = np.exp(0.05 * np.random.default_rng(1).normal(size=(2, 1, 3, 40)))
        for scene, zero in (("net", 2.51), ("helix", 5)):
            for part in ("jobs/score", "analysis/results/score"):
                os.makedirs(os.path.join(self.folder, part), exist_ok=True)
            self.write(f"jobs/score/{scene}_draws.json", json.dumps(scenes.Scene(scene).job))
            made = scenes.Scene(scene, self.folder)
            kept, missed = np.full((1, 40), 0.03), np.full((1, 40), 0.12)
            found = [answers.Answer(level, kind, settings.direct(settings.Step(0.02, "bdf2", newton)), time,
                                    error if level == 0.1 else missed, 0, 0, 1e-3 * time * noise[newton % 2])
                     for level in (0.1, 0.01) for newton, (kind, time, error) in enumerate((
                         (settings.DIRECT, 2.5, kept), (settings.ZERO, zero, kept), (settings.CLASSICAL, 1.25, missed),
                         (settings.JACOBI, 2000, kept)), 1)]
            answers.Scored(scene, made.title, checksum(made.job), "r", "2026-11-29", {}, {}, [0.1, 0.01], {},
                           found).write(made.measured(".json"))
        return pages.rendered(self.write("page.md.j2", text), self.folder, self.folder)

    def test_the_score_is_a_table_of_times_at_errors(self):
        table = self.score("{{ score.times('10 %', '1 %') }}").splitlines()
        self.assertEqual(table[0].split(" | ")[:4], ["| scene", "error", "direct solve", "CG from zero"])
        self.assertEqual([re.sub(r"(\d)\.\d+", r"\1", row) for row in table[2:]],
                         ["| helix | 10 % | **2** | 4 | (1) | – | – | 1990 | – |",
                          "| net | 10 % | **2** | **2** | (1) | – | – | 1990 | – |"])
        self.assertEqual(self.score("{{ score.factors('10 %') }}").splitlines()[2:],
                         ["| helix | **1** | 2 | – | – |", "| net | **1** | **1** | – | – |"])
        chosen = self.score("{{ score.chooser() }}").splitlines()
        self.assertEqual([chosen[0], chosen[2]], ["|  | 10 % |", "| helix | 1.00 |"])
        self.assertRegex(chosen[3], r"net \| (0.99|1\.0[01]) ")    # of two that take as long, nothing is gained

    def test_the_fastest_kinds_are_those_that_are_not_told_apart_from_the_fastest(self):
        noise = np.exp(0.02 * np.random.default_rng(1).normal(size=(4, 1, 3, 40)))
        found = {kind: answers.Answer(0.1, kind, settings.direct(settings.Step(0.02, "bdf2", newton)), tuning,
                                      np.full((1, 40), 0.03), 0, 0, time * noise[newton])
                 for newton, (kind, tuning, time) in enumerate(((settings.DIRECT, 1, 2), (settings.ZERO, 2, 1),
                                                                (settings.CLASSICAL, 3, 1), (settings.CALL, 4, 1.5)))}
        self.assertEqual(scores._fastest(answers.judged(found)), {settings.ZERO, settings.CLASSICAL})

    def test_a_block_is_that_of_its_name_before_one_that_begins_with_it(self):
        self.write("rods.txt", "a table\n" + "\n".join(f"{name:<20}{step:>20}{number:>10}" for name, step, number in (
            ("", "", "error"), ("curves that move", "other", "0.01"), ("", "default", "0.02"), ("curves", "other", "0.03"),
            ("", "default", "0.04"))))
        for block, error in (("curves", ".04"), ("curves that", ".02")):
            self.assertEqual(self.page('{{ cell("rods; *; ' + block + '; default; error", ".00") }}').strip(), error)

    def test_sentences_name_the_fastest_kinds_of_the_score(self):
        for asked, found in (("fastest('direct solve')", "helices at 10 %"), ("among('direct solve')", "nets at 10 %"),
                             ("fastest('CG from zero')", ""), ("among('CG from zero')", "nets at 10 %"),
                             ("fastest('CG, classical guess')", ""),    # its errors are too large
                             ("chosen('CG, Jacobi', 'direct')", "helices at 10 % and nets at 10 %"), ("missing()", ""),
                             ("chosen('Gauss-Seidel', '')", ""), ("chosen('CG, classical guess', '')", ""),
                             ("made_by()", "r (2026-11-29)")):
            self.assertEqual(self.score("{{ score." + asked + " }}").strip(), found, asked)
        self.assertEqual(scores._places([("tree", "1 %"), ("tree", "0.1 %"), ("tree", "10 %"), ("knot", "1 %")]),
                         "trees at 1, 0.1 and 10 % and knots at 1 %")

    def test_a_score_of_another_job_is_not_quoted(self):
        self.score("")
        self.write("jobs/score/net_draws.json", json.dumps({**scenes.Scene("net").job, "seed": 1}))
        with self.assertRaisesRegex(SweepFileError, "net.json is of another jobs/score/net_draws.json: measure it again"):
            pages.rendered(self.write("page.md.j2", "{{ score.missing() }}"), self.folder, self.folder)

    def test_the_fastest_combinations_have_a_row_a_block(self):
        rows = [("the cheapest", "", "µs", "over classical guess", "over from zero", "over direct"),
                ("direct", "direct", "43 [33, 58]", "0.8 [0.5, 1]", "0.9 [0.7, 1]", "-"),
                ("from zero", "block icc from zero", "40 [39, 41]", "0.9 [0.8, 1]", "-", "1 [0.8, 1]"),
                ("classical guess", "jacobi from quadratic", "35", "-", "1 [1, 1]", "1 [1, 2]"),
                ("learned guess", "block icc from copingnet x lag 8", "70", "0.5 [0.4, 0.6]", "0.6 [0.5, 0.7]",
                 "0.7 [0.6, 0.8]")]
        table = [f"  {row[0]:<20}{row[1]:>40}" + "".join(f"{cell:>22}" for cell in row[2:]) for row in rows]
        other = [line.replace("quadratic", "previous!") for line in table]
        self.write("net.txt", "\n".join(["Net, rows = 8: 1176 joints, n = 5", "", *table, "",
                                         "Net, rows = 9: 12 joints", "", *other, ""]))
        page = self.page("{{ cheapest('net', {'8 × 8': 'Net, rows = 8:'}) }}").splitlines()
        self.assertEqual(page[2], "| 8 × 8 | 1,176 | 43 | 40 `block_icc` | 35 `jacobi`, `quadratic` | "
                                  "70 `block_icc`, `x lag 8` | 1 [1, 1] | 0.6 [0.5, 0.7] | 0.5 [0.4, 0.6] |")
        self.assertIn("net.txt has no block 'Net, rows = 7:'", self.refused("{{ cheapest('net', {'7': 'Net, rows = 7:'}) }}"))

    def test_a_table_that_is_older_than_its_job_or_models_is_not_quoted(self):
        with open(origins.find_job("tree_wind"), encoding="utf-8") as file:
            job = json.load(file)
        folder = os.path.dirname(origins.find_job("tree_wind"))
        now = {"job": checksum({**job, "description": "Another."}), "models": origins.models_checksum(job, folder)}
        self.write("tree_wind.txt", TABLE)
        quote = "{{ cell('tree_wind; CG ratio; Bending rod, n = 300; last 9; 1e-2', '.00') }}"
        for changed, why in ({}, None), ({"job": "0"}, "tree_wind.json has changed since"), ({"models": "0"}, "a model of"):
            row = {**dict.fromkeys(origins.COLUMNS, "x"), "study": "tree_wind", **now, **changed}
            self.write("origins.txt", "  ".join(origins.COLUMNS) + "\n" + "  ".join(row.values()) + "\n")
            if why:
                self.assertIn(why, self.refused(quote))
            else:
                self.assertIn(".10", self.page(quote))

    def test_every_table_here_is_of_its_job_and_models(self):
        self.assertEqual(origins.older(origins.read()), {})

    def test_times_of_a_disturbed_block_are_not_quoted(self):
        disturbed = "  Left out: 9 of 99 solves. These times are not to be trusted.\n"
        self.write("busy.txt", TABLE.replace("     1,234\n", "     1,234\n" + disturbed))
        time = '{{ cell("busy; Time per solve; Bending rod; last 9; solve µs", "0") }}'
        self.assertIn("times to be trusted", self.refused(time))
        self.assertEqual(self.page(time.replace("busy", "x")), "1234")
        self.assertEqual(self.page('{{ cell("busy; CG ratio; Bending rod; last 9; 1e-2", ".00") }}'), ".10")

    def test_numbers_have_the_style_that_is_asked_for(self):
        for address, style, text in (("CG ratio; Bending rod; last 9; 1e-2", ".00", ".10"),
                                     ("CG ratio; Bending rod; last 9; 1e-2", "0.0", "0.1"),
                                     ("*; Helix; last 9; 1e-2; 2", ".00", ".09"),
                                     ("*; Bending rod, six; last 9; failed", "0", "3"),
                                     ("Time per solve; Bending rod; last 9; solve µs", "0,000", "1,234"),
                                     ("Time per solve; Bending rod; last 9; solve µs", "0", "1234"),
                                     ("Time; Bending; last 9; solve µs", "0.0e0", "1.2e3")):
            with self.subTest(address=address, style=style):
                self.assertEqual(self.page(f'a **{{{{ cell("x; {address}", "{style}") }}}}**\n'), f"a **{text}**\n")

    def test_halves_are_rounded_up(self):
        self.assertEqual([pages.styled(number, ".0") for number in ("0.25", "0.35", "0.05")], [".3", ".4", ".1"])

    def test_a_number_gets_no_digits_that_it_does_not_have(self):
        self.assertEqual([pages.styled(number, "0.000") for number in ("0.3", "3", "2e-3")], ["0.3", "3", "0.002"])

    def test_whole_tables_by_their_rows_and_columns(self):
        template = """above
{% filter table("x; CG ratio; {row}; {column}; 1e-1, 1e-2") %}
| 1e-1, 1e-2 | last 9 | last@<<previous>> | - |
|---|---|---|---|
| rods@<<Bending rod>> | .00 **.00** [.00, .00] | .00 .00, `not 3` | 4 |
| Helix | .00 .00 | | |
{% endfilter %}
below
"""
        self.assertEqual(self.page(template), """above
| 1e-1, 1e-2 | last 9 | last | - |
|---|---|---|---|
| rods | .07 **.10** [.09, .11] | .25 .46, `not 3` | 4 |
| Helix | .19 .34 | | |
below
""")
        self.assertIn("1 numbers for 2 columns in '.00'", self.refused(template.replace("| .00 .00 |", "| .00 |")))

    def test_what_no_table_has_is_named(self):
        for address, words in (("x; CG ratio; Bending rod; last 8; 1e-2", "x.txt has no row 'last 8'"),
                               ("x; CG ratio; Bending rod; last 9; 1e-3", "no column '1e-3'"),
                               ("x; CG ratio; Ring; last 9; 1e-2", "no block 'Ring'"),
                               ("x; Steps; Ring; last 9; 1e-2", "no section 'Steps'"),
                               ("x; CG ratio; Helix; last 9; 1e-2; 4", "no number 4"),
                               ("y; CG ratio; Ring; last 9; 1e-2", "there is no table")):
            self.assertIn(words, self.refused(f'{{{{ cell("{address}", ".00") }}}}'))

    def test_the_pages_of_this_repository_are_current(self):
        done = subprocess.run([sys.executable, os.path.join(TOOLS, "pages.py"), "--check"], text=True, capture_output=True,
                              check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_no_page_has_a_comment(self):
        for template in pages.templates():
            with open(template.removesuffix(".j2"), encoding="utf-8") as page:
                self.assertNotIn("<!--", page.read())
