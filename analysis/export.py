#!/usr/bin/python3
"""A sweep as tidy comma-separated values, for R, pandas or a spreadsheet.

  tasks   a row per task, guess and tolerance: sums of iterations, ratios, outcome (default)
  solves  a row per linear solve and guess: iterations to every tolerance, residuals, times
  steps   a row per time step: length drift, joint gap, energies, momenta

The first columns say which task, with the parameters that the job sweeps. Tasks that are not complete are left out;
those that failed are in it with their outcome. What was not measured or not reached is an empty field. Rows are written
block by block: a file of any size needs little memory.
"""

import contextlib
import csv
import gzip
import io
import sys

import numpy as np

from rodsweep.drawing import outputs
from rodsweep.reading import commandline, tidy
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/export.py results/demo.h5 -o demo.csv
  analysis/export.py results/demo.h5 --level solves --where newton=0 --where guess=quadratic -o demo-solves.csv.gz
  analysis/export.py results/long_term.h5 --level steps --columns task,sample,time_s,length_drift --where time_s=100:200
  analysis/export.py results/demo.h5 --level steps --list"""


def arguments():
    made = commandline.parser(__doc__, EXAMPLES, tolerances="all", newton=False)
    made.add_argument("-o", "--output", metavar="FILE", help="file to write, compressed if its name ends in .gz "
                                                             "(default: standard output)")
    made.add_argument("--level", choices=tidy.LEVELS, default="tasks", help="what a row stands for (default: tasks)")
    made.add_argument("--columns", metavar="NAME,…", help="these columns in this order (default: all measured ones and "
                                                          "the swept parameters)")
    made.add_argument("--where", metavar="COLUMN=VALUE", action="append", default=[],
                      help="only rows with these values of a column, chosen or not: COLUMN=VALUE, COLUMN=A,B or "
                           "COLUMN=LOW:HIGH; may be repeated")
    made.add_argument("--list", action="store_true", help="print the names of the columns and stop")
    outputs.add_force(made)
    made.set_defaults(tolerance="all")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        if options.level != "tasks" and not any(name in file.h5.get(f"/{options.level}", {}) and
                                                file.has(f"/{options.level}/{name}") for name in ("newton", "time_s")):
            raise KeyNotFound(f"{file.path} has no rows of {options.level} (/{options.level} is empty: "
                              "record.solves of the job is \"summary\", or it has none)")
        chosen = commandline.chosen_tasks(file, options) & file.complete
        table = tidy.Tidy(file, options.level, np.flatnonzero(chosen), commandline.chosen_guesses(file, options),
                          commandline.chosen_tolerances(file, options))
        if options.list:
            print("\n".join(table.names))
            return
        names = [name.strip() for name in options.columns.split(",")] if options.columns else table.default_names()
        tests = tidy.conditions(options.where)
        table.check(names + [column for column, _ in tests])
        with opened(options) as out:
            count = write(out, table, names, tests)
        if options.output:
            print(f"{count} rows: {options.output}")


@contextlib.contextmanager
def opened(options):
    """The output as text; the file appears under its name when it is whole. SweepFileError rather than replace one."""
    path = options.output
    if path is None:
        yield sys.stdout
        return
    outputs.check(path, options)
    with outputs.whole(path) as part, open(part, "wb") as raw, \
            gzip.GzipFile("", "wb", 6, raw, 0) if path.endswith(".gz") else contextlib.nullcontext(raw) as packed, \
            io.TextIOWrapper(packed, encoding="utf-8", newline="") as text:
        yield text


def write(out, table, names, tests):
    """All rows that pass the tests; returns how many."""
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(names)
    needed, count = list(dict.fromkeys(names + [column for column, _ in tests])), 0
    for block in table.blocks(needed):
        kept = np.ones(len(block[needed[0]]), dtype=bool)
        for column, test in tests:
            kept &= test(block[column])
        if kept.any():
            writer.writerows(zip(*(tidy.text_of(block[name][kept]) for name in names)))
            count += int(kept.sum())
    return count


if __name__ == "__main__":
    commandline.run(main)
