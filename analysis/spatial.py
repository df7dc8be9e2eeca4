#!/usr/bin/python3
"""Figures of a sweep against the number of segments, or against any other swept parameter.

  cg-ratio   CG iterations relative to the zero guess, a panel per tolerance
  speedup    time of zero-guess CG over the time with a guess: CG only, guess and CG, whole step; also direct solve
  time       time per solve split into assembly, guess and CG, per guess, with the direct solve
  four-curves  for learned guesses, as in Shao et al.: CG ratio, time of the guess over that of its CG, speedups

Each scene type and value of any other grid of the job has a row of panels. Figures of times need /solves in the file
(record.solves "all"). Writes PDF and PNG and prints the paths.
"""

import sys
from dataclasses import dataclass

from rodsweep.drawing import figures, study
from rodsweep.reading import commandline, groups, texts, timings
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/spatial.py results/demo.h5
  analysis/spatial.py results/demo.h5 --scene helix --tolerance 1e-2,1e-4 --newton all
  analysis/spatial.py results/stiffness.h5 --x scene.youngs_modulus_pa --select scene.segments=20:40 --width 84"""


@dataclass(kw_only=True)
class Study(study.Study):
    """points[k] are the points along x of panels[k]."""
    x: str
    panels: list
    points: list

    def x_label(self):
        return texts.parameter_label(self.x, self.file.parameter(self.x).unit)


def arguments():
    made = study.parser(__doc__, EXAMPLES)
    made.add_argument("--x", metavar="KEY", default="scene.segments",
                      help="parameter along x (default: scene.segments)")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown = make_study(file, options)
        by_newton = timings.times(file, shown.sims) if timings.timed(file) else None
        if by_newton and not timings.measured(by_newton):
            by_newton = None
        by_x = "" if options.x == "scene.segments" else f"by-{options.x.rsplit('.', 1)[-1]}"
        study.save(file, options, all_figures(file, options, shown, by_newton), [by_x])


def all_figures(file, options, shown, by_newton):
    made = {"cg-ratio": figures.ratio_figure(shown, commandline.chosen_tolerances(file, options))}
    if by_newton is None:
        why = "record.solves is \"summary\"" if not timings.timed(file) else "no task solved all to the tolerance"
        print(f"{file.path} has no times of single solves ({why}): CG ratios only", file=sys.stderr)
        return made
    made["speedup"] = figures.speedup_figure(shown, by_newton)
    made["time"] = figures.time_figure(shown, by_newton)
    four_curves = figures.four_curves_figure(shown, by_newton)
    if four_curves:
        made["four-curves"] = four_curves
    return made


def make_study(file, options):
    base = study.of_guesses(file, options)
    everything = len(base.sims)
    base.sims = base.sims.subset(groups.applicable(file, base.sims, options.x))
    base.leave_out(everything - len(base.sims), f"without a value of {options.x}")
    panels = groups.panels(file, base.sims, options.x)
    points = [groups.points(file, base.sims, panel, options.x) for panel in panels]
    return Study(**vars(base), x=options.x, panels=panels, points=points)


if __name__ == "__main__":
    commandline.run(main)
