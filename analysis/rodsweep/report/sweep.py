"""A file as the template and the scripts of the page take it: what it answers, its charts and its animations."""

import json
import os
from dataclasses import dataclass

from rodsweep.drawing import looks
from rodsweep.reading import blocks, commandline, measures, remarks, texts
from rodsweep.report import animation, answers, axes, families

SYMBOLS = {"o": "circle", "v": "wye", "s": "square", ">": "diamond", "8": "hexagon", "P": "cross", "^": "triangle",
           "<": "triangle2", "X": "times", "*": "star", "D": "diamond", "x": "times", "H": "hexagon", "h": "hexagon",
           "p": "square2", "d": "diamond2", (5, 1, 0): "star", (4, 2, 0): "asterisk", (3, 1, 0): "wye",
           (3, 2, 0): "asterisk", (6, 1, 0): "asterisk", (4, 1, 0): "star"}
DASH = 1.6           # pixels of a unit of a dash
ON_DARK = 0.30       # relative luminance that a line has at least on a dark page
STEP_TITLES = {"newton_iterations": "Newton iterations a step", "newton_residual": "Newton residual",
               "momentum_residual": "momentum residual", "length_drift": "length drift",
               "joint_gap": "joint gap / length", "penetration": "penetration / radius",
               "contact_residual": "contact residual / radius"}


@dataclass(frozen=True)
class Sweep:
    """For the template: texts; `data`: what the scripts of the page draw from."""
    name: str
    path: str
    job: dict
    census: measures.Census
    failures: list
    more_failures: int
    conditions: dict
    warning: str
    notes: list
    tolerance: str
    timed_tolerance: str
    answers: list
    untimed: bool
    no_ratios: str
    steps: list
    step_columns: dict
    runs: list
    revisions: str
    films_left_out: int
    data: dict

    @property
    def unfinished(self):
        return self.census.pending > 0

    @property
    def job_text(self):
        return json.dumps(self.job, indent=2, ensure_ascii=False)


def made(file, options, budget, room):
    """A Sweep of an open file. budget, room: axes.Budgets of estimates and of bytes of animations; options: those of
    report.py."""
    chosen = commandline.chosen_tasks(file, options)
    guesses, tolerances = commandline.chosen_guesses(file, options), commandline.chosen_tolerances(file, options)
    sims = measures.simulations(file, chosen)
    tasks = sims.tasks()
    job = file.job()
    failures, more = answers.failures(file, chosen)
    found, measured, shown, headline = [], [], [], None
    if len(sims):
        if file.guesses:
            headline = answers.headline_tolerance(file, sims, tolerances)
        measured = blocks.blocks(file, sims, None, "first")
        found = answers.answers(file, measured, guesses, headline)
        charts = [{**axes.packed(file, family, budget, options.x), "lines": lines(family.lines)}
                  for family in families.families(file, sims, guesses, tolerances)]
        shown = [family for family in charts if family["axes"]]
    timed = any(answer.block.times is not None for answer in found)
    columns = {name: title for name, title in STEP_TITLES.items() if any(name in block.steps for block in measured)}
    films, films_left_out = animation.animations(file, chosen, room)
    data = {"families": shown,
            "tolerances": [texts.tolerance_label(file.tolerances[t]) for t in tolerances],
            "tolerance": tolerances.index(headline) if headline in tolerances else 0,
            "warning": remarks.timing_warning(file, tasks) if len(sims) else "",
            "animations": films}
    return Sweep(job.get("name") or os.path.splitext(os.path.basename(file.path))[0], file.path, job,
                 measures.census(file, chosen), failures, more, remarks.conditions(file, tasks) if len(sims) else {},
                 data["warning"], answers.notes(file, sims, guesses) if len(sims) else [],
                 texts.tolerance_label(file.tolerances[headline]) if headline is not None else "",
                 remarks.solve_tolerance(file, tasks) if len(sims) else "", found, bool(found) and not timed,
                 "the job has no zero guess to relate the others to" if file.guesses and file.zero is None else "",
                 answers.steps(measured, guesses, file.guesses), columns, answers.runs(file), remarks.revisions(file), films_left_out, data)


def lines(found):
    """{label: looks.Look} with colours for light and dark pages, marker and dash as the charts take them."""
    return [{"label": label, "light": look.colour, "dark": on_dark(look.colour),
             "symbol": SYMBOLS.get(look.marker, "circle"),
             "dash": " ".join(f"{DASH * length:g}" for length in look.dash[1]) if look.dash[1][-1] else ""}
            for label, look in found.items()]


def on_dark(colour):
    """The colour, lighter where a dark page needs it."""
    share = 0.0
    while looks.luminance(looks.channels(looks.lighter(colour, share))) < ON_DARK:
        share += 0.02
    return looks.lighter(colour, share)
