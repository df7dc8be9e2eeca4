#!/usr/bin/python3
"""Differences between two sweeps, task by task and in the mean.

Two tasks are the same if everything that their results depend on is equal: the keys that apply to them, seed, sample
and, in a closed loop, the guess. So sweeps with other grids, samples or guesses can overlap. If jobs differ in a key
on purpose (a tolerance, a preconditioner), use --by parameters. It matches tasks by their sample and by the keys that
vary within either job, and guesses by their label. Models and data sets are identified by their path in the job.

The output lists the keys in which the jobs differ, the number of tasks in both, the values that differ, and changed
outcomes. For every guess it has the mean CG ratio in both files and the mean difference of the tasks. Its 95 %
bootstrap interval is over draws of the random parameters ("-" for fewer than 5). Times are shown, but do not count as
differences: medians over the tasks, and the median of B / A, the quotient of each task. The table has the first job's
tolerance; --csv and --json have all.
"""

import json
import math
import sys

from rodsweep.reading import commandline, comparison, texts
from rodsweep.reading.errors import KeyNotFound, listed
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.reading.task_columns import TaskColumns

EXAMPLES = """examples:
  rodsweep compare results/before.h5 results/after.h5
  rodsweep compare results/jacobi.h5 results/icc.h5 --by parameters
  rodsweep compare old.h5 new.h5 --tasks --csv >differing.csv

exit codes: 0 all results in both files are bitwise equal; 8 results differ; 10 results are damaged in one of the files;
2 an error in the command line or a file, or no task is done in both"""
DIFFER, DAMAGED = 8, 10
MOST_KEYS, MOST_CHANGES, LONGEST = 20, 10, 60


def arguments():
    made = commandline.plain_parser(__doc__, EXAMPLES)
    made.add_argument("file", metavar="FILE", help="results file (HDF5)")
    made.add_argument("other", metavar="OTHER", help="second results file (HDF5)")
    made.add_argument("--by", choices=comparison.BY, default="everything", help="how to match tasks")
    made.add_argument("--tasks", action="store_true", help="list every task that differs")
    form = made.add_mutually_exclusive_group()
    form.add_argument("--csv", action="store_true", help="comma-separated values")
    form.add_argument("--json", action="store_true", help="one JSON object")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as one, SweepFile(options.other) as other:
        pairs = comparison.match(one, other, options.by)
        found = comparison.Comparison(one, other, pairs)
        keys = comparison.key_differences(one, other)
        if options.json:
            print(json.dumps(as_json(found, pairs, keys, options), indent=2, ensure_ascii=False))
        elif options.csv:
            write_csv(found, options.tasks)
        else:
            print(text(found, pairs, keys, options))
        if not found.compared:
            hint = "; use --by parameters to match tasks of different jobs"
            raise KeyNotFound("no task is done in both files, so nothing was compared" if len(pairs.a) else
                              "no task is in both files, so nothing was compared" +
                              hint * (options.by == "everything"))
    if found.damaged:
        commandline.stop(f"results of {options.file} or {options.other} are damaged: values and checksum of "
                         f"task{'s' * (len(found.damaged) > 1)} {listed([str(task) for task in found.damaged])} contradict "
                         "each other; `rodsweep info FILE --verify` tells in which file", DAMAGED)
    sys.exit(DIFFER if found.differing else 0)


def text(found, pairs, keys, options):
    lines = [f"{letter}  {file.path}: {file.job().get('name', '')}, {int(file.complete.sum())} of {file.task_count} tasks "
             f"done, revision {run_text(file, 'revision')}" for letter, file in (("A", found.one), ("B", found.other))]
    lines += [f"jobs: differ in {len(keys)} key{'s' * (len(keys) != 1)}" if keys else "jobs: the same"]
    lines += [f"  {key}: {value_text(a)} in A, {value_text(b)} in B" for key, a, b in keys[:MOST_KEYS]]
    lines += [f"  and {len(keys) - MOST_KEYS} more: see --json"] * (len(keys) > MOST_KEYS)
    lines += [f"tasks: {len(pairs.a)} in both, {pairs.only_a} in A alone, {pairs.only_b} in B alone", results_line(found)]
    lines += table([["column", "tasks", "values", "largest difference", "in task"],
                    *([c.path, str(c.tasks), str(c.values),
                       "one is missing" if math.isinf(c.largest) else f"{c.largest:.3g}", str(c.task)]
                      for c in found.columns.values())])
    if found.left_out:
        groups = {}
        for path in found.left_out:
            group = "/" + path.split("/")[1]
            groups[group] = groups.get(group, 0) + 1
        lines.append("not compared (missing in one file, of another shape or at other times): " +
                     ", ".join(f"{group} ({count} column{'s' * (count > 1)})" for group, count in groups.items()))
    changed = [place for place in found.differing if outcomes(found, place)[0] != outcomes(found, place)[1]]
    if changed:
        lines.append(f"outcomes: {len(changed)} changed")
        lines += [f"  task {found.a[k]} (of B {found.b[k]}): {outcomes(found, k)[0]} in A, {outcomes(found, k)[1]} in B"
                  for k in changed[:MOST_CHANGES]]
        lines += [f"  and {len(changed) - MOST_CHANGES} more: see --tasks"] * (len(changed) > MOST_CHANGES)
    headline = found.one.tolerances[TaskColumns(found.one).headline] if len(found.one.tolerances) else None
    ratios = [[label, number(a.value), number(b.value), number(d.value, "+.4g"), interval(d), str(int(d.count))]
              for label, tolerance, a, b, d in found.ratios() if tolerance == headline]
    if ratios:
        lines.append(f"CG ratio at {texts.tolerance_label(headline)}, mean of tasks that are ok in both")
        lines += table([["guess", "A", "B", "B - A", "95 %", "tasks"], *ratios])
    times = [[what, duration(a), duration(b), f"{quotient:.3g}", str(tasks)] for what, a, b, quotient, tasks in
             found.times()]
    if times:
        lines += [f"times, medians{times_remark(found)}", *table([["time", "A", "B", "median of B / A", "tasks"], *times])]
    if options.tasks and found.differing:
        lines.append("tasks that differ")
        for place, paths in found.differing.items():
            a, b = outcomes(found, place)
            lines.append(f"  task {found.a[place]} (of B {found.b[place]}):" + f" {a} in A, {b} in B;" * (a != b) +
                         " " + (" ".join(paths) or "no value differs"))
    return "\n".join(lines)


def results_line(found):
    differing = len(found.differing)
    pending = f" ({found.pending} more not done in both)" if found.pending else ""
    return (f"results: {found.compared} compared{pending}, {found.compared - differing} the same to the last bit, "
            f"{differing} differ{'s' * (differing == 1)}")


def outcomes(found, place):
    return str(found.one.outcome[found.a[place]]), str(found.other.outcome[found.b[place]])


def run_text(file, column):
    runs = file.runs()
    return str(runs[-1].get(column, "")) if runs else "unknown"


def oversubscribed(file):
    return any(run.get("oversubscribed") for run in file.runs())


def times_remark(found):
    hosts = [run_text(file, "host") for file in (found.one, found.other)]
    remark = f"; different machines: {hosts[0]} and {hosts[1]}" if hosts[0] != hosts[1] else ""
    if oversubscribed(found.one) or oversubscribed(found.other):
        remark += "; more ranks than cores, so they are not valid"
    return remark


def as_json(found, pairs, keys, options):
    def about(file):
        return {"file": file.path, "job": file.job().get("name", ""), "revision": run_text(file, "revision"),
                "tasks": file.task_count, "done": int(file.complete.sum()), "hosts": run_text(file, "host"),
                "oversubscribed": oversubscribed(file)}

    made = {"a": about(found.one), "b": about(found.other), "by": options.by,
            "keys": [{"key": key, "a": a, "b": b} for key, a, b in keys],
            "tasks": {"both": len(pairs.a), "only_a": pairs.only_a, "only_b": pairs.only_b, "compared": found.compared,
                      "pending": found.pending, "differing": len(found.differing)},
            "columns": [{"column": c.path, "tasks": c.tasks, "values": c.values, "largest": finite(c.largest),
                         "task": c.task} for c in found.columns.values()],
            "damaged": found.damaged, "left_out": found.left_out, "cg_ratio": list(ratio_rows(found)),
            "times": [dict(zip(("time", "a_s", "b_s", "ratio", "tasks"), row)) for row in found.times()]}
    if options.tasks:
        made["differing"] = list(task_rows(found))
    return made


def ratio_rows(found):
    for label, tolerance, a, b, d in found.ratios():
        yield {"guess": label, "tolerance": tolerance, "a": finite(a.value), "b": finite(b.value),
               "difference": finite(d.value), "low": finite(d.low), "high": finite(d.high), "tasks": int(d.count)}


def task_rows(found):
    for place, paths in found.differing.items():
        a, b = outcomes(found, place)
        yield {"task_a": int(found.a[place]), "task_b": int(found.b[place]), "outcome_a": a, "outcome_b": b,
               "columns": " ".join(paths)}


def write_csv(found, tasks):
    names = ("task_a", "task_b", "outcome_a", "outcome_b", "columns") if tasks else \
        ("guess", "tolerance", "a", "b", "difference", "low", "high", "tasks")
    texts.write_csv(sys.stdout, names, task_rows(found) if tasks else ratio_rows(found))


def finite(value):
    return float(value) if math.isfinite(value) else None


def number(value, form=".4g"):
    return f"{float(value):{form}}" if math.isfinite(value) else "-"


def interval(estimate):
    return f"{float(estimate.low):+.4g} to {float(estimate.high):+.4g}" if math.isfinite(estimate.low) else "-"


def duration(seconds):
    scale, unit = (1e6, "us") if seconds < 0.9995e-3 else (1e3, "ms") if seconds < 0.9995 else (1, "s")
    return f"{scale * seconds:.3g} {unit}"


def value_text(value):
    if value is None:
        return "nothing"
    said = json.dumps(value, ensure_ascii=False)
    return said if len(said) <= LONGEST else said[:LONGEST] + "..."


def table(rows):
    """Indented lines; empty for a header row without others."""
    return ["  " + line for line in texts.aligned(rows)] if len(rows) > 1 else []


if __name__ == "__main__":
    commandline.run(main)
