#!/usr/bin/python3
"""Figures of a sweep against the size of the rod, or against any other swept parameter.

  cg-ratio   CG iterations relative to the zero guess, a panel per tolerance
  speedup    time of zero-guess CG over the time with a guess: CG only, guess and CG, whole step; direct beside
  time       time per solve split into assembly, guess and CG, per guess, with the direct solve beside

A row of panels per scene type and per value of any other grid of the job. Figures of times need /solves in the file
(record.solves "all"). Written as PDF and PNG; the paths are printed.
"""

import os
import sys
from dataclasses import dataclass

import commandline
import figures
import groups
import measures
import style
import timings
from sweepfile import KeyNotFound, SweepFile

EXAMPLES = """examples:
  analysis/spatial.py results/demo.h5
  analysis/spatial.py results/demo.h5 --scene helix --tolerance 1e-2,1e-4 --newton all
  analysis/spatial.py results/stiffness.h5 --x scene.youngs_modulus_pa --select scene.segments=20:40 --width 84"""


@dataclass
class Study:
    """A file and what to show of it. points[k] are the points along x of panels[k]."""
    file: SweepFile
    sims: measures.Simulations
    x: str
    panels: list
    points: list
    guesses: list
    styles: dict
    newton: str
    width_mm: int
    census: measures.Census
    without_x: int      # simulations that have no value of x

    def lines(self):
        """The guesses that are drawn as lines: all but zero, which is the line at 1."""
        return [g for g in self.guesses if g != self.file.zero]

    def style(self, guess):
        return self.styles[self.file.guesses[guess]]

    def x_label(self):
        return style.parameter_label(self.x, self.file.parameter(self.x).unit)

    def solve_tolerance(self):
        """As text; several where the job has a grid of them."""
        values = self.file.parameter("solve.tolerance").values[self.sims.tasks()]
        return " / ".join(commandline.tolerance_label(value) for value in dict.fromkeys(values.tolist()))

    def timing_warning(self):
        return commandline.timing_warning(self.file, self.sims.tasks())

    def about(self):
        """The note that every figure ends with."""
        said = commandline.conditions(self.file, self.sims.tasks())
        revisions = sorted({str(run.get("revision", "")) for run in self.file.runs()} - {""})
        parts = [f"{said['evaluation'].capitalize()} evaluation; preconditioner {said['preconditioner']}; "
                 f"residual test: {said['norm']}; time step {said['step_s']} s.",
                 f"{os.path.basename(self.file.path)}: {self.census.text()}"]
        if self.without_x:
            parts[-1] += f"; {self.without_x} simulations without a value of {self.x} left out"
        note = commandline.timing_note(self.file, self.sims.tasks())
        if note:
            parts[-1] += f". {note.rstrip('.')}"
        if revisions:
            parts[-1] += f"; revision {', '.join(revisions)}"
        return " ".join(parts) + "."


def arguments():
    made = commandline.parser(__doc__, EXAMPLES)
    made.add_argument("-o", "--output", metavar="DIR", help="folder of the figures (default: figures/ beside the file)")
    made.add_argument("--x", metavar="KEY", default="scene.segments",
                      help="parameter along x (default: scene.segments)")
    made.add_argument("--width", choices=list(style.WIDTHS_MM), default="174",
                      help="width of the figures in mm, a column or a page (default: 174)")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        study = make_study(file, options)
        tolerances = commandline.chosen_tolerances(file, options)
        folder = options.output or os.path.join(os.path.dirname(file.path), "figures")
        stem = os.path.splitext(os.path.basename(file.path))[0] + (f"-{options.scene}" if options.scene else "")
        ending = "".join(["" if options.x == "scene.segments" else f"-by-{options.x.rsplit('.', 1)[-1]}",
                          "-all-newton" if options.newton == "all" else "",
                          "" if options.width == "174" else f"-{options.width}mm"])
        made = {"cg-ratio": figures.ratio_figure(study, tolerances)}
        if timings.timed(file):
            by_newton = timings.times(file, study.sims)
            made["speedup"] = figures.speedup_figure(study, by_newton)
            made["time"] = figures.time_figure(study, by_newton)
        else:
            print(f"{file.path} has no times of single solves (record.solves is \"summary\"): CG ratios only",
                  file=sys.stderr)
        for name, page in made.items():
            print("\n".join(page.save(folder, f"{stem}-{name}{ending}")))
    return 0


def make_study(file, options):
    guessing = commandline.chosen_tasks(file, options) & measures.has_guesses(file)
    if not guessing.any():
        raise KeyNotFound(f"{file.path} has no guesses to compare: the direct solve alone advances these simulations")
    if file.zero is None:
        raise KeyNotFound(f"{file.path} has no zero guess: nothing to relate {', '.join(file.guesses)} to")
    guesses = commandline.chosen_guesses(file, options)
    if guesses == [file.zero]:
        raise KeyNotFound("only the zero guess is left: nothing to relate to it")
    census = measures.census(file, guessing)
    everything = measures.simulations(file, guessing)
    if not len(everything):
        raise KeyNotFound(f"{file.path} has no simulation to show yet: {census.text()}")
    sims = everything.subset(groups.applicable(file, everything, options.x))
    panels = groups.panels(file, sims, options.x)
    points = [groups.points(file, sims, panel, options.x) for panel in panels]
    return Study(file, sims, options.x, panels, points, guesses, style.guess_styles(file.guesses), options.newton,
                 style.WIDTHS_MM[options.width], census, len(everything) - len(sims))


if __name__ == "__main__":
    commandline.run("spatial.py", main)
