#!/usr/bin/python3
"""Linear systems to try a guess or a preconditioner on outside of rodsweep: those of jobs/benchmark.json.

Writes into a folder:

  SCENE-JOINTS-tuning-K.h5, SCENE-JOINTS-test-K.h5   A, b, x and poses of each first Newton iteration of a simulation,
                                                     for rodsweep.systems()
  reference.csv    iterations of CG to each tolerance with every preconditioner and guess, and products with A before the
                   first one: sums over the systems of each file
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
first Newton iteration of each. Made with rodsweep {revision}; every file has its job in the attribute `job`. MIT
licence.{failed}

- `SCENE-JOINTS-tuning-K.h5` to choose settings and to train on, `SCENE-JOINTS-test-K.h5` to report. Both have the
  solutions x, since a guess may use those of all earlier systems of its file, as in a simulation. So nothing is hidden:
  do not train on test files.
- In h5py a system k has `blocks[k]`, `b[k]`, `x[k]`, and before the solve `lambda[k]`, `position_m[k]`, `orientation[k]`;
  all are in the group `rods/0`, with the constants of the rod. A is
  `scipy.sparse.bsr_matrix((blocks[k], columns, row_begin))`. The Python package of rodsweep reads all this with
  `rodsweep.systems(FILE)`.
- `reference.csv` has sums over the systems of a file, for each preconditioner and guess: `start_products`, the products
  with A before the first iteration (those of the guess, and one for the residual of a non-zero guess), and the
  iterations of CG until ||b - A x|| is each tolerance times ||b||. Their sum is all products.

With the package, this scores a guess on the test files with the preconditioner jacobi, in seconds:

```python
import rodsweep

class Guess:
    def __init__(self, rods, options):
        self.last = None

    def propose(self, system):          # x0, or (x0, n) after n products with A; None: zero
        return self.last

    def accept(self, system, x):        # the solution of this system
        self.last = x

rows = rodsweep.benchmark(Guess, ".")   # reference.csv, and the guess as "own"
print(rows.pivot(index="systems", columns="guess", values="0.01").to_string())
```

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
    iterations, products = (file.h5[f"/tasks/{name}_sum"][:] for name in ("iterations", "matvecs"))
    start = (products - iterations)[..., 0]    # the same for every tolerance
    rows = [["systems", "preconditioner", "guess", "start_products", *(f"{tolerance:g}" for tolerance in file.tolerances)]]
    for task in np.flatnonzero(file.ok):
        for g, guess in enumerate(file.guesses):
            rows.append([names[task], file.parameter(PRECONDITIONER).values[task], guess, start[task, g],
                         *iterations[task, g]])
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
