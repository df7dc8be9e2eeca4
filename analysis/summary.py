#!/usr/bin/python3
"""Tables of a sweep: CG ratios with confidence intervals, three speedups, and results of the time steps.

  CG ratio   CG iterations over those from the zero guess, summed over a simulation, mean over simulations; also in
             products with A (with those of the guess), over all Newton iterations, and both
  speedups   time of zero-guess CG (and of the direct solve) over the time with a guess, at the job's tolerance:
             CG only, guess and CG, whole step; sums over a simulation, median over simulations
  steps      Newton iterations, largest length drift, joint gap, penetration and contact residual, over all steps

Each scene type and each value of a grid outside `scene` has a block; --by KEY splits the blocks further. Intervals are
95 % bootstrap intervals over simulations.
"""

import json
import math
import os
import shutil
import sys
import textwrap

from rodsweep.reading import blocks, commandline, groups, measures, remarks, texts, timings, unconverged
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/summary.py results/demo.h5
  analysis/summary.py results/demo.h5 --by scene.segments --scene helix --newton all
  analysis/summary.py results/demo.h5 --csv > demo.csv"""
FAILURES_SHOWN = 5
TITLE_WIDTH = 32
LINE_WIDTH = 120    # of prose where there is no terminal
BESIDE = {"products": "products", "all": "all j", "all_products": "both"}
BESIDE_MEANING = {"products": "products with A, with those of the guess, instead of iterations",
                  "all": "iterations of all Newton iterations", "all_products": "products of all Newton iterations"}


def arguments():
    made = commandline.parser(__doc__, EXAMPLES)
    made.add_argument("--by", metavar="KEY", help="a block for every value of this parameter, e.g. scene.segments")
    kind = made.add_mutually_exclusive_group()
    kind.add_argument("--csv", action="store_true", help="comma-separated values, a line per number")
    kind.add_argument("--json", action="store_true", help="the same numbers as JSON")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        chosen = commandline.chosen_tasks(file, options)
        tolerances = commandline.chosen_tolerances(file, options)
        guesses = commandline.chosen_guesses(file, options)
        census = measures.census(file, chosen)
        sims = measures.simulations(file, chosen)
        if options.by:
            file.parameter(options.by)
            sims = sims.subset(groups.applicable(file, sims, options.by, without=True)) if len(sims) else sims
        found = blocks.blocks(file, sims, options.by, options.newton)
        if options.csv or options.json:
            records = [r for block in found for r in blocks.records(file, block, guesses, tolerances, options.newton)]
            (write_csv if options.csv else write_json)(file, sims, census, records)
        else:
            lines = heading(file, sims, chosen, census)
            lines += ratio_lines(file, found, guesses, tolerances, options.newton)
            lines += speedup_lines(file, sims, found, guesses, options.newton)
            lines += direct_lines(file, sims, found)
            lines += step_lines(file, found, guesses)
            print("\n".join(lines))


def heading(file, sims, chosen, census):
    job, revisions = file.job(), remarks.revisions(file)
    name = f"job {job['name']}" if "name" in job else "job"
    seed = f", seed {job['seed']}" if "seed" in job else ""
    lines = [f"{file.path}: {name}{seed}" + (f", revision {revisions}" if revisions else ""),
             census.text() + ("; failed tasks are left out of all numbers" if census.failed else "")]
    failed, more = measures.failures(file, chosen, FAILURES_SHOWN)
    lines += [f"  task {task}: {outcome}" + (f": {message}" if message else "") for task, outcome, message in failed]
    lines += [f"  and {more} more"] * (more > 0)
    if not len(sims):
        return lines + ["No simulation is complete yet."]
    said = remarks.conditions(file, sims.tasks())
    solver = (f"{said['evaluation']} evaluation; preconditioner {said['preconditioner']}; residual test: {said['norm']}"
              if said["evaluation"] else "advanced by the direct solve, no guesses")
    return lines + _wrapped(f"{solver}; time step {said['step_s']} s") + _unconverged(file, sims)


def _unconverged(file, sims):
    said = (of(file, sims.tasks()) for of in (unconverged.missed_text, unconverged.newton_text))
    return [line for text in said if text for line in _wrapped(f"WARNING: {text}")]


def _wrapped(text):
    """Lines of prose; tables and what docs/tools/pages.py looks for keep their lines."""
    return textwrap.wrap(text, shutil.get_terminal_size((LINE_WIDTH, 0)).columns, break_long_words=False,
                         break_on_hyphens=False)


def ratio_lines(file, found, guesses, tolerances, newton):
    shown = [block for block in found if block.ratio is not None]
    if not shown:
        missing = file.guesses and file.zero is None and len(found)
        return ["", "No CG ratios: the job has no zero guess."] if missing else []
    lines = ["", f"CG ratio, {measures.NEWTON[newton]}: iterations over those from zero; "
                 "mean over simulations [95 % interval]"]
    beside = [name for name in BESIDE if any(name in (block.beside or {}) for block in shown)]
    if beside:
        lines += _wrapped("Rows below \"the same, means\": this ratio counted otherwise. " +
                          "; ".join(f"{BESIDE[name]}: {BESIDE_MEANING[name]}" for name in beside))
    for block in shown:
        title, first = _titled(block, block.ratio.count[guesses])
        rows = [[first] + [texts.tolerance_label(file.tolerances[t]) for t in tolerances]]
        for g in [g for g in guesses if g != file.zero]:
            marks = ["*" if block.unreached[g, t] or block.unreached[file.zero, t] else "" for t in tolerances]
            rows.append(["  " + file.guesses[g]] +
                        [texts.interval_text(block.ratio[g, t]) + mark for t, mark in zip(tolerances, marks)])
        if block.zero_iterations is not None:
            rows.append(["  zero, iterations/solve"] + [f"{block.zero_iterations[t]:.1f}" for t in tolerances])
        lines += [""] + title + texts.aligned(rows)
        lines += _missed(file, block, guesses, tolerances)
        lines += texts.aligned(_beside(file, block, guesses, tolerances)) if block.beside else []
    return lines


def _beside(file, block, guesses, tolerances):
    """Means of the further ratios (Block.beside)."""
    rows = [["  the same, means"] +
            [f"{texts.tolerance_label(file.tolerances[t])} {BESIDE[name]}" for t in tolerances for name in block.beside]]
    return rows + [["  " + file.guesses[g]] + [texts.fixed_text(block.beside[name].value[g, t], 2)
                                               for t in tolerances for name in block.beside]
                   for g in guesses if g != file.zero]


def _missed(file, block, guesses, tolerances):
    found = []
    for t in tolerances:
        counts = [f"{file.guesses[g]} {int(block.unreached[g, t])}" for g in sorted({*guesses, file.zero})
                  if block.unreached[g, t]]
        if counts:
            found.append(f"      at {texts.tolerance_label(file.tolerances[t])}: " + ", ".join(counts))
    return ["  * some solves missed the tolerance; the iterations that they used are counted:"] + found if found else []


def speedup_lines(file, sims, found, guesses, newton):
    shown = [block for block in found if block.times is not None]
    if not shown:
        untimed = any(block.ratio is not None for block in found)
        return ["", 'No times: the file has no rows of single solves (record.solves is "summary").'] if untimed else []
    lines = ["", f"Time per solve and speedup over zero-guess CG, {measures.NEWTON[newton]}; whole step: all.",
             f"Solved to tolerance {remarks.solve_tolerance(file, sims.tasks())}; median over simulations [95 % interval]"]
    lines += _warning(file, sims)
    lines += filter(None, [remarks.oracle_note(file, guesses).strip()])
    names = list(timings.SPEEDUPS)
    for block in shown:
        title, first = _titled(block, block.times["cg_us"].count[guesses])
        rows = [[first, "guess µs", "solve µs"] + [timings.SPEEDUPS[name] for name in names]]
        for g in guesses:
            timed = math.isfinite(block.times["cg_us"].value[g])
            over_zero = ["1" if g == file.zero and timed else
                         texts.interval_text(block.speedup[name][g]) if block.speedup else "-" for name in names]
            rows.append(["  " + file.guesses[g], texts.fixed_text(block.times["guess_us"].value[g], 2),
                         texts.fixed_text(block.times["cg_us"].value[g], 1)] + over_zero)
        if block.direct_speedup and math.isfinite(block.times["direct_us"].value[file.zero]):
            rows.append(["  direct", "-", texts.fixed_text(block.times["direct_us"].value[file.zero], 1)] +
                        [texts.interval_text(block.direct_speedup[name]) for name in names])
        lines += [""] + title + texts.aligned(rows)
        lines += [f"  {block.interruptions}"] if block.interruptions else []
    return lines


def direct_lines(file, sims, found):
    """Times of simulations without guesses."""
    shown = [block for block in found if block.direct_times]
    if not shown:
        return []
    rows = [["Direct solve: median over simulations [95 % interval]", "assembly µs", "solve µs"]]
    for block in shown:
        rows.append([f"  {block.title}, {texts.simulations_text(block.direct_times['direct_us'].count)}"] +
                    [texts.interval_text(block.direct_times[name]) for name in ("assemble_us", "direct_us")])
    return ["", *_warning(file, sims), *texts.aligned(rows)]


def _warning(file, sims):
    warning = remarks.timing_warning(file, sims.tasks())
    return [f"WARNING: {warning}"] if warning else []


def step_lines(file, found, guesses):
    shown = blocks.step_measures(found)
    if not shown:
        return []
    rows = [["Steps: median over simulations (largest)"] + [measure.column for measure in shown.values()]]
    for title, numbers in blocks.step_rows(found, guesses, file.guesses):
        rows.append([f"  {title}"] + ["{} ({})".format(*numbers[name]) if name in numbers else "-" for name in shown])
    return [""] + texts.aligned(rows)


def _titled(block, counts):
    """A block's title: in the first cell of its table, or on a line before the table if it is long."""
    title = f"{block.title}, {texts.simulations_text(counts)}"
    return ([], title) if len(title) <= TITLE_WIDTH else ([title], "")


def solves(file, sims):
    return {name: int(unconverged.solves(file, name)[sims.tasks()].sum()) for name in ("timed", "missed")}


def write_csv(file, sims, census, records):
    """The first lines count the tasks, and the solves to the job's tolerance."""
    counts = {"tasks": census.total, "tasks_ok": census.ok, "tasks_pending": census.pending,
              **{f"tasks_{outcome}": count for outcome, count in sorted(census.failed.items())},
              "tasks_timed_oversubscribed": int(bool(remarks.timing_warning(file, sims.tasks()))),
              **{f"solves_{name}": count for name, count in solves(file, sims).items()}}
    texts.write_csv(sys.stdout, blocks.COLUMNS,
                    [{"quantity": name, "value": count} for name, count in counts.items()] + records)


def write_json(file, sims, census, records):
    numbers = [{key: None if value != value or value == "" else value for key, value in record.items()}
               for record in records]
    whole = {"file": os.path.basename(file.path), "job": file.job().get("name"),
             "tasks": {"total": census.total, "ok": census.ok, "pending": census.pending, "failed": census.failed},
             "solves": solves(file, sims), "conditions": remarks.conditions(file, sims.tasks()),
             "oversubscribed": bool(remarks.timing_warning(file, sims.tasks())), "numbers": numbers}
    json.dump(whole, sys.stdout, indent=1, ensure_ascii=False)
    print()


if __name__ == "__main__":
    commandline.run(main)
