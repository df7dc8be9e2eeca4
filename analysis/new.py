#!/usr/bin/python3
"""Writes a guess or a preconditioner in Python that works, and a job that measures it: a start for one's own.

Of my_guess.py the job is my_guess.json. docs/own-guess.md explains both.
"""

import json
import os
import re

from rodsweep.reading import commandline
from rodsweep.reading.errors import UserError
from rodsweep.writing import outputs

EXAMPLES = """examples:
  rodsweep new guess my_guess.py
  rodsweep run my_guess.json -n 2
  rodsweep summary results/my_guess.h5"""

GUESS = '''\
"""A guess: the mean of the last solutions."""

import numpy as np


class Guess:
    def __init__(self, rods, options):
        """`rods` are those of the simulation, `options` is the text of the job."""
        self.count = int(options or 3)
        self.solutions = {}

    def propose(self, system):
        """x0 for system.A x = system.b; None: zero."""
        known = self.solutions.get((system.rod, system.newton))
        return np.mean(known, axis=0) if known else None

    def accept(self, system, x):
        """`x` is the solution of this system, which was last proposed for."""
        known = self.solutions.setdefault((system.rod, system.newton), [])
        known.append(x)
        del known[:-self.count]
'''

PRECONDITIONER = '''\
"""A preconditioner: the diagonal of A."""


class Preconditioner:
    def __init__(self, rods, options):
        """`rods` has one rod; every rod has its own preconditioner. `options` is the text of the job."""

    def set_up(self, system):
        """Prepares for system.A."""
        self.inverse = 1 / system.A.diagonal()

    def apply(self, r):
        """An approximation of A^-1 r: linear in r, symmetric and positive definite."""
        return self.inverse * r
'''

JOB = {
    "kind": "sweep",
    "seed": 1,
    "samples": 10,
    "evaluation": "paired",
    "scene": {"type": "bending_rod", "segments": {"grid": [20, 50]}, "length_m": {"uniform": [1, 5]}, "radius_m": 0.05,
              "density_kg_m3": 1000, "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]}, "torsion_modulus_pa": 1e6,
              "initial_angle_deg": {"uniform": [0, 45]}},
    "time": {"step_s": 0.02, "steps": 100, "newton_iterations": 6},
}


def arguments():
    made = commandline.plain_parser(__doc__, EXAMPLES)
    made.add_argument("kind", choices=("guess", "preconditioner"))
    made.add_argument("file", metavar="FILE", help="its new file; the name ends in .py")
    return made.parse_args()


def job_of(kind, file):
    """The job beside the file, as a dictionary."""
    stem = os.path.basename(file).removesuffix(".py")
    if kind == "guess":
        own = {"solve": {"method": "cg", "tolerance": 1e-2},
               "guesses": ["zero", "previous", "quadratic", {"subspace": {"size": 10}},
                           {"python": {"file": os.path.basename(file)}}]}
    else:
        own = {"solve": {"method": "cg", "tolerance": 1e-2, "preconditioner": {"grid": ["jacobi", "block_icc", "python"]},
                         "python_preconditioner": {"file": os.path.basename(file)}},
               "guesses": ["zero", "previous"]}
    return {"name": stem, "description": f"Measures the {kind} of {os.path.basename(file)}.", **JOB, **own}


def main():
    options = arguments()
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_-]*\.py", os.path.basename(options.file)):
        raise UserError(f"{options.file} is not allowed: the name must be of letters, digits, - and _, and end in .py")
    job = options.file.removesuffix(".py") + ".json"
    texts = {options.file: GUESS if options.kind == "guess" else PRECONDITIONER,
             job: json.dumps(job_of(options.kind, options.file), indent=2) + "\n"}
    for path in texts:
        if os.path.exists(path):
            raise UserError(f"{path} already exists; give another name")
    for path, text in texts.items():
        outputs.write(path, text)
    print(f"{options.file}\n{job}\nnext: rodsweep run {job} -n 2")


if __name__ == "__main__":
    commandline.run(main)
