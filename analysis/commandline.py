"""What the scripts share on the command line: choosing tasks, guesses and tolerances, and plain errors."""

import argparse
import os
import sys

import numpy as np

import measures
from sweepfile import KeyNotFound, SweepFileError, not_found
from tools import ToolError

DEFAULT_TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4)
NORMS = {"true_residual": "‖b − Ax‖₂ relative to ‖b‖₂", "natural": "natural norm of b − Ax relative to that of b"}


def parser(description, epilog=None, tolerances="1e-1,1e-2,1e-3,1e-4", newton=True):
    """`tolerances`: what is shown by default, None for a script without that choice; newton: is there a choice?"""
    made = argparse.ArgumentParser(description=description, epilog=epilog,
                                   formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("file", help="results file of `rodsweep run` (results/NAME.h5); it may still be running")
    made.add_argument("--scene", metavar="TYPE", help="only this type of scene, e.g. bending_rod")
    made.add_argument("--select", metavar="KEY=VALUE", action="append", default=[],
                      help="only tasks with these values of a parameter: KEY=VALUE, KEY=A,B or KEY=LOW:HIGH; "
                           "may be repeated")
    made.add_argument("--guess", metavar="LABEL,…", help="only these guesses (default: all)")
    if tolerances:
        made.add_argument("--tolerance", metavar="T,…",
                          help=f"tolerances that iterations are counted to, or `all` (default: {tolerances})")
    made.set_defaults(newton="first")
    if newton:
        made.add_argument("--newton", choices=list(measures.NEWTON), default="first",
                          help="Newton iterations that count: the first of every step (j = 0, the default) or all")
    return made


def run(name, main):
    """Calls main(); what the user can put right is one line on stderr and exit code 2."""
    try:
        code = main()
        sys.stdout.flush()
    except (SweepFileError, KeyNotFound, ToolError) as error:
        print(f"{name}: {error.args[0]}", file=sys.stderr)
        code = 2
    except BrokenPipeError:  # the reader of a pipe has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    except OSError as error:
        # h5py raises it for rows that cannot be read, without a number
        text = f"{error.filename or 'output'}: {error.strerror}" if error.errno else f"the file is damaged: {error}"
        print(f"{name}: {text}", file=sys.stderr)
        code = 2
    sys.exit(code)


def chosen_tasks(file, arguments):
    """Mask of the tasks that --scene and --select leave, complete or not."""
    mask = file.select(arguments.select)
    if arguments.scene:
        scenes = file.scene_types()
        if arguments.scene not in scenes:
            raise not_found("scene", arguments.scene, sorted(set(scenes.tolist())))
        mask &= scenes == arguments.scene
        if not mask.any():
            raise KeyNotFound(f"no task of scene {arguments.scene} meets all of " + ", ".join(arguments.select))
    return mask


def chosen_guesses(file, arguments):
    """Indices of the guesses to show, in the file's order."""
    if not arguments.guess:
        return list(range(len(file.guesses)))
    return sorted({file.guess_index(label.strip()) for label in split_labels(arguments.guess)})


def split_labels(text):
    """At commas outside parentheses: labels may hold their own."""
    parts, depth, start = [], 0, 0
    for k, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            parts.append(text[start:k])
            start = k + 1
    return parts + [text[start:]]


def chosen_tolerances(file, arguments):
    """Indices of the tolerances to show."""
    if arguments.tolerance == "all":
        return list(range(len(file.tolerances)))
    if not arguments.tolerance:
        return [k for k, t in enumerate(file.tolerances) if np.isclose(t, DEFAULT_TOLERANCES, rtol=1e-6, atol=0).any()]
    try:
        values = [float(part) for part in arguments.tolerance.split(",")]
    except ValueError:
        raise KeyNotFound(f"--tolerance {arguments.tolerance}: write numbers of the file's ladder with commas between "
                          "them, or `all`") from None
    return [file.tolerance_index(value) for value in values]


def conditions(file, tasks):
    """What every ratio and time must say of itself, as text by name; several values are joined by a slash."""
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


def tolerance_label(value):
    """1e-2, 3e-3."""
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{float(mantissa):g}e{int(exponent)}"


def range_text(counts):
    """5 or 4–5."""
    counts = [int(c) for c in np.ravel(counts) if c > 0]
    if not counts:
        return "0"
    return str(min(counts)) if min(counts) == max(counts) else f"{min(counts)}–{max(counts)}"


def timing_note(file, tasks):
    """What to know of times beside timing_warning(); or empty."""
    apart = int(file.timed_apart(tasks).sum()) if len(tasks) else 0
    return (f"Of {apart} tasks some guesses were timed in another run than the others (run --extend): speedups between "
            "them compare two runs.") if apart else ""


def aligned(rows):
    """Columns of equal width, the first to the left, the others to the right."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return ["  ".join([row[0].ljust(widths[0])] + [cell.rjust(w) for cell, w in zip(row[1:], widths[1:])]).rstrip()
            for row in rows]


def oracle_note(file, guesses):
    """A sentence for whatever shows times of guesses, and a blank; empty without an oracle."""
    if not any("oracle" in file.guesses[g] for g in guesses):
        return ""
    return "The oracle solves the system itself: its guess time is no method's cost. "


def timing_warning(file, tasks):
    return ("Not valid as timings: these tasks ran with more MPI ranks than cores." if len(tasks) and
            file.oversubscribed(tasks) else "")
