"""Shared by the figure scripts: the simulations and guesses of a figure, its notes, and its files."""

import argparse
import os
from dataclasses import dataclass

import numpy as np
from matplotlib.lines import Line2D

from rodsweep.drawing import layout, style
from rodsweep.reading import commandline, measures, remarks, texts
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile


@dataclass
class Study:
    """A file and what to show of it."""
    file: SweepFile
    sims: measures.Simulations
    guesses: list
    styles: dict
    newton: str
    width_mm: int
    census: measures.Census
    left_out: str = ""    # which of the counted tasks, and why

    @property
    def wide(self):
        return self.width_mm > 100

    def leave_out(self, count, why):
        """Adds simulations that are not shown to the last note."""
        if count:
            said = f"{count} simulation{'s' * (count > 1)} {why} left out"
            self.left_out = f"{self.left_out}; {said}" if self.left_out else said

    def lines(self):
        """The guesses that are drawn relative to zero: all except zero."""
        return [g for g in self.guesses if g != self.file.zero]

    def style(self, guess):
        return self.styles[self.file.guesses[guess]]

    def handles(self, lines, zero_text=""):
        """Legend entries of the guesses and of the line at 1."""
        found = [self.style(g).handle(self.file.guesses[g]) for g in lines]
        return found + ([Line2D([], [], label=zero_text, **style.ZERO_LINE)] if zero_text else [])

    def methods_without_guess(self, panel):
        """{method: (style, tasks, rows of Simulations)} of the methods without a guess in a panel."""
        rows = panel.index[~self.sims.own[panel.index]]
        tasks = self.sims.any_task[rows]
        names = measures.without_guess(self.file, tasks)
        looks = style.guess_styles(sorted(set(names.tolist()), reverse=True))
        return {name: (look, tasks[names == name], rows[names == name]) for name, look in looks.items()}

    def time_axis(self, tasks, steps):
        """(times of steps, label) if the simulations share one step size, else (steps, label)."""
        parameter = self.file.parameters.get("time.step_s")
        sizes = set(parameter.values[tasks]) if parameter else set()
        return (steps * sizes.pop(), "simulated time (s)") if len(sizes) == 1 else (steps, "number of the time step")

    def solve_tolerance(self):
        return remarks.solve_tolerance(self.file, self.sims.tasks())

    def timing_warning(self):
        return remarks.timing_warning(self.file, self.sims.tasks())

    def about(self):
        """The last note of every figure."""
        said = remarks.conditions(self.file, self.sims.tasks())
        revisions = remarks.revisions(self.file)
        evaluation = f"{said['evaluation'].capitalize()} evaluation" if said["evaluation"] else "Direct solve only"
        parts = [f"{evaluation}; preconditioner {said['preconditioner']}; "
                 f"residual test: {said['norm']}; time step {said['step_s']} s.",
                 f"{os.path.basename(self.file.path)}: {self.census.text()}"]
        if self.left_out:
            parts[-1] += f"; {self.left_out}"
        if revisions:
            parts[-1] += f"; revision {revisions}"
        return " ".join(parts) + "."


def of_guesses(file, options):
    """A Study of the chosen tasks that try guesses. Raises KeyNotFound if there is no guess to compare with zero."""
    guessing = commandline.chosen_tasks(file, options) & measures.has_guesses(file)
    if not guessing.any():
        raise KeyNotFound(f"{file.path} has no guesses to compare in the chosen simulations")
    guesses = commandline.chosen_guesses(file, options)
    if file.zero is None:
        raise KeyNotFound(f"{file.path} has no zero guess to compare {', '.join(file.guesses)} with")
    if guesses == [file.zero]:
        raise KeyNotFound("only the zero guess is chosen: there is no guess to compare with it")
    made = _study(file, options, guessing, guesses)
    solved = measures.solved(file, made.sims, options.newton)
    if not solved.any():
        raise KeyNotFound(f"{file.path} has no CG ratios: no solve of the chosen simulations took an iteration "
                          f"({measures.NEWTON[options.newton]})")
    made.sims = made.sims.subset(solved)
    made.leave_out(int((~solved).sum()), "without CG iterations")
    return made


def of_tasks(file, options, failed_too=False):
    """A Study of the chosen tasks that ended ok (failed_too: of all complete ones). KeyNotFound if there is none."""
    guesses = commandline.chosen_guesses(file, options)
    chosen = commandline.chosen_tasks(file, options) & commandline.advanced_by(file, guesses)
    return _study(file, options, chosen, guesses, failed_too)


def _study(file, options, chosen, guesses, failed_too=False):
    census = measures.census(file, chosen)
    sims = measures.simulations(file, chosen, failed_too)
    if not len(sims):
        raise KeyNotFound(f"{file.path} has no simulation to show yet: {census.text()}")
    return Study(file, sims, guesses, style.guess_styles(file.guesses), options.newton, options.width, census)


def handles(series):
    """Legend entries of several {method: (style, …)}, each method once."""
    looks = {method: look for methods in series for method, (look, *_) in methods.items()}
    return [look.handle(method) for method, look in looks.items()]


def sample_text(estimates, of="", mark="whiskers", point="point"):
    """The number of simulations per point, and how intervals are drawn (`mark`; "" if they are not)."""
    counts = texts.range_text([int(n) for e in estimates for n in np.ravel(e.count)])
    simulations = "simulation" if counts == "1" else "simulations"
    has_intervals = any(np.isfinite(e.low).any() for e in estimates)
    text = f"{counts} {simulations} per {point}"
    if not mark:
        return text
    return text + (f"; {mark}: 95 % bootstrap intervals{of}" if has_intervals else "; too few for intervals")


def parser(*about, **choices):
    """commandline.parser() with the options of figures."""
    made = commandline.parser(*about, **choices)
    add_figure_arguments(made)
    return made


def add_figure_arguments(made, otherwise="figures/ beside the file"):
    made.add_argument("-o", "--output", metavar="DIR", help="folder of the figures; those of the same name are "
                      f"replaced (default: {otherwise})")
    made.add_argument("--width", type=int, choices=(84, 174), default=174,
                      help="width of the figures in mm: a column or a page (default: 174)")
    made.add_argument("--format", metavar="F,…", type=formats, default=("pdf", "png"),
                      help="pdf, png and svg, separated by commas (default: pdf,png)")
    made.add_argument("--no-caption", action="store_true",
                      help="leave out the notes under the figure, e.g. for a paper with its own caption")


def formats(text):
    """The type of --format."""
    chosen = tuple(text.split(","))
    unknown = [one for one in chosen if one not in layout.METADATA]
    if unknown:
        raise argparse.ArgumentTypeError(f"{unknown[0]!r} is not one of {', '.join(layout.METADATA)}")
    return chosen


def save(file, options, pages, choices=()):
    """Writes {name: Page} as FILE[-SCENE]-NAME[-CHOICE…] and prints the paths. `file` has the path of the results."""
    folder = options.output or os.path.join(os.path.dirname(file.path), "figures")
    stem = os.path.splitext(os.path.basename(file.path))[0] + (f"-{options.scene}" if options.scene else "")
    endings = [*choices, "all-newton" if options.newton == "all" else "",
               "" if options.width == 174 else f"{options.width}mm"]
    ending = "".join(f"-{text}" for text in endings if text)
    for name, page in pages.items():
        print("\n".join(page.save(folder, f"{stem}-{name}{ending}", options.format, not options.no_caption)))
