"""A file in the form that the page's template and scripts read: its answers, charts and animations."""

import json
import os
from dataclasses import dataclass, field

from rodsweep.reading import blocks, commandline, measures, remarks, texts, unconverged
from rodsweep.report import animation, answers, axes, families, guesses, lines

FAILURES_SHOWN = 12


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """Texts for the template; `data` is the input of the page's scripts. Without simulations that ended ok, only the
    state."""
    name: str
    path: str
    job: dict
    census: measures.Census
    failures: list               # [task, outcome, message]
    more_failures: int
    runs: list
    revisions: str
    data: dict
    films_left_out: int
    no_ratios: str               # the reason; or empty
    conditions: dict = field(default_factory=dict)
    warning: str = ""
    oracle_note: str = ""
    missed: str = ""             # timed solves that missed the tolerance
    large_residuals: str = ""    # of Newton
    unconverged: list = field(default_factory=list)    # sentences on steps that ended over a tolerance
    tolerance: str = ""          # of the iterations in the answers
    timed_tolerance: str = ""
    answers: list = field(default_factory=list)
    words: dict = field(default_factory=dict)    # {label: sentence} of guesses and methods
    steps: list = field(default_factory=list)
    step_measures: dict = field(default_factory=dict)

    @property
    def unfinished(self):
        return self.census.pending > 0

    @property
    def untimed(self):
        return bool(self.answers) and all(answer.block.times is None for answer in self.answers)

    @property
    def job_text(self):
        return json.dumps(self.job, indent=2, ensure_ascii=False)


def made(file, options, budget, room):
    """A Sweep of an open file. budget, room: axes.Budgets of estimates and of bytes of animations; options: those of
    report.py."""
    chosen = commandline.chosen_tasks(file, options)
    columns = commandline.chosen_guesses(file, options)
    tolerances = commandline.chosen_tolerances(file, options) or list(range(len(file.tolerances)))
    sims = measures.simulations(file, chosen)
    job = file.job()
    failures, more = measures.failures(file, chosen, FAILURES_SHOWN)
    films, films_left_out = animation.animations(file, chosen, room)
    data = {"families": [], "animations": films, "warning": "", "tolerance": 0,
            "tolerances": [texts.tolerance_label(file.tolerances[t]) for t in tolerances]}
    found = _found(file, options, sims, columns, tolerances, budget, data) if len(sims) else {}
    return Sweep(name=job.get("name") or os.path.splitext(os.path.basename(file.path))[0], path=file.path, job=job,
                 census=measures.census(file, chosen), failures=failures, more_failures=more, runs=file.runs(),
                 revisions=remarks.revisions(file), data=data, films_left_out=films_left_out,
                 no_ratios="the job has no zero guess to compare with" if file.guesses and file.zero is None
                 else "", **found)


def _found(file, options, sims, columns, tolerances, budget, data):
    """Fields of a Sweep that come from its simulations, by name; completes `data`."""
    tasks, measured = sims.tasks(), blocks.blocks(file, sims, None, "first")
    headline = answers.headline_tolerance(file, sims, tolerances) if file.guesses else None
    found = families.families(file, sims, columns, tolerances)
    shown = [{**axes.packed(file, family, budget, options.x), "lines": lines.packed(family.lines)} for family in found]
    warning = remarks.timing_warning(file, tasks)
    data.update(families=[family for family in shown if family["axes"]], warning=warning,
                tolerance=0 if headline is None else tolerances.index(headline))
    return {"conditions": remarks.conditions(file, tasks), "warning": warning,
            "oracle_note": remarks.oracle_note(file, columns).strip(), "missed": unconverged.missed_text(file, tasks),
            "large_residuals": unconverged.newton_text(file, tasks),
            "unconverged": list(filter(None, (unconverged.newton_text(file, tasks, times=1),
                                              unconverged.balance_text(file, tasks)))),
            "words": guesses.described(file, [label for family in found for label in family.lines]),
            "tolerance": "" if headline is None else texts.tolerance_label(file.tolerances[headline]),
            "timed_tolerance": remarks.solve_tolerance(file, tasks),
            "answers": answers.answers(file, measured, columns, headline),
            "steps": blocks.step_rows(measured, columns, file.guesses), "step_measures": blocks.step_measures(measured)}
