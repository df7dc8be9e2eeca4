#!/usr/bin/python3
"""Messages for a mistyped command, and for a valid job whose values or files need attention."""

import json
import os
import shutil
import unittest

from program import ALL_DONE, DATA, ROD, Case, rodsweep, sweep, write_job

SOURCE_DIR = os.environ["SOURCE_DIR"]


class Mistyped(Case):
    def test_a_command_or_option_that_is_none_is_answered_with_the_nearest(self):
        for words, *texts in ((("valdate", "a.json"), '"valdate"', "rodsweep-valdate", 'did you mean "validate"?'),
                              (("frobnicate",), '"frobnicate"', "rodsweep-frobnicate"),
                              (("run", "a.json", "--resme"), "--resme", 'did you mean "--resume"?'),
                              (("run", "a.json", "--otput=x.h5"), "--otput", 'did you mean "--output"?'),
                              (("--verson",), "--verson", 'did you mean "--version"?')):
            with self.subTest(words=words):
                self.assert_refused(words, "--help", *texts)
        self.assertNotIn("did you mean", rodsweep("frobnicate").stderr)


    def test_numbers_must_be_finite(self):
        for option in ("--memory-limit-gb", "--time-limit", "--task-time-limit", "--worker-timeout"):
            for value in ("nan", "inf", "-inf"):
                with self.subTest(option=option, value=value):
                    self.assert_refused(("run", write_job("small"), f"{option}={value}"), f"{option}: {value} is not allowed")

    def test_petsc_options_without_effect_are_named(self):
        done = rodsweep("run", write_job("petsc"), env={**os.environ, "PETSC_OPTIONS": "-pc_type lu -log_view :log.txt"})
        self.assertEqual(done.returncode, ALL_DONE, done.stderr)
        self.assertIn("PETSC_OPTIONS: -pc_type has no effect", done.stderr)
        self.assertTrue(os.path.exists("log.txt"))


class Validate(Case):
    """For missing files and JSON see tests/runner/job/test_input_files.cpp and test_job_refusals.cpp."""

    def validated(self, *words):
        said = rodsweep("validate", *words)
        self.assertEqual(said.returncode, ALL_DONE, said.stderr)
        return said.stdout.splitlines(), said.stderr.splitlines()

    def test_a_file_that_is_not_there_is_refused_unless_a_job_beside_makes_it(self):
        use = write_job("use", guesses=["zero", {"copingnet": {"model": "../results/net.h5"}}])
        data = write_job("few", **DATA)
        train = "jobs/net.json"
        with open(train, "w", encoding="utf-8") as file:
            json.dump({"name": "net", "kind": "train", "data": "../results/few.h5", "validation_simulations": 1}, file)
        key = "jobs/use.json: guesses[1].copingnet.model: "
        self.assert_refused(("validate", use), key, '"../results/net.h5"', "jobs/../results/net.h5", "--later")
        results, notes = self.validated(use, train, data)
        self.assertEqual([line.split(": ")[0] for line in results], [use, train, data])
        self.assertEqual(len(notes), 2)
        for note, *texts in ((notes[0], key, "results/net.h5", train),
                             (notes[1], "jobs/net.json: data: ", "results/few.h5", data)):
            for text in texts:
                self.assertIn(text, note)
        results, notes = self.validated("--later", use)
        self.assertEqual((len(results), len(notes)), (1, 1))
        self.assertIn(key + "jobs/../results/net.h5", notes[0])

    def test_a_skeleton_that_is_not_there_is_refused_whatever_comes_later(self):
        tree = write_job("tree", samples=1, scene={"type": "skeleton", "skeleton": "aple_tree.swc",
                         "density_kg_m3": 800, "youngs_modulus_pa": 1e9, "torsion_modulus_pa": 4e8})
        shutil.copy(os.path.join(SOURCE_DIR, "jobs", "apple_tree.swc"), "jobs")
        self.assert_refused(("validate", tree), "jobs/tree.json: scene.skeleton: ", "jobs/aple_tree.swc",
                            'did you mean "apple_tree.swc"?')
        self.assert_refused(("validate", "--later", tree), "jobs/tree.json: scene.skeleton: ", "jobs/aple_tree.swc")

    def test_a_data_set_that_does_not_do_is_refused_as_run_refuses_it(self):
        sweep("some", **DATA)
        with open("jobs/greedy.json", "w", encoding="utf-8") as file:
            json.dump({"name": "greedy", "kind": "train", "data": "../results/some.h5"}, file)
        self.assert_refused(("validate", "jobs/greedy.json"), "validation_simulations: 100 ", "results/some.h5",
                            "4 simulations")

    def test_a_likely_slip_of_units_is_told_by_validate_and_run_and_stops_nothing(self):
        thick = write_job("thick", samples=1, scene={**ROD, "segments": 5, "length_m": 2, "radius_m": 5},
                          time={"step_s": 0.02, "steps": 1})
        (_, (warning,)), run = self.validated(thick), rodsweep("run", thick, "-o", "thick.h5")
        self.assertRegex(warning, r"warning: jobs/thick\.json: scene\.radius_m: 5 m.*\b2 m\b.*\b5 mm.*\b0\.005\b")
        self.assertEqual(run.stderr.count(warning), 1)


if __name__ == "__main__":
    unittest.main()
