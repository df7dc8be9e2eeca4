#!/usr/bin/python3
"""Linear systems to try a guess or a preconditioner on outside of rodsweep: those of jobs/benchmark.json.

Writes into a folder:

  SCENE-JOINTS-tuning-K.h5, SCENE-JOINTS-test-K.h5   A, b, x and poses of each first Newton iteration of a simulation,
                                                     for rodsweep.systems()
  reference.csv    iterations of CG to each tolerance with every preconditioner and guess, sum and systems by simulation
  README.md        what is in it
  SHA256SUMS       checksums of all files

Files that are there are kept, so a stopped run goes on. All tasks of the job must be done; `jobs/studies.py benchmark` runs
it first. The card names failed tasks.
"""

import csv
import hashlib
import io
import os

import numpy as np
from rodsweep import program
from rodsweep.reading import commandline, measures, remarks
from rodsweep.reading.errors import SweepFileError
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.reading.systems import Systems
from rodsweep.writing import outputs

EXAMPLES = """examples:
  rodsweep run jobs/benchmark.json -n 2
  analysis/benchmark_data.py results/benchmark.h5 -o benchmark"""
PRECONDITIONER, TUNING = "solve.preconditioner", 2      # samples for tuning
CARD = """# Linear systems of Cosserat rods
{systems} systems A x = b of {simulations} simulations: {scenes}, steps of {step_s} s, the
first Newton iteration of each. Made by `jobs/studies.py benchmark` of rodsweep ({revision}), jobs/benchmark.json. MIT
licence.{failed}

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
    made = commandline.plain_parser(__doc__, EXAMPLES)
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
    with SweepFile(options.file) as file:
        if not file.complete.all():
            counts = measures.census(file, np.ones(file.task_count, dtype=bool)).text()
            raise SweepFileError(f"{file.path} is not finished ({counts}): continue its run with --resume")
        names, tasks = stems(file), {}
        for task in np.flatnonzero(file.ok):    # all preconditioners solve the same systems
            tasks.setdefault(names[task], int(task))
        rows, said = reference(file, names), about(file, names, tasks)
    os.makedirs(options.output, exist_ok=True)
    for name, task in tasks.items():
        path = os.path.join(options.output, f"{name}.h5")
        if not os.path.exists(path):
            program.call("systems", options.file, str(task), "--every", "1", "--first", "-o", path, renamed={})
        print(path)
    table = io.StringIO()
    csv.writer(table, lineterminator="\n").writerows(rows)
    outputs.write(os.path.join(options.output, "reference.csv"), table.getvalue())
    outputs.write(os.path.join(options.output, "README.md"), card(options.output, tasks, said))
    sums = "".join(f"{checksum(os.path.join(options.output, name))}  {name}\n"
                   for name in sorted(os.listdir(options.output)) if name != "SHA256SUMS")
    outputs.write(os.path.join(options.output, "SHA256SUMS"), sums)


def about(file, names, tasks):
    """What CARD says of a results file, by field."""
    scenes = dict.fromkeys(str(file.scene_types()[task]).replace("_", " ") for task in tasks.values())
    failed = [f"{names[task]} with {file.parameter(PRECONDITIONER).text(task)} ({file.outcome[task]})"
              for task in np.flatnonzero(~file.ok)]
    left_out = f" {len(failed)} of {len(names)} tasks failed and are left out: {', '.join(failed)}." if failed else ""
    return {"scenes": ", ".join(scenes), "revision": file.runs()[-1]["revision"], "failed": left_out,
            "step_s": remarks.conditions(file, list(tasks.values()))["step_s"]}


def card(folder, tasks, said):
    counts = {}
    for name in tasks:
        with Systems(os.path.join(folder, f"{name}.h5")) as systems:
            of = counts.setdefault(name.rsplit("-", 2)[0], [0, 0])
            of[0], of[1] = of[0] + 1, of[1] + len(systems)
    rows = ["| scene and joints | files | systems |", "|---|---|---|"]
    rows += [f"| {name} | {files} | {systems} |" for name, (files, systems) in counts.items()]
    return CARD.format(systems=sum(of[1] for of in counts.values()), simulations=len(tasks), rows="\n".join(rows),
                       **said)


if __name__ == "__main__":
    commandline.run(main)
