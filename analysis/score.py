#!/usr/bin/python3
"""How to simulate a scene to an error of the motion in the least time, and whether a guess helps (docs/score.md).

Without an option, it prints the tables of analysis/results/score/NAME.json, with the figure if -o says where. The tables
have, for every error, the cheapest setting of each kind: time of a simulated second, how many times as long as the kind
that was the cheapest on the draws for tuning, products with A, share of solves for which a network ran, error, number of
settings tried.

  --errors   looks for settings that may be the cheapest of their kind. It can be stopped, and goes on; other things may
             run beside it. Hours.
  --times    times these in one sitting, with nothing beside, and writes NAME.json. Minutes a scene.
  --again    times the chosen settings on draws that were never used, and says which factors lie within their intervals.

With a guess in Python, FILE.py, the script simulates the chosen settings of CG with this guess, times them in one sitting
with the chosen ones of all kinds, and shows its row beside the others'.
"""

import os
import sys
from dataclasses import replace

import numpy as np

from rodsweep.drawing import layout, study, style
from rodsweep.reading import commandline
from rodsweep.reading.errors import UserError
from rodsweep.reading.job_paths import checksum
from rodsweep.scoring import answers, own_guess, scenes, sitting
from rodsweep.scoring.answers import Scored
from rodsweep.scoring.runs import Runs
from rodsweep.scoring.search import Search
from rodsweep.scoring.settings import KINDS, OWN

EXAMPLES = """examples:
  analysis/score.py net                 # the table of nets
  analysis/score.py --errors net        # hours, then
  analysis/score.py --times net         # writes analysis/results/score/net.json
  analysis/score.py my_guess.py bending_rod     # a guess of yours (docs/own-guess.md)"""
WORK = os.path.join("results", "score")
MOST = 10    # of the figure's axis


def arguments():
    made = commandline.plain_parser(__doc__, EXAMPLES)
    made.add_argument("scenes", nargs="*", metavar="NAME",
                      help="scenes of jobs/score (default: all), such as helix; a guess in Python goes before them")
    made.add_argument("--root", default=scenes.ROOT, metavar="FOLDER",
                      help="with jobs/score and network/pretrained of your own (default: those of rodsweep)")
    what = made.add_mutually_exclusive_group()
    what.add_argument("--errors", action="store_true", help="search for settings")
    what.add_argument("--times", action="store_true", help="time those that were found")
    what.add_argument("--again", action="store_true", help="time the chosen ones on draws that were never used, and compare")
    made.add_argument("--inputs", nargs="+", metavar="FILE", default=[], help="files that the guess reads, such as weights")
    made.add_argument("--workers", type=commandline.whole_number, default=os.cpu_count(), metavar="N",
                      help="cores for --errors (default: all)")
    made.add_argument("--samples", type=commandline.whole_number, default=10, metavar="N",
                      help="draws for a guess of yours (default: 10)")
    made.add_argument("--work", default=WORK, metavar="FOLDER", help=f"where --errors keeps what it found (default: {WORK})")
    study.add_figure_arguments(made, "no figure")
    return made.parse_args()


def say(text):
    print(f"score: {text}", file=sys.stderr, flush=True)


def main():
    options = arguments()
    guess = options.scenes.pop(0) if options.scenes and options.scenes[0].endswith(".py") else None
    root = os.path.abspath(options.root)
    chosen = [scenes.Scene(name, root) for name in options.scenes or scenes.names(root)]
    if options.errors or options.times:
        os.makedirs(os.path.dirname(chosen[0].measured("")), exist_ok=True)    # fails now rather than after hours
    if guess:
        if options.errors or options.times or options.again:
            raise UserError("a guess in Python goes with none of --errors, --times and --again")
        for scene in chosen:
            scored = own_guess.scored(scene, Scored.of(scene), guess, options.inputs, options.samples, options.work, say)
            print("\n".join(answers.table(scored)), flush=True)
    elif options.errors:
        for scene in chosen:
            search = search_of(scene, options.work, options.workers)
            report(search.run())
            search.runs.publish()
    elif options.times:
        for scene in chosen:
            time_all(scene, options.work, options.workers)
    elif options.again:
        for scene in chosen:
            time_again(scene, Scored.of(scene), options.work, options.workers)
    else:
        show([Scored.of(scene) for scene in chosen if os.path.exists(scene.measured(".json")) or options.scenes], options)


def search_of(scene, work, workers, complete=False):
    smaller = scenes.SMALLER.get(scene.name)
    if smaller:
        smaller = Runs(scenes.Scene(smaller, scene.root), work, workers, say)
        smaller.require_timed()
    return Search(Runs(scene, work, workers, say, complete), smaller)


def report(candidates):
    for (level, kind), some in candidates.items():
        say(f"{kind} at {100 * level:g} %: " + ("; ".join(setting.text() for setting in some) or "no setting is admitted"))


def time_all(scene, work, workers):
    """A sitting that was held for these candidates is not repeated: then errors are computed, which may take long."""
    search = search_of(scene, work, workers, complete=True)
    candidates, path = search.run(), os.path.join(work, f"{scene.name}_times.json")
    held = sitting.read(path)
    if held.get("candidates") != sitting.listed(candidates):
        held = sitting.Sitting(scene, work, say).hold(candidates)
        sitting.write(path, held)
    chosen, times = sitting.chosen_and_times(held)
    search.runs.measure(times, scenes.TEST)
    scored = Scored(scene.name, scene.title, checksum(scene.job), held["runs"][0]["revision"], held["runs"][-1]["end"][:10],
                    search.reference, search.tried(), search.levels,
                    answers.training_minutes(scene.root, [setting for setting, _ in chosen.values()]),
                    answers.answers_of(chosen, times, search.runs))
    scored.write(scene.measured(".json"))
    print("\n".join(answers.table(scored)), flush=True)


def time_again(scene, known, work, workers):
    """Prints the factors of a scene, and those on draws that were never used."""
    runs = Runs(scene, work, workers, say)
    chosen = {(answer.level, answer.kind): (answer.setting, answer.tuning_s) for answer in known.answers}
    times = sitting.Sitting(scene, work, say).repeated([setting for setting, _ in chosen.values()], scenes.AGAIN, scene.samples)
    runs.measure(times, scenes.AGAIN)
    again = replace(known, answers=answers.answers_of(chosen, times, runs, scenes.AGAIN))
    print("\n".join(answers.comparison(known, again)), flush=True)


def show(scored, options):
    print("\n".join(line for one in scored for line in answers.table(one)))
    if options.output and scored:
        page = figure(scored, options.width)
        print("\n".join(page.save(options.output, "score", options.format, not options.no_caption)))


def figure(scored, width_mm):
    shown = [kind for kind in KINDS if kind != OWN]
    looks = dict(zip(shown, style.series_styles(len(shown))))
    note = ["Processor time over that of the fastest kind, at errors of the motion over the size of the scene: geometric means "
            f"over draws that did not choose the settings. Only kinds that keep to the error there. More than {MOST} is "
            "drawn at the upper edge."]
    page = layout.Page(width_mm, ["Cheapest settings"], len(scored), 4 if width_mm > 100 else 2, 44,
                       [look.handle(name) for name, look in looks.items()], note, left_mm=12, gap_mm=9)
    for column, (axes, one) in enumerate(zip(page.axes[0], scored)):
        kept = [{kind: answer.time for kind, answer in one.at(level).items() if answer.kept} for level in one.levels]
        for shift, (kind, look) in enumerate(looks.items()):
            axes.plot([level * 1.05 ** (shift - len(shown) // 2) for level in one.levels],
                      [min(MOST, times[kind] / min(times.values())) if kind in times else np.nan for times in kept],
                      **look.line(), linewidth=0.9, markersize=2.8, clip_on=False)
        axes.set(xscale="log", yscale="log", xlim=(2 * scenes.LEVELS[0], scenes.LEVELS[-1] / 2), ylim=(0.9, MOST))
        layout.set_ticks(axes.xaxis, scenes.LEVELS, lambda level: f"{100 * level:g} %")
        layout.set_ticks(axes.yaxis, (1, 2, 5, MOST))
        page.title(axes, one.title)
        page.label_y(axes, column, "time / the fastest")
    page.label_x(0, "error of the motion")
    return page


if __name__ == "__main__":
    commandline.run(main)
