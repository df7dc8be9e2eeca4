"""What the figure scripts share: the simulations and guesses of a figure, what it must say of itself, and its files."""

import os
from dataclasses import dataclass

import numpy as np
from matplotlib.lines import Line2D

import commandline
import measures
import style
from sweepfile import KeyNotFound, SweepFile


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

    @property
    def wide(self):
        return self.width_mm > 100

    def lines(self):
        """The guesses that are drawn relative to zero: all but zero itself."""
        return [g for g in self.guesses if g != self.file.zero]

    def style(self, guess):
        return self.styles[self.file.guesses[guess]]

    def handles(self, lines, zero_text=""):
        """The legend: the guesses, and what the line at 1 is."""
        found = [Line2D([], [], label=self.file.guesses[g], **self.style(g).line()) for g in lines]
        if zero_text:
            found.append(Line2D([], [], color=style.KINDS["zero"][0], linewidth=0.9, label=zero_text))
        return found

    def solve_tolerance(self):
        """As text; several where the job has a grid of them."""
        values = self.file.parameter("solve.tolerance").values[self.sims.tasks()]
        return " / ".join(commandline.tolerance_label(value) for value in dict.fromkeys(values.tolist()))

    def timing_warning(self):
        return commandline.timing_warning(self.file, self.sims.tasks())

    def about(self, left_out=""):
        """The note that every figure ends with."""
        said = commandline.conditions(self.file, self.sims.tasks())
        revisions = sorted({str(run.get("revision", "")) for run in self.file.runs()} - {""})
        evaluation = f"{said['evaluation'].capitalize()} evaluation" if said["evaluation"] else "Direct solve alone"
        parts = [f"{evaluation}; preconditioner {said['preconditioner']}; "
                 f"residual test: {said['norm']}; time step {said['step_s']} s.",
                 f"{os.path.basename(self.file.path)}: {self.census.text()}"]
        if left_out:
            parts[-1] += f"; {left_out}"
        note = commandline.timing_note(self.file, self.sims.tasks())
        if note:
            parts[-1] += f". {note.rstrip('.')}"
        if revisions:
            parts[-1] += f"; revision {', '.join(revisions)}"
        return " ".join(parts) + "."


def of_guesses(file, options, needs_zero=True):
    """A Study of the chosen tasks that try guesses. Raises KeyNotFound where there are none to compare."""
    guessing = commandline.chosen_tasks(file, options) & measures.has_guesses(file)
    if not guessing.any():
        raise KeyNotFound(f"{file.path} has no guesses to compare: the direct solve alone advances these simulations")
    guesses = commandline.chosen_guesses(file, options)
    if needs_zero and file.zero is None:
        raise KeyNotFound(f"{file.path} has no zero guess: nothing to relate {', '.join(file.guesses)} to")
    if needs_zero and guesses == [file.zero]:
        raise KeyNotFound("only the zero guess is left: nothing to relate to it")
    return of_tasks(file, guessing, guesses, options)


def of_tasks(file, chosen, guesses, options, failed_too=False):
    """A Study of the tasks of a mask that ended well (or at all). Raises KeyNotFound where there is none."""
    census = measures.census(file, chosen)
    sims = measures.simulations(file, chosen, failed_too)
    if not len(sims):
        raise KeyNotFound(f"{file.path} has no simulation to show yet: {census.text()}")
    return Study(file, sims, guesses, style.guess_styles(file.guesses), options.newton, style.WIDTHS_MM[options.width],
                 census)


def sample_text(estimates, of="", mark="whiskers", point="point"):
    """How many simulations the points stand for, and what their intervals look like (`mark`, "" if not drawn)."""
    counts = commandline.range_text([int(n) for e in estimates for n in np.ravel(e.count)])
    simulations = "simulation" if counts == "1" else "simulations"
    has_intervals = any(np.isfinite(e.low).any() for e in estimates)
    text = f"{counts} {simulations} per {point}"
    if not mark:
        return text
    return text + (f"; {mark}: 95 % bootstrap intervals{of}" if has_intervals else "; a single draw has no intervals")


def add_figure_arguments(made):
    made.add_argument("-o", "--output", metavar="DIR", help="folder of the figures (default: figures/ beside the file)")
    made.add_argument("--width", choices=list(style.WIDTHS_MM), default="174",
                      help="width of the figures in mm, a column or a page (default: 174)")


def save(file, options, pages, choices=()):
    """Writes pages {name: Page} as FILE[-SCENE]-NAME[-CHOICE…].pdf and .png and prints their paths."""
    folder = options.output or os.path.join(os.path.dirname(file.path), "figures")
    stem = os.path.splitext(os.path.basename(file.path))[0] + (f"-{options.scene}" if options.scene else "")
    endings = [*choices, "all-newton" if options.newton == "all" else "",
               "" if options.width == "174" else f"{options.width}mm"]
    ending = "".join(f"-{text}" for text in endings if text)
    for name, page in pages.items():
        print("\n".join(page.save(folder, f"{stem}-{name}{ending}")))
