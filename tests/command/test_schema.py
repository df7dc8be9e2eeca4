#!/usr/bin/python3
"""jobs/schema.json is up to date and agrees with the reader on good and bad jobs."""

import copy
import glob
import json
import os
import unittest

import jsonschema
from program import rodsweep

JOBS = os.path.join(os.environ["SOURCE_DIR"], "jobs")

ROD = {"type": "bending_rod", "segments": 10, "length_m": 2, "radius_m": 0.05, "density_kg_m3": 1000,
       "youngs_modulus_pa": 1e5, "torsion_modulus_pa": 1e6}
HELIX = {"type": "helix", "segments": 45, "helix_radius_m": 0.5, "helix_height_m": 0.4, "windings": 2, "radius_m": 0.05,
         "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e5}
JOB = {"name": "small", "kind": "sweep", "scene": ROD, "time": {"step_s": 0.02, "steps": 10},
       "guesses": ["zero", "previous"]}

TRAINING = {"kind": "train", "scene": None, "time": None, "guesses": None, "data": "data.h5"}

# Changes of JOB: a path of keys and its value, or None to remove the key. GOOD has what no job of the project has.
GOOD = {
    "nothing changed": {},
    "a shear modulus": {"scene.torsion_modulus_pa": None, "scene.shear_modulus_pa": {"grid": [1e5, 1e6]}},
    "ranges": {"scene.length_m": {"uniform": [1, 5]}, "scene.segments": {"integer": [5, 9]},
               "scene.youngs_modulus_pa": {"log_uniform": [1e4, 1e6]}, "scene.damping_per_s": {"integer": [0, 3]}},
    "a sweep within a sweep": {"scene.length_m": {"grid": [1, {"uniform": [2, 3]}]}},
    "a swept component": {"scene.gravity_m_s2": [0, {"grid": [-9.81, -1.6]}, 0]},
    "a swept vector": {"scene.gravity_m_s2": {"grid": [[0, -9.81, 0], [0, 0, 0]]}},
    "a word for a number": {"scene.stretch_compliance_per_j": {"grid": ["from_stretch", 1e-9]}},
    "obstacles": {"scene.contact": {}, "scene.obstacles": [
        {"half_space": {}}, {"ball": {"centre_m": [0, {"uniform": [-1, 0]}, 0], "radius_m": 1}},
        {"grid": [{"capsule": {"from_m": [0, 0, 0], "to_m": [1, 0, 0], "radius_m": 0.1}}, {"half_space": {}}]}]},
    "swept obstacles": {"scene.contact": {}, "scene.obstacles": {"grid": [[], [{"half_space": {}}]]}},
    "guesses as objects": {"guesses": [{"zero": {}}, {"oracle": {"error": {"grid": [0.1, 0.2]}, "label": "o"}}]},
    "a guarded guess": {"guesses": ["zero", {"guarded": {"guess": {"oracle": {"error": 0.2}}, "threshold": 1}}]},
    "swept guarded guesses": {"guesses": ["zero", {"guarded": {"guess": {"grid": ["linear", "quadratic"]},
                                                               "threshold": 1, "label": "g"}}]},
    "a swept guess": {"guesses": ["zero", {"grid": ["linear", {"oracle": {"error": {"grid": [0.1, 0.2]}}}]}]},
    "a swept guess with a label": {"guesses": ["zero", {"grid": ["linear", "quadratic"], "label": "history"}]},
    "a whole number with a point": {"scene.segments": 10.0},
    "a training with all its keys": {**TRAINING, "validation_simulations": 3, "network": {
        "encoding": "paper_residual", "processor": "message_passing", "base": "none", "base_size": 3, "latent": 16, "steps": 2,
        "globals": True, "best_length": False, "moves": True}, "training": {
            "loss": "mse", "epochs": 3, "batch": 8, "shards": 2, "rate": 1e-3, "warm_up": 0.1, "weight_decay": 1e-4,
            "clip": 2, "patience_epochs": 2, "ratio_every_epochs": 0, "ratio_simulations": 3}},
    "a data set of all systems": {"kind": "dataset", "guesses": None, "record": {"systems": "all", "solves": "summary"}},
}
BAD = {
    "two names of one modulus": {"scene.shear_modulus_pa": 1e6},
    "an unknown key": {"scene.lenght_m": 2},
    "an unknown key of the job": {"comment": "no"},
    "a missing key": {"scene.radius_m": None},
    "a missing scene": {"scene": None},
    "a key of another scene": {"scene.windings": 2},
    "a helix without its keys": {"scene": {**HELIX, "windings": None}},
    "a bound that is not allowed itself": {"scene.length_m": 0},
    "a value below": {"scene.segments": 0},
    "a value above": {"solve": {"tolerance": 2}},
    "a fraction": {"scene.segments": 10.5},
    "a text for a number": {"scene.length_m": "2"},
    "an unknown word": {"solve": {"preconditioner": "jacoby"}},
    "an unknown word for a number": {"scene.stretch_compliance_per_j": "stiff"},
    "a name that is no file name": {"name": "a/b"},
    "a training without data": {**TRAINING, "data": None},
    "a training that is swept": {**TRAINING, "training": {"rate": {"grid": [1e-3, 2e-3]}}},
    "factors with moves": {**TRAINING, "network": {"moves": True}, "training": {"loss": "mse"}},
    "factors with hops": {**TRAINING, "network": {"processor": "factors", "steps": 3}},
    "an energy loss with steps of CG": {**TRAINING, "training": {"cg_steps": 3}},
    "a number for true": {**TRAINING, "network": {"best_length": 1}},
    "two components": {"scene.gravity_m_s2": [0, -9.81]},
    "an obstacle alone": {"scene.contact": {}, "scene.obstacles": {"half_space": {}}},
    "an unknown obstacle": {"scene.contact": {}, "scene.obstacles": [{"cube": {}}]},
    "two obstacles in one": {"scene.contact": {}, "scene.obstacles": [
        {"half_space": {}, "ball": {"centre_m": [0, 0, 0], "radius_m": 1}}]},
    "a ball without a radius": {"scene.contact": {}, "scene.obstacles": [{"ball": {"centre_m": [0, 0, 0]}}]},
    "neither steps nor duration": {"time.steps": None},
    "a sweep of what cannot be swept": {"seed": {"grid": [1, 2]}},
    "a sweep of the list of guesses": {"guesses": {"grid": [["zero"], ["zero", "linear"]]}},
    "an empty grid": {"scene.segments": {"grid": []}},
    "a bad value in a grid": {"scene.segments": {"grid": [5, 0]}},
    "a key beside a grid": {"scene.segments": {"grid": [5], "note": 1}},
    "a range of one end": {"scene.length_m": {"uniform": [1]}},
    "a range out of bounds": {"scene.length_m": {"uniform": [0, 5]}},
    "a log_uniform range from zero": {"scene.damping_per_s": {"log_uniform": [0, 5]}},
    "a fractional range of integers": {"scene.segments": {"uniform": [5, 9]}},
    "a range of words": {"scene.clamp": {"uniform": [1, 2]}},
    "an unknown guess": {"guesses": ["zero", "previus"]},
    "an unknown parameter of a guess": {"guesses": ["zero", {"oracle": {"eror": 0.1}}]},
    "a guess that needs parameters alone": {"guesses": ["zero", "guarded"]},
    "a label within a guarded guess": {"guesses": ["zero", {"guarded": {"guess": {"linear": {"label": "x"}},
                                                                        "threshold": 1}}]},
    "a label within a swept guess": {"guesses": ["zero", {"grid": [{"linear": {"label": "x"}}, "quadratic"]}]},
    "a range of guesses": {"guesses": ["zero", {"uniform": [1, 2]}]},
    "two guesses in one": {"guesses": [{"zero": {}, "linear": {}}]},
    "a data set with guesses": {"kind": "dataset"},
    "a data set with norms": {"kind": "dataset", "guesses": None, "record": {"norms": "one"}},
    "a sweep with systems": {"record": {"systems": "first"}},
    "an empty label": {"guesses": ["zero", {"linear": {"label": ""}}]},
}


def changed(changes):
    job = copy.deepcopy(JOB)
    for path, value in changes.items():
        *parents, last = [path] if path.startswith("$") else path.split(".")
        place = job
        for key in parents:
            place = place[key]
        place[last] = value
        if value is None:
            del place[last]
    return json.loads(json.dumps(job), object_hook=lambda o: {k: v for k, v in o.items() if v is not None})


class Schema(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(os.path.join(JOBS, "schema.json"), encoding="utf-8") as file:
            cls.text = file.read()
        cls.schema = json.loads(cls.text)
        cls.validator = jsonschema.Draft7Validator(cls.schema)

    def read(self, jobs):
        """Names of the jobs that the program accepts, from one call."""
        paths = {}
        for number, (name, changes) in enumerate(jobs.items()):
            paths[name] = f"{number}.json"
            with open(paths[name], "w", encoding="utf-8") as file:
                json.dump(changed(changes), file)
        said = rodsweep("validate", "--later", *paths.values())
        self.assertIn(said.returncode, (0, 2))
        lines = said.stdout.splitlines()
        return {name for name, path in paths.items() if any(line.startswith(path + ": valid") for line in lines)}

    def test_it_is_a_schema_and_up_to_date(self):
        jsonschema.Draft7Validator.check_schema(self.schema)
        said = rodsweep("schema")
        self.assertEqual(said.returncode, 0)
        self.assertTrue(said.stdout == self.text, "jobs/schema.json is not what the program prints: run `make schema`")

    def test_the_python_package_has_its_constants(self):
        with open(os.path.join(JOBS, "..", "analysis", "rodsweep", "reading", "constants.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file), self.schema["x-files"], "run `make schema`")

    def test_every_job_of_the_project_validates(self):
        jobs = [path for path in glob.glob(os.path.join(JOBS, "**", "*.json"), recursive=True)
                if not path.endswith("schema.json")]
        self.assertGreaterEqual(len(jobs), 4)
        for path in jobs:
            with self.subTest(path=path), open(path, encoding="utf-8") as file:
                self.validator.validate(json.load(file))

    def test_good_jobs_validate_and_are_read(self):
        for name, changes in GOOD.items():
            with self.subTest(name):
                self.assertEqual([error.message for error in self.validator.iter_errors(changed(changes))], [])
        self.assertEqual(self.read(GOOD), set(GOOD))

    def test_bad_jobs_are_refused_by_both(self):
        for name, changes in BAD.items():
            with self.subTest(name):
                self.assertFalse(self.validator.is_valid(changed(changes)))
        self.assertEqual(self.read(BAD), set())

    def test_validate_passes_over_the_schema_among_the_jobs(self):
        said = rodsweep("validate", os.path.join(JOBS, "schema.json"))
        self.assertEqual(said.returncode, 0)
        self.assertIn("a JSON Schema for editors, not a job", said.stdout)


if __name__ == "__main__":
    unittest.main()
