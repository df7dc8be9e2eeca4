"""Notes on ratios and times: how they were solved and timed, and the revision of the program."""

import numpy as np

from rodsweep.reading import measures, texts

NORMS = {"true_residual": "‖b − Ax‖₂ relative to ‖b‖₂", "natural": "natural norm of b − Ax relative to that of b"}


def conditions(file, tasks):
    """{name: text}; several values are joined by a slash."""
    def values(name, text=str):
        parameter = file.parameters.get(name)
        if parameter is None:
            return "not recorded"
        return " / ".join(dict.fromkeys(text(parameter.text(task)) for task in tasks))

    ways = np.where(file.own_guess[tasks] >= 0, "closed-loop", "paired")[measures.has_guesses(file)[tasks]]
    return {"evaluation": " / ".join(dict.fromkeys(ways.tolist())),
            "norm": values("solve.norm", lambda n: NORMS.get(n, n)),
            "preconditioner": values("solve.preconditioner"), "tolerance": values("solve.tolerance"),
            "step_s": values("time.step_s")}


def solve_tolerance(file, tasks):
    """The tolerance of the timed solves; several if the job has a grid of them."""
    parameter = file.parameters.get("solve.tolerance")
    values = [] if parameter is None else parameter.values[tasks]
    return " / ".join(dict.fromkeys(texts.tolerance_label(value) for value in values))


def revisions(file):
    return ", ".join(sorted({str(run.get("revision", "")) for run in file.runs()} - {""}))


def timing_warning(file, tasks):
    return ("Not valid as timings: these tasks ran with more MPI ranks than cores." if len(tasks) and
            file.oversubscribed(tasks) else "")


def oracle_note(file, guesses):
    """A sentence and a blank for outputs with times of guesses; empty without an oracle."""
    if not any("oracle" in file.guesses[g] for g in guesses):
        return ""
    return "The oracle solves the system itself: its guess time is not the cost of a method. "
