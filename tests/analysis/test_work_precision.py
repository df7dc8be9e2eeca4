"""work_precision.py: the cheapest method for an error, panels and lines of its figure."""

import argparse
import unittest

import ways
import work_precision
from rodsweep.drawing import study
from rodsweep.reading import accuracy
from rodsweep.reading.sweepfile import SweepFile
from ways import SAMPLES, WAYS

ICC = ("CG icc from previous to 1e-1, Newton 1", "CG icc from previous to 1e-2, Newton 2",
       "CG icc from zero to 1e-2, Newton 2")


class WorkPrecision(ways.Planted):
    def table(self, *arguments, files=False, **settings):
        """The rows of the printed table, with single blanks."""
        self.write(**settings)
        said = self.run_script("work_precision.py", "sweep.h5", *arguments, files=files).stdout
        self.assertTrue(said.rstrip().endswith("sweep-work-precision.png"))
        return [" ".join(line.split()) for line in said.split("\n\n")[0].splitlines()]

    def rows(self):
        """Rows of panels of the figure: titles, and names of the lines and of the legend."""
        options = argparse.Namespace(select=[], scene=None, guess=None, newton="first", width="174")
        with SweepFile(self.path) as file:
            shown = study.of_tasks(file, options)
            found = accuracy.accuracy(file, shown.sims.tasks())
            points = sum(work_precision.by_panel(file, found, file.parameter("scene.type")).values(), [])
            return [(title, [name(point.way) for point in points], list(looks))
                    for title, name, looks in work_precision.choices(shown, points)]

    def test_every_error_has_its_cheapest_way_and_what_cg_costs_beside_the_direct_solve(self):
        found = self.table(files=True)
        self.assertEqual(found[1:], [f"bending rod 0.01 xpbd 50 10 {ICC[0]} 30 1.5",
                                     f"0.001 xpbd 50 10 {ICC[1]} 40 2",
                                     f"0.0001 direct, Newton 2 20 {ICC[1]} 40 2",
                                     "1e-06 - - - - -"])

    def test_panels_are_words_in_the_order_of_the_job_or_numbers_in_theirs(self):
        found = self.table(scenes=("net", "bending_rod"))
        self.assertEqual([line.split(" 0.01")[0] for line in found if " 0.01 " in line], ["net", "bending rod"])
        found = self.table("--columns", "time.step_s")
        self.assertTrue(found[1].startswith("time step (s) 0.02 0.01 xpbd"), found[1])

    def test_guesses_that_were_not_chosen_and_ways_that_failed_once_are_out(self):
        self.assertEqual(self.table("--guess", "zero")[2], f"0.001 xpbd 50 10 {ICC[2]} 50 2.5")
        failed = SAMPLES * WAYS.index(accuracy.Way("cg", 2, 0, 1e-2, "icc", "previous"))
        self.assertEqual(self.table(failed={failed: "torn"})[2], f"0.001 xpbd 50 10 {ICC[2]} 50 2.5")

    def test_a_row_of_panels_tells_one_choice_apart(self):
        self.write()
        methods, preconditioners, guesses = self.rows()
        self.assertEqual(methods, ("Methods, with the best preconditioner and guess of CG at every point",
                                   ["direct", "xpbd", "pbd", *["CG"] * 4], ["direct", "xpbd", "pbd", "CG"]))
        self.assertEqual(preconditioners[1:], (["direct", "xpbd", "pbd", "jacobi", *["icc"] * 3],
                                               ["direct", "jacobi", "icc"]))
        self.assertEqual(guesses[1:], (["direct", "xpbd", "pbd", "zero", "zero", "previous", "previous"],
                                       ["direct", "zero", "previous"]))


if __name__ == "__main__":
    unittest.main()
