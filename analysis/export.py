#!/usr/bin/python3
"""A sweep as tidy comma-separated values or Parquet, for R, pandas, DuckDB or a spreadsheet.

  tasks   a row per task, guess and tolerance: sums of iterations, ratios, outcome (default)
  solves  a row per linear solve and guess: iterations to every tolerance, residuals, times
  steps   a row per time step: length drift, joint gap, energies, momenta

The first columns identify the task and have the parameters that the job sweeps. Incomplete tasks are left out; failed
ones have their outcome. A value that was not measured or not reached is an empty field (null in Parquet). CSV is
written block by block, so memory use does not grow with the file. Parquet needs pyarrow and memory for all its rows.
A terminal shows only the first rows; a file (-o) and a pipe get all.
"""

import contextlib
import gzip
import itertools
import sys

import numpy as np

from rodsweep.reading import commandline, conditions, tidy
from rodsweep.reading.errors import UserError
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.results import frame
from rodsweep.writing import outputs, tables

EXAMPLES = """examples:
  analysis/export.py results/demo.h5 -o demo.csv
  analysis/export.py results/demo.h5 --level solves --where newton=0 --where guess=quadratic -o demo-solves.csv.gz
  analysis/export.py results/demo.h5 --level solves --tolerance 1e-2 -o demo-solves.parquet
  analysis/export.py results/long_term_learned.h5 --level steps --columns task,sample,time_s,length_drift --where 'time_s>=100'
  analysis/export.py results/demo.h5 --level steps --list"""

ON_TERMINAL = 20    # rows


def arguments():
    made = commandline.parser(__doc__, EXAMPLES, tolerances="all", newton=False)
    made.add_argument("-o", "--output", metavar="FILE", help="file to write (default: standard output); Parquet if its "
                                                             "name ends in .parquet, compressed CSV if in .gz")
    made.add_argument("--level", choices=tidy.LEVELS, default="tasks", help="content of a row (default: tasks)")
    made.add_argument("--columns", metavar="NAME,…", help="columns to write, in this order (default: all measured "
                                                          "ones and the swept parameters)")
    made.add_argument("--where", metavar="CONDITION", action="append", default=[],
                      help=f"only rows that meet the condition: any column, {conditions.FORM}; may be repeated")
    made.add_argument("--list", action="store_true", help="print the names of the columns and exit")
    outputs.add_force(made)
    made.set_defaults(tolerance="all")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        tidy.require_rows(file, options.level)
        guesses = commandline.chosen_guesses(file, options)
        chosen = commandline.chosen_tasks(file, options) & file.complete & commandline.advanced_by(file, guesses)
        table = tidy.Tidy(file, options.level, np.flatnonzero(chosen), guesses,
                          commandline.chosen_tolerances(file, options))
        if options.list:
            print("\n".join(table.names))
            return
        names = [name.strip() for name in options.columns.split(",")] if options.columns else table.default_names()
        table.check(names)
        if len(set(names)) < len(names):
            raise UserError(f"--columns {options.columns}: a column is named twice")
        blocks = table.blocks(names, [table.condition(text) for text in options.where])
        frames = itertools.chain([frame(table, names, [])], (frame(table, names, [block]) for block in blocks))
        if options.output is None and at_terminal():
            frames = Beginning(frames)
        with opened(options) as out:
            write = tables.write_parquet if (options.output or "").endswith(".parquet") else tables.write_csv
            count = write(out, frames)
        if options.output:
            print(f"{count} rows: {options.output}")
        elif isinstance(frames, Beginning) and frames.count > count:
            print(f"the first {count} of {frames.count} rows; -o FILE writes all", file=sys.stderr)


class Beginning:
    """The first rows of frames; `count` is the number of all rows after the last frame."""

    def __init__(self, frames):
        self.frames, self.count = frames, 0

    def __iter__(self):
        for some in self.frames:
            yield some.head(max(0, ON_TERMINAL - self.count))
            self.count += len(some)


def at_terminal():
    return sys.stdout.isatty()


@contextlib.contextmanager
def opened(options):
    """The output as a binary stream. A file gets its name when it is complete. Raises SweepFileError if it exists."""
    path = options.output
    if path is None:
        yield sys.stdout.buffer
        return
    outputs.check(path, options)
    with outputs.whole(path) as part, open(part, "wb") as raw, \
            gzip.GzipFile("", "wb", 6, raw, 0) if path.endswith(".gz") else contextlib.nullcontext(raw) as packed:
        yield packed


if __name__ == "__main__":
    commandline.run(main)
