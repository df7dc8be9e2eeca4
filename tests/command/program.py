"""Running the program from tests: RODSWEEP names it. Files are made in the current, empty folder."""

import json
import os
import subprocess

RODSWEEP = os.environ["RODSWEEP"]
ALL_DONE, USER_ERROR, TASKS_FAILED, STOPPED, OUTPUT_LOST = 0, 2, 3, 4, 7

ROD = {"type": "bending_rod", "segments": {"grid": [5, 8]}, "length_m": {"uniform": [1, 5]}, "radius_m": 0.05,
       "density_kg_m3": 1000, "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]}, "torsion_modulus_pa": 1e6}
JOB = {"name": "small", "kind": "sweep", "seed": 3, "samples": 2, "scene": ROD,
       "time": {"step_s": 0.02, "steps": 6, "newton_iterations": 3}, "solve": {"method": "cg", "tolerance": 1e-2},
       "guesses": ["zero", "previous", {"oracle": {"error": 0.1, "label": "oracle 0.1"}}]}

DATA = {"kind": "dataset", "solve": None, "guesses": None}  # the changes that make it a data set


def rodsweep(*words, **options):
    """Runs to the end: the completed process with its texts, unless `options` send them elsewhere."""
    return subprocess.run([RODSWEEP, *map(str, words)], stdin=subprocess.DEVNULL, text=True, timeout=60,
                          **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options})


def sweep(name="small", **changes):
    """Path of the results of JOB with changes; made once. A change to None takes a key away."""
    results = os.path.join("results", name + ".h5")
    if not os.path.exists(results):
        os.makedirs("jobs", exist_ok=True)
        job = os.path.join("jobs", name + ".json")
        with open(job, "w", encoding="utf-8") as file:
            values = {**JOB, "name": name, **changes}
            json.dump({key: value for key, value in values.items() if value is not None}, file)
        ran = rodsweep("run", job)
        assert ran.returncode in (ALL_DONE, TASKS_FAILED), ran.stderr
    return results
