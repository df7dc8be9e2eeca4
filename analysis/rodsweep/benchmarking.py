"""CG from a guess of one's own on the systems of analysis/benchmark_data.py, counted as in their reference.csv."""

import glob
import os

import numpy as np

from rodsweep.reading.errors import SweepFileError, library
from rodsweep.reading.systems import Systems

PRECONDITIONER = "jacobi"


def benchmark(guess, folder, part="test"):
    """The rows of reference.csv with the preconditioner jacobi, and those of `guess`, a class as in docs/own-guess.md,
    with the label "own". part: "test" or "tuning" files."""
    pandas = library("pandas")
    paths = sorted(glob.glob(os.path.join(folder, f"*-{part}-*.h5")))
    if not paths:
        raise SweepFileError(f"{folder} has no files *-{part}-*.h5 of benchmark_data.py")
    rows = pandas.read_csv(os.path.join(folder, "reference.csv"))
    names = [os.path.basename(path).removesuffix(".h5") for path in paths]
    rows = rows[(rows.preconditioner == PRECONDITIONER) & rows.systems.isin(names)]
    counted = list(rows.columns[rows.columns.get_loc("guess") + 1:])    # start_products, then tolerances
    own = [[name, PRECONDITIONER, "own", *_counts(guess, path, np.array(counted[1:], dtype=float))]
           for name, path in zip(names, paths)]
    return pandas.concat([rows, pandas.DataFrame(own, columns=rows.columns)], ignore_index=True)


def _counts(guess, path, tolerances):
    """Sums over the systems of a file: products with A before the first iteration, iterations to each tolerance."""
    counts = np.zeros(1 + len(tolerances), dtype=int)
    with Systems(path) as systems:
        made = guess(list(systems.rods.values()), "")
        for system in systems:
            answer = made.propose(system)
            x, products = answer if isinstance(answer, tuple) else (answer, 0)
            x = np.zeros(len(system.b)) if x is None else np.asarray(x, dtype=float).reshape(len(system.b))
            counts += [products + bool(x.any()), *_iterations(system.A, system.b, x, tolerances)]
            if hasattr(made, "accept"):
                made.accept(system, system.x)
    return counts


def _iterations(a, b, x, tolerances):
    """Of CG from x until ||b - A x|| is each tolerance times ||b||."""
    inverse = 1 / a.diagonal()
    r = b - a @ x
    p = z = inverse * r
    rz, done, found = r @ z, 0, []
    for bound in tolerances * np.linalg.norm(b):
        while np.linalg.norm(r) > bound and done < 10 * len(b):    # max_iterations of the program
            q = a @ p
            r = r - rz / (p @ q) * q
            z = inverse * r
            before, rz = rz, r @ z
            p = z + rz / before * p
            done += 1
        found.append(done)
    return found
