#!/usr/bin/python3
"""How to simulate a scene to an accuracy in the least time, and whether a guess helps.

Each NAME_tuning.h5 is a closed-loop sweep over integrators, steps, Newton iterations, methods, preconditioners, tolerances
and guesses. --jobs writes NAME_test.json beside it: the settings that are cheapest there, on other draws. Once
NAME_test.h5 is there, the tables have for every scene and error the wall time of a simulated second with the cheapest of
all settings, of the direct solve, of CG from zero, from a classical and from a learned guess, of CG with a learned
preconditioner, of CG with Jacobi (the setting of Shao et al. 2021), and of Gauss-Seidel. rodsweep/reading/score.py
defines error and time.

With a guess in Python instead of files, FILE.py, the script runs these settings of all scenes
(jobs/score/NAME_test.json, or the jobs that are given) into results/, and with each of CG's this guess too, and shows
its row beside the others'. The others are then the cheapest on these draws. A stopped run goes on.

Times are medians over test draws, of learned settings also over trainings (the models seeds/NAME-2.h5, ... beside
NAME.h5). "÷ cheapest" is the median of the quotients with the cheapest of all, with its 95 % bootstrap interval; of
learned settings that contains the intervals of all trainings. The last table has the time of the trainings. "-": no
setting of this kind reached the error on the tuning draws. An error in parentheses is above its level on the test draws.
"""

import glob
import json
import os
import sys

import numpy as np
import rodsweep
from rodsweep.drawing import layout, study, style
from rodsweep.reading import commandline, intervals, job_paths, modelfile, score, texts
from rodsweep.reading.errors import KeyNotFound, SweepFileError
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.writing import outputs

EXAMPLES = """examples:
  analysis/score.py --jobs results/score/*_tuning.h5      # writes results/score/NAME_test.json
  analysis/score.py results/score/*_tuning.h5             # once these jobs have run
  analysis/score.py my_guess.py jobs/score/net_test.json  # a guess of yours, on nets (docs/own-guess.md)"""
ENDING = "_tuning.h5"
JOBS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "jobs", "score", "*_test.json")


def arguments():
    made = commandline.plain_parser(__doc__, EXAMPLES)
    made.add_argument("files", nargs="+", metavar="FILE",
                      help=f"results of a tuning job, NAME{ENDING}; or a guess in Python and jobs")
    made.add_argument("--jobs", action="store_true",
                      help="write NAME_test.json for each file, into the folder of -o or beside it, and do no more")
    made.add_argument("--inputs", nargs="+", metavar="FILE", default=[],
                      help="other files that the guess reads, such as weights: results of changed ones are not mixed")
    made.add_argument("--workers", type=commandline.whole_number, default=os.cpu_count(), metavar="N",
                      help="cores for a guess of yours (default: all)")
    made.add_argument("--samples", type=commandline.whole_number, default=10, metavar="N",
                      help="draws of the jobs that are written (default: 10)")
    study.add_figure_arguments(made)
    return made.parse_args()


def main():
    options = arguments()
    scenes, models = {}, {}
    if options.files[0].endswith(".py"):
        print("\n".join(table(with_guess(options, options.files[1:] or sorted(glob.glob(JOBS))))))
        return
    for path in options.files:
        if not path.endswith(ENDING):
            raise KeyNotFound(f"{path}: the name of a tuning file ends in {ENDING}")
        with SweepFile(path) as file:
            found, job, labels, source = score.runs(file), file.job(), file.guesses, file.runs()[-1]["job"]
            scene = title(file)
        if options.jobs:
            folder = os.path.dirname(source)
            made = score.test_job(job, labels, score.chosen(found).values(), options.samples, folder)
            test = path.replace(ENDING, "_test.json")
            write_job(os.path.join(options.output, os.path.basename(test)) if options.output else test, made, folder)
        else:
            with SweepFile(path.replace(ENDING, "_test.h5")) as test:
                scenes[scene] = rows_of(score.chosen(found), score.runs(test))
                models |= models_of(test)
    if scenes:
        print("\n".join([*table(scenes), "", *trainings(models)]) + "\n\n")
        folder = options.output or os.path.join(os.path.dirname(options.files[0]), "figures")
        width = int(options.width)
        print("\n".join(figure(scenes, width).save(folder, "score", options.format, not options.no_caption)))


def with_guess(options, jobs):
    """The scenes of these jobs with a guess in Python: {title: rows_of()}, its results in results/."""
    if not jobs:
        raise KeyNotFound(f"there are no jobs {JOBS}: `jobs/studies.py score` writes them, or give some")
    guess, scenes = options.files[0], {}
    entry = {"python": {"file": os.path.abspath(guess)}}
    if options.inputs:
        entry["python"]["inputs"] = [os.path.abspath(path) for path in options.inputs]
    jobs = [rodsweep.Job.read(path) for path in jobs]
    jobs = [job.changed(name=f"{job.name}_{os.path.basename(guess).removesuffix('.py')}",
                        guesses=[*job.values.get("guesses", ["zero"]), entry]) for job in jobs]
    announce([job for job in jobs if not os.path.exists(f"results/{job.name}.h5")])
    for job in jobs:
        with job.run(options.workers) as results:
            found = score.runs(results.file)
            scenes[title(results.file)] = rows_of(score.chosen(found), found)
    return scenes


def announce(jobs):
    plans = [job.plan(probe=False) for job in jobs]
    if plans:
        tasks, size = (sum(plan[name] for plan in plans) for name in ("tasks", "file_bytes"))
        print(f"{len(plans)} new file{'s' * (len(plans) > 1)} in results/ will have {tasks} tasks and take "
              f"{1e-6 * size:,.0f} MB", file=sys.stderr)


def title(file):
    return str(file.scene_types()[0]).replace("_", " ")


def write_job(path, job, folder):
    """`folder` is the one to which the paths of `job` are relative."""
    here = os.path.relpath(folder, os.path.dirname(os.path.abspath(path)))
    moved = job_paths.placed(job, lambda given: os.path.normpath(os.path.join(here, given)))
    text = json.dumps(moved, indent=1) + "\n"
    if os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            if file.read() != text:
                raise SweepFileError(f"{path} exists and has other settings: remove it and its results, or rename the "
                                     "tuning file")
    outputs.write(path, text)
    print(path)


def rows_of(chosen, runs):
    """{(level, answer): (Setting, its Runs by training, Estimate of their time over that of the cheapest)}"""
    made = {}
    for (level, answer), setting in chosen.items():
        best = chosen[level, score.ALL]
        of = score.trainings(setting, runs)
        if of and best in runs:
            made[level, answer] = setting, of, score.factor(of, runs[best])
    return made


def models_of(file):
    """{name: path} of a job's models."""
    folder = os.path.dirname(file.runs()[-1]["job"])
    return {os.path.basename(path).removesuffix(".h5"): os.path.join(folder, path)
            for path in job_paths.given(file.job(), ("model",))}


def trainings(models):
    rows = [["model", "minutes of training", "epochs"]]
    for name, path in sorted(models.items()):
        if os.path.exists(path):
            of = modelfile.read(path)
            rows.append([name, texts.short_text(of.seconds / 60, 2), str(len(of.epochs))])
    return texts.aligned(rows) if len(rows) > 1 else []


def answers(scenes):
    """Those to show: that of a guess of the user's only if there is one."""
    own = any(answer == score.OWN for found in scenes.values() for _, answer in found)
    return [answer for answer in score.ANSWERS if own or answer != score.OWN]


def table(scenes):
    lines = []
    for scene, found in scenes.items():
        for level in score.LEVELS:
            if not any(of == level for of, _ in found):
                lines += [f"{scene}, error {100 * level:g} %: reached by no setting on the tuning draws", ""]
                continue
            rows = [[f"{scene}, error {100 * level:g} %", "ms/s", "÷ cheapest", "95 %", "products/s", "error there", "setting"]]
            rows += [[answer, *cells(found.get((level, answer)), level)] for answer in answers(scenes)]
            lines += [*texts.aligned(rows), ""]
    return lines[:-1]


def cells(entry, level):
    if not entry:
        return ["-"] * 6
    setting, of, factor = entry
    time_s, products, error = (np.median([np.median(getattr(runs, name)) for runs in of])
                               for name in ("time_s", "products", "error"))
    failed = sum(np.count_nonzero(~np.isfinite(runs.error)) for runs in of)
    if failed:
        error, said = np.inf, f"{failed} of {sum(len(runs.error) for runs in of)} failed"
    else:
        said = texts.short_text(100 * float(error), 2) + " %"
    return [texts.short_text(1e3 * float(time_s), 3), texts.short_text(float(factor.value), 3),
            interval(factor), texts.short_text(float(products), 3),
            said if error <= level else f"({said})", setting.text()]


def interval(estimate):
    return f"{float(estimate.low):.3g} to {float(estimate.high):.3g}" if np.isfinite(estimate.low) else "-"


def figure(scenes, width_mm):
    shown = answers(scenes)[1:]    # the cheapest of all is one of the others
    looks = dict(zip(shown, style.series_styles(len(shown))))
    note = ["Wall time of a simulated second over the error of the trajectory: median over test draws with 95 % interval, "
            "settings chosen on other draws."]
    page = layout.Page(width_mm, ["Cheapest settings"], len(scenes), 4, 44, [look.handle(name) for name, look in looks.items()],
                       note, left_mm=12, gap_mm=4)
    seen = []
    for column, (axes, (scene, found)) in enumerate(zip(page.axes[0], scenes.items())):
        for shift, (answer, look) in enumerate(looks.items()):
            levels = [level for level in score.LEVELS if (level, answer) in found]
            firsts = [found[level, answer][1][0] for level in levels]    # of the trainings
            times = [intervals.median(1e3 * runs.time_s, runs.draws) for runs in firsts]
            x = [level * 1.08 ** (shift - len(shown) // 2) for level in levels]
            style.errorbar(axes, x, times, **look.line(), linewidth=0.9, markersize=2.8, elinewidth=0.5)
            seen += [end for time in times for end in (time.low, time.high, time.value)]
        page.title(axes, scene)
        page.label_y(axes, column, "ms per simulated second")
    seen = seen or [1]
    for axes in page.axes[0]:
        axes.set(xscale="log", yscale="log", xlim=(2 * score.LEVELS[0], score.LEVELS[-1] / 2),
                 ylim=(0.7 * np.nanmin(seen), 1.4 * np.nanmax(seen)))
    page.label_x(0, "error / size of the scene")
    return page


if __name__ == "__main__":
    commandline.run(main)
