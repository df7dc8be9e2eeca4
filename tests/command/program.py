"""Runs the program from tests: RODSWEEP is its path. Files are in the current, empty folder."""

import json
import os
import shutil
import subprocess
import tempfile
import unittest

import h5py

RODSWEEP = os.environ["RODSWEEP"]
ALL_DONE, USER_ERROR, TASKS_FAILED, STOPPED, OUTPUT_LOST, DIFFER, DAMAGED = 0, 2, 3, 4, 7, 8, 10

ROD = {"type": "bending_rod", "segments": {"grid": [5, 8]}, "length_m": {"uniform": [1, 5]}, "radius_m": 0.05,
       "density_kg_m3": 1000, "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]}, "torsion_modulus_pa": 1e6}
JOB = {"name": "small", "kind": "sweep", "seed": 3, "samples": 2, "scene": ROD,
       "time": {"step_s": 0.02, "steps": 6, "newton_iterations": 3}, "solve": {"method": "cg", "tolerance": 1e-2},
       "guesses": ["zero", "previous", {"oracle": {"error": 0.1, "label": "oracle 0.1"}}]}

DATA = {"kind": "dataset", "solve": None, "guesses": None}  # changes that turn JOB into a data set


def rodsweep(*words, **options):
    """Runs the program to its end; returns the completed process, with its output unless `options` redirect it."""
    return subprocess.run([RODSWEEP, *map(str, words)], stdin=subprocess.DEVNULL, text=True, timeout=600,
                          **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options})


def write_job(name, **changes):
    """Writes JOB with changes to jobs/; returns its path. A change to None removes a key."""
    os.makedirs("jobs", exist_ok=True)
    path = os.path.join("jobs", name + ".json")
    with open(path, "w", encoding="utf-8") as file:
        values = {**JOB, "name": name, **changes}
        json.dump({key: value for key, value in values.items() if value is not None}, file)
    return path


def sweep(name="small", **changes):
    """Path of the results of JOB with changes; run once."""
    results = os.path.join("results", name + ".h5")
    if not os.path.exists(results):
        ran = rodsweep("run", write_job(name, **changes))
        assert ran.returncode in (ALL_DONE, TASKS_FAILED), ran.stderr
    return results


def changed(path, change, name="small"):
    """Writes to `path` a copy of a sweep's file after change(its h5py.File); returns `path`."""
    shutil.copy(sweep(name), path)
    with h5py.File(path, "r+") as h5:
        change(h5)
    return path


class Case(unittest.TestCase):
    def ran(self, *words, code=ALL_DONE, **options):
        """Runs the program, which must exit with this code; returns the completed process."""
        done = rodsweep(*words, **options)
        self.assertEqual(done.returncode, code, f"{done.stdout}\n{done.stderr}")
        return done

    def said(self, *words, **options):
        """The same; returns its standard output."""
        return self.ran(*words, **options).stdout

    def shown(self, *words):
        """The value of the JSON that the program prints."""
        return json.loads(self.said(*words, "--json"))

    def assert_refused(self, words, *texts):
        """The program exits with a user error that contains these words, and prints nothing to standard output."""
        done = rodsweep(*words)
        self.assertEqual((done.returncode, done.stdout), (USER_ERROR, ""), done.stderr)
        for text in texts:
            self.assertIn(text, done.stderr)


class InAFolder(Case):
    """Each test in an empty folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

    def write(self, name, text):
        with open(name, "w", encoding="utf-8") as file:
            file.write(text)

    def job(self, *guesses, **keys):
        """A sweep of one task with these guesses beside zero."""
        job = {"name": "s", "kind": "sweep", "scene": {"type": "bending_rod", "segments": 9, "length_m": 1,
               "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e6},
               "time": {"step_s": 0.02, "steps": 10, "newton_iterations": 2}, "guesses": ["zero", *guesses], **keys}
        self.write("s.json", json.dumps(job))
        return "s.json"
