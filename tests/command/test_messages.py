#!/usr/bin/python3
"""What the program says to somebody who mistyped a command, or whose job is sound and not yet right."""

import json
import os
import shutil
import unittest

from program import ALL_DONE, JOB, USER_ERROR, rodsweep, sweep

SOURCE_DIR = os.environ["SOURCE_DIR"]


def job(name, **changes):
    os.makedirs("jobs", exist_ok=True)
    path = f"jobs/{name}.json"
    with open(path, "w", encoding="utf-8") as file:
        json.dump({key: value for key, value in {**JOB, "name": name, **changes}.items() if value is not None}, file)
    return path


class Case(unittest.TestCase):
    def assert_says(self, words, code, stdout, stderr):
        said = rodsweep(*words)
        self.assertEqual((said.returncode, said.stdout, said.stderr), (code, stdout, stderr))


class Mistyped(Case):
    def test_a_command_or_option_that_is_none_is_answered_with_the_nearest(self):
        more = "\nRun with --help for more information.\n"
        for words, said in ((["valdate", "a.json"], 'rodsweep: there is no command "valdate", and no program rodsweep-valdate; did you mean "validate"?'),
                            (["frobnicate"], 'rodsweep: there is no command "frobnicate", and no program rodsweep-frobnicate'),
                            (["run", "a.json", "--resme"],
                             'rodsweep run: there is no option --resme; did you mean "--resume"?'),
                            (["run", "a.json", "--otput=x.h5"],
                             'rodsweep run: there is no option --otput; did you mean "--output"?'),
                            (["--verson"], 'rodsweep: there is no option --verson; did you mean "--version"?')):
            with self.subTest(words=words):
                self.assert_says(words, USER_ERROR, "", said + more)

    def test_a_missing_comma_is_shown(self):
        os.makedirs("jobs", exist_ok=True)
        with open("jobs/comma.json", "w", encoding="utf-8") as file:
            file.write('{"name": "comma",\n "kind": "sweep"\n "seed": 3}')
        self.assert_says(["validate", "jobs/comma.json"], USER_ERROR, "",
                         'rodsweep: error: jobs/comma.json: line 2, column 17: a comma is missing here\n'
                         ' "kind": "sweep"\n'
                         '                ^\n')


class Validate(Case):
    def data(self):
        return job("few", kind="dataset", solve=None, guesses=None)

    def train(self):
        path = "jobs/net.json"
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"name": "net", "kind": "train", "data": "../results/few.h5", "validation_simulations": 1}, file)
        return path

    def use(self):
        return job("use", guesses=["zero", {"copingnet": {"model": "../results/net.h5"}}])

    def test_a_file_that_is_not_there_is_refused_unless_a_job_beside_makes_it(self):
        use = self.use()
        missing = 'rodsweep: error: jobs/use.json: guesses[1].copingnet.model: "../results/net.h5" is not allowed: ' \
                  "jobs/../results/net.h5 is not there; the path is relative to the job file's folder"
        hint = "\njobs/use.json: what another job makes passes if that job is given too, or with --later\n"
        self.assert_says(["validate", use], USER_ERROR, "", missing + hint)
        os.makedirs("results", exist_ok=True)
        open("results/nett.h5", "w", encoding="utf-8").close()
        self.assert_says(["validate", use], USER_ERROR, "", missing + '; did you mean "../results/nett.h5"?' + hint)
        os.remove("results/nett.h5")
        all_three = [use, self.train(), self.data()]
        self.assert_says(["validate", *all_three], ALL_DONE,
                         "jobs/use.json: sound, 4 tasks\njobs/net.json: sound, trains a model\njobs/few.json: sound, 4 tasks\n",
                         "rodsweep: jobs/use.json: guesses[1].copingnet.model: jobs/../results/net.h5 is not there yet; "
                         "jobs/net.json makes it\n"
                         "rodsweep: jobs/net.json: data: jobs/../results/few.h5 is not there yet; jobs/few.json makes it\n")
        self.assert_says(["validate", "--later", use], ALL_DONE, "jobs/use.json: sound, 4 tasks\n",
                         "rodsweep: jobs/use.json: guesses[1].copingnet.model: jobs/../results/net.h5 is not there yet\n")

    def test_a_skeleton_that_is_not_there_is_refused_whatever_comes_later(self):
        tree = job("tree", samples=1, scene={"type": "skeleton", "skeleton": "aple_tree.swc", "density_kg_m3": 800,
                                  "youngs_modulus_pa": 1e9, "torsion_modulus_pa": 4e8})
        shutil.copy(os.path.join(SOURCE_DIR, "jobs", "apple_tree.swc"), "jobs")
        said = rodsweep("validate", tree)
        self.assertEqual(said.returncode, USER_ERROR)
        self.assertIn('jobs/tree.json: scene.skeleton: "aple_tree.swc" is not allowed: jobs/aple_tree.swc is not there; '
                      'the path is relative to the job file\'s folder; did you mean "apple_tree.swc"?', said.stderr)
        self.assertEqual(rodsweep("validate", "--later", tree).returncode, USER_ERROR)

    def test_a_data_set_that_does_not_do_is_refused_as_run_refuses_it(self):
        sweep("some", kind="dataset", solve=None, guesses=None)
        with open("jobs/greedy.json", "w", encoding="utf-8") as file:
            json.dump({"name": "greedy", "kind": "train", "data": "../results/some.h5"}, file)
        said = rodsweep("validate", "jobs/greedy.json")
        self.assertEqual(said.returncode, USER_ERROR)
        self.assertIn("validation_simulations: 100 is not allowed, since results/some.h5 holds 4 simulations", said.stderr)

    def test_every_job_of_the_project_validates_without_a_warning(self):
        folder = os.path.join(SOURCE_DIR, "jobs")
        jobs = sorted(os.path.join(folder, name) for name in os.listdir(folder) if name.endswith(".json"))
        said = rodsweep("validate", "--later", *jobs)
        self.assertEqual(said.returncode, ALL_DONE, said.stderr)
        self.assertNotIn("warning", said.stderr)
        self.assertEqual(len(said.stdout.splitlines()), len(jobs))

    def test_a_likely_slip_of_units_is_told_by_validate_and_run_and_stops_nothing(self):
        thick = job("thick", samples=1, scene={**JOB["scene"], "segments": 5, "length_m": 2, "radius_m": 50},
                    time={"step_s": 0.02, "steps": 1})
        warning = "rodsweep: warning: jobs/thick.json: scene.radius_m: 50 m makes a rod thicker than long, where length_m " \
                  "is 2 m; did you mean 50 mm, which is 0.05?\n"
        self.assert_says(["validate", thick], ALL_DONE, "jobs/thick.json: sound, 1 task\n", warning)
        self.assertEqual(rodsweep("run", thick, "-o", "thick.h5").stderr.count(warning), 1)


if __name__ == "__main__":
    unittest.main()
