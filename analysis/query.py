#!/usr/bin/python3
"""The tasks of a sweep that meet some conditions, as a table, CSV or JSON. Works while the sweep runs.

A condition is COLUMN, one of = != < <= > >= ~ (contains), and a value. = and != take several values, separated by
commas, and for numbers also ranges LOW:HIGH, LOW: or :HIGH, ends included. A task must meet all conditions. A missing
value (a key of another scene, a result of a pending task) meets none. Quote < and > in the shell. Columns are keys of
the job (scene.segments), state (done, pending), outcome, message, counts and ratios of a guess (cg_ratio.LABEL, at
another tolerance cg_ratio.LABEL@1e-4), times (elapsed_s) and more: --columns help lists them.
"""

import csv
import json
import math
import sys

import numpy as np

from rodsweep.reading import commandline, texts
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.reading.task_columns import TaskColumns

EXAMPLES = """examples:
  rodsweep query results/demo.h5                                  every task: what is swept, outcome, CG ratios
  rodsweep query results/demo.h5 state=done 'outcome!=ok' --columns task,outcome,message
  rodsweep query results/demo.h5 scene.type=helix 'scene.segments>=75' --sort cg_ratio.quadratic --limit 5
  rodsweep query results/demo.h5 --csv >tasks.csv
  rodsweep query results/demo.h5 'cg_ratio.previous@1e-4>1' --json | jq '.[].task'

exit codes: 0 the file was read, even if no task was found; 2 an error in the command line or the file, also a condition
on a parameter whose values never meet it"""


def arguments():
    made = commandline.plain_parser(__doc__, EXAMPLES)
    made.add_argument("file", metavar="FILE", help="results file (HDF5)")
    made.add_argument("conditions", metavar="CONDITION", nargs="*", help="condition that the tasks must meet")
    made.add_argument("--where", metavar="CONDITION", action="append", default=[], help="another condition")
    made.add_argument("--columns", metavar="LIST", action="append", default=[],
                      help="columns to show, separated by commas; help: list all columns")
    made.add_argument("--sort", metavar="COLUMN", default="task", help="sort by a column, smallest first")
    made.add_argument("--descending", action="store_true", help="largest first")
    made.add_argument("--limit", metavar="N", type=commandline.whole_number, help="show at most N tasks")
    form = made.add_mutually_exclusive_group()
    form.add_argument("--csv", action="store_true", help="comma-separated values")
    form.add_argument("--json", action="store_true", help="a JSON list of objects")
    return made.parse_intermixed_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        table = TaskColumns(file)
        if options.columns == ["help"]:
            print(columns_text(table))
            return
        tests = [table.condition(text) for text in options.conditions + options.where]
        shown = chosen_columns(table, options.columns) if options.columns else usual_columns(table)
        order = table[options.sort]
        tasks = np.arange(file.task_count)
        for test in tests:
            tasks = tasks[table.met(test)[tasks]]
        found = len(tasks)
        tasks = tasks[ordered(table.values(order)[tasks], options.descending)][:options.limit]
        rows = zip(*(cells(column, table.values(column)[tasks]) for column in shown))
        write([column.name for column in shown], rows, shown, options)
        if not (options.csv or options.json):
            note = f", {len(tasks)} of them shown" if len(tasks) < found else ""
            print(f"{found} of {file.task_count} tasks{note}", file=sys.stderr)


def usual_columns(table):
    """Task number, swept parameters, outcome, penetration and CG ratios. In a closed loop a task has one guess: the
    guess, steps and time replace the ratios."""
    names = ["task", *(c.name for c in table.columns.values() if c.parameter and c.swept)]
    names += ["own_guess"] * table.closed_loop + ["outcome", "penetration"]
    if table.closed_loop:
        names += ["steps_done", "elapsed_s"]
    else:
        names += [f"cg_ratio.{label}" for label in table.file.guesses if label != "zero"]
    return [table[name] for name in names if name in table.columns]


def chosen_columns(table, entries):
    """Each entry is a name, which may hold commas, or a list of names."""
    names = [name for entry in entries
             for name in ([entry] if entry in table.columns else (part.strip() for part in entry.split(",")))]
    return [table[name] for name in names]


def columns_text(table):
    """Every column with its meaning; columns of guesses appear once for all guesses."""
    lines, guesses = [], table.file.guesses
    for column in table.columns.values():
        if not column.guess or column.guess == guesses[0]:
            name = f"{column.name.removesuffix(column.guess)}GUESS" if column.guess else column.name
            lines.append((name + "[@TOLERANCE]" * column.by_tolerance,
                          column.meaning + (f" [{column.unit}]" if column.unit else "")))
    text = "\n".join(texts.aligned(lines, [False, False]))
    if guesses:
        tolerances = table.tolerances()
        text += (f"\n\nGUESS      {', '.join(guesses)}\nTOLERANCE  {', '.join(tolerances)}; "
                 f"without one {tolerances[table.headline]}")
    return text


def ordered(values, descending):
    """Sorted indices; missing values come last in both directions, equal ones keep their order."""
    missing = values == "" if values.dtype.kind == "U" else np.isnan(values.astype(float))
    ranks = np.unique(values, return_inverse=True)[1]
    return np.lexsort((-ranks if descending else ranks, missing))


def cells(column, values):
    """Python values; None if missing."""
    if not column.numeric:
        return [str(value) or None for value in values]
    return [None if value != value else int(value) if column.whole else float(value) for value in values]


def write(names, rows, columns, options):
    if options.json:
        finite = ({name: value if not isinstance(value, float) or math.isfinite(value) else None
                   for name, value in zip(names, row)} for row in rows)
        lines = ",\n".join(json.dumps(row, ensure_ascii=False) for row in finite)
        print(f"[\n{lines}\n]" if lines else "[]")
    elif options.csv:
        out = csv.writer(sys.stdout, lineterminator="\n")
        out.writerow(names)
        out.writerows(rows)    # None: an empty field
    else:
        text = [names, *([table_cell(value) for value in row] for row in rows)]
        print("\n".join(texts.aligned(text, [column.numeric for column in columns])))


def table_cell(value):
    if value is None:
        return "-"
    return f"{value:.6g}" if isinstance(value, float) else " ".join(str(value).split()) or "-"


if __name__ == "__main__":
    commandline.run(main)
