#!/usr/bin/python3
"""Linear systems to try a guess or a preconditioner on outside of rodsweep: those of jobs/benchmark.json.

Writes into a folder:

  SCENE-JOINTS-tuning-K.h5, SCENE-JOINTS-test-K.h5   A, b, x and poses of each first Newton iteration of a simulation,
                                                     for rodsweep.systems()
  reference.csv    iterations of CG to each tolerance with every preconditioner and guess, sum and systems by simulation
  README.md        what is in it
  SHA256SUMS       checksums of all files

Files that are there are kept, so a stopped run goes on. `make benchmark-data` runs the job first.
"""

import argparse
import csv
import hashlib
import io
import os

import numpy as np
from rodsweep import program
from rodsweep.reading import commandline
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.reading.systems import Systems
from rodsweep.writing import outputs

EXAMPLES = """examples:
  rodsweep run jobs/benchmark.json -n 2
  analysis/benchmark_data.py results/benchmark.h5 -o benchmark"""
PRECONDITIONER, TUNING = "solve.preconditioner", 2      # samples for tuning
CARD = """# Linear systems of Cosserat rods
{systems} systems A x = b of {simulations} simulations: bending rods, helices, trees, nets and lattices, steps of 0.02 s, the
first Newton iteration of each. Made by `make benchmark-data` of rodsweep ({revision}), jobs/benchmark.json. MIT licence.

- `SCENE-JOINTS-tuning-K.h5` to choose settings and to train on, `SCENE-JOINTS-test-K.h5` to report.
- `rodsweep.systems(FILE)` in Python has A as a scipy matrix of 6x6 blocks, b, the solution x, the poses and constants of
  the rod (docs/python.md). `rodsweep-matrices` writes Matrix Market, PETSc and NumPy files.
- A guess may use all earlier systems of its file and their x, as in a simulation.
- `reference.csv`: for each file, preconditioner, guess and tolerance of ||b - A x|| relative to ||b|| the sum of CG's
  iterations over its systems. Products with A that the guess itself takes are not in it.
- `rodsweep run` measures a guess in Python on the same systems, with times (docs/own-guess.md).

{rows}
"""


def arguments():
    made = argparse.ArgumentParser(description=__doc__, epilog=commandline.examples(EXAMPLES),
                                   formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("file", metavar="FILE", help="results of jobs/benchmark.json")
    made.add_argument("-o", "--output", metavar="FOLDER", required=True, help="folder for the files")
    return made.parse_args()


def stems(file):
    """The name of each task's file, without its ending."""
    joints = file.h5["/tasks/joints"][:]
    return [f"{scene}-{count}-" + (f"tuning-{sample}" if sample < TUNING else f"test-{sample - TUNING}")
            for scene, count, sample in zip(file.scene_types(), joints, file.sample)]


def reference(file, names):
    """Rows of reference.csv."""
    iterations, tolerances = file.h5["/tasks/iterations_sum"][:], file.tolerances
    rows = [["systems", "preconditioner", "guess", *(f"{tolerance:g}" for tolerance in tolerances)]]
    for task in np.flatnonzero(file.ok):
        for g, guess in enumerate(file.guesses):
            rows.append([names[task], file.parameter(PRECONDITIONER).values[task], guess, *iterations[task, g]])
    return rows


def checksum(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def main():
    options = arguments()
    os.makedirs(options.output, exist_ok=True)
    with SweepFile(options.file) as file:
        names, revision = stems(file), file.runs()[-1]["revision"]
        first = file.parameter(PRECONDITIONER).values == "jacobi"
        tasks = {names[task]: int(task) for task in np.flatnonzero(first & file.ok)}
        rows = reference(file, names)
    for name, task in tasks.items():
        path = os.path.join(options.output, f"{name}.h5")
        if not os.path.exists(path):
            program.call("systems", options.file, str(task), "--every", "1", "--first", "-o", path, renamed={})
        print(path)
    table = io.StringIO()
    csv.writer(table, lineterminator="\n").writerows(rows)
    outputs.write(os.path.join(options.output, "reference.csv"), table.getvalue())
    outputs.write(os.path.join(options.output, "README.md"), card(options.output, tasks, revision))
    sums = "".join(f"{checksum(os.path.join(options.output, name))}  {name}\n"
                   for name in sorted(os.listdir(options.output)) if name != "SHA256SUMS")
    outputs.write(os.path.join(options.output, "SHA256SUMS"), sums)


def card(folder, tasks, revision):
    counts = {}
    for name in tasks:
        with Systems(os.path.join(folder, f"{name}.h5")) as systems:
            of = counts.setdefault(name.rsplit("-", 2)[0], [0, 0])
            of[0], of[1] = of[0] + 1, of[1] + len(systems)
    rows = ["| scene and joints | files | systems |", "|---|---|---|"]
    rows += [f"| {name} | {files} | {systems} |" for name, (files, systems) in counts.items()]
    return CARD.format(systems=sum(of[1] for of in counts.values()), simulations=len(tasks), revision=revision,
                       rows="\n".join(rows))


if __name__ == "__main__":
    commandline.run(main)
